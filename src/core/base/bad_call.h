/* Calls of public functions with arguments that make no sense: each check sets the text of
 * pdyn_last_error, "FUNCTION: ARGUMENT ...", and returns true if the call is bad. The macros take
 * the arguments of the public function that they stand in, under the names of its header. */
#ifndef PDYN_BAD_CALL_H
#define PDYN_BAD_CALL_H

#include "projdyn/projdyn.h"

/* One of the pointers is NULL. */
#define HAS_NULL(...) call_has_null(__func__, #__VA_ARGS__, (const void *const[]){__VA_ARGS__})
/* The index is not one of 0 to count - 1. */
#define BAD_INDEX(index, count) call_bad_index(__func__, #index, (int)(index), count)
/* `count` is negative, or the array of `count` elements is NULL. */
#define BAD_ARRAY(array, count) call_bad_array(__func__, #array, array, count)

/* Sets the text (printf format) and returns PDYN_BAD_CALL. function: __func__ of the public
 * function; users call NAME_sized as NAME. */
pdyn_status bad_call(const char *function, const char *format, ...) PDYN_PRINTF(2, 3);

bool call_has_null(const char *function, const char *names, const void *const *pointer);
bool call_bad_index(const char *function, const char *name, int index, int count);
bool call_bad_array(const char *function, const char *name, const void *array, int count);

#endif

/* Runs conformance on a type or solver and looks for the fault that it has. */
#ifndef WRONG_SUPPORT_H
#define WRONG_SUPPORT_H

#include "support.h"

#include "projdyn/module.h"

/* Whether conformance, or the registration, reports a text that contains `expected`; NULL: whether
 * it reports nothing. Prints what was reported otherwise. */
bool wrong_type_is_reported(pdyn_constraint_type type, const char *expected);
/* Fail where that is false. */
void wrong_expect_plugin(const pdyn_plugin *plugin, const char *expected);
void wrong_expect(pdyn_constraint_type type, const char *expected);

#endif

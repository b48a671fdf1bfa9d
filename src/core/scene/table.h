/* Tables: parameters with a row of numbers for each part of a body (pdyn_table). */
#ifndef PDYN_TABLE_H
#define PDYN_TABLE_H

#include "json_file.h"
#include "scene.h"

/* Reads a table from the value at `at`: an array of rows, one row for all parts of the body, or the
 * name of a text file (table_file.h). A missing value gives the default in every row, or no rows
 * where there is no default. The caller frees the table, after a failure, too. */
pdyn_status table_read(const struct json_at *at, const pdyn_param *param,
                       const struct scene_body *body, pdyn_table *out);
void table_free(pdyn_context *context, const pdyn_param *param, pdyn_table *table);

/* Allocates rows of zeros; returns their numbers, NULL without memory. */
double *table_allocate(pdyn_context *context, const pdyn_param *param, int rows, pdyn_table *out);
/* Continues a hash over the tables of a constraint. */
uint64_t table_hash(uint64_t hash, const pdyn_param *params, const void *values);

/* Whether a row may have this number in a column, after the numbers before it: one within the
 * bounds, or a vertex of a body of so many that the row does not have yet. */
bool table_allows(const pdyn_param *param, const double *row, int column, double value,
                  int vertices);
/* Appends what table_allows expects, e.g. "a vertex from 0 to 80". */
void table_describe_number(char *text, size_t size, const pdyn_param *param, int column,
                           int vertices);

/* What a row belongs to, e.g. "tetrahedron"; NULL: the table has any number of rows. */
const char *table_part(const pdyn_param *param);
/* Appends e.g. "24 LINES of 3 numbers, one per tetrahedron"; of rows of one number without LINES
 * where `lines` is NULL. rows 0: any number. */
void table_describe(char *text, size_t size, const pdyn_param *param, int rows, const char *lines);

#endif

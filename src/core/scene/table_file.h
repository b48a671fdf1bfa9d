/* Tables from text files: one row in each line, numbers with blanks or commas between them; the
 * rest of a line after '#' is a comment. */
#ifndef PDYN_TABLE_FILE_H
#define PDYN_TABLE_FILE_H

#include "base/param_kind.h"

/* Reads the file at `path`. rows: the number that it must have; 0: any, at least one. vertices: of
 * the body. The caller frees the table (table.h), after a failure, too. PDYN_BAD_INPUT: the error
 * text has file and line. */
pdyn_status table_file_read(pdyn_context *context, const char *path, const pdyn_param *param,
                            int rows, int vertices, pdyn_table *out);

#endif

/* Writing the cells of CSV files (RFC 4180). */
#ifndef CSV_H
#define CSV_H

#include <stdio.h>

/* Writes a text cell, quoted if it contains a comma, a quote or a line break. NULL writes an
 * empty cell. */
void csv_write_text(FILE *file, const char *text);

#endif

/* Cells of CSV files (RFC 4180). */
#ifndef CSV_H
#define CSV_H

#include <stdio.h>

/* With quotes where it needs them; NULL: an empty cell. */
void csv_text(FILE *file, const char *text);

#endif

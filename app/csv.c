/* Cells of CSV files (RFC 4180). */
#include "csv.h"

#include <string.h>

void csv_write_text(FILE *file, const char *text) {
    if (!text || !text[strcspn(text, ",\"\n\r")]) {
        fputs(text ? text : "", file);
        return;
    }
    fputc('"', file);
    for (; *text; text++) {
        if (*text == '"') fputc('"', file);
        fputc(*text, file);
    }
    fputc('"', file);
}

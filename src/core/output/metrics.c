/* The rows of metrics.csv, one per step. */
#include "base/clock.h"
#include "base/text.h"
#include "writer.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* Appends a row, completely or not at all, even on a full disk. */
static pdyn_status write_row(pdyn_writer *writer) {
    size_t length = strlen(writer->row);
    if (fwrite(writer->row, 1, length, writer->metrics) == length) {
        writer->metrics_size += (long)length;
        return PDYN_OK;
    }
    int error = errno;
    if (ftruncate(fileno(writer->metrics), writer->metrics_size))
        errno = error; /* no truncation: metrics is not a regular file */
    clearerr(writer->metrics);
    return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: writing failed: %s",
                        writer_path(writer, "metrics.csv"), strerror(error));
}

pdyn_status metrics_open(pdyn_writer *writer) {
#define STEP_HEADER(column, member) "," #column
    static const char header[] = STEP_NUMBERS(STEP_HEADER);
#undef STEP_HEADER
    const char *path = writer_path(writer, "metrics.csv");
    writer->metrics = fopen(path, "wbe");
    if (!writer->metrics)
        return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: cannot create the file: %s",
                            path, strerror(errno));
    setvbuf(writer->metrics, NULL, _IONBF, 0);
    *writer->row = '\0';
    text_append(writer->row, writer->row_size, "%s", header + 1);
    for (int b = 0; b < writer->sim->bodies; b++)
        text_append(writer->row, writer->row_size, ",residual_%s", writer->sim->body[b].name);
    text_append(writer->row, writer->row_size, "\n");
    return write_row(writer);
}

/* Appends a column; it is empty for a number that is not finite. */
static void append_number(pdyn_writer *writer, double number) {
    text_append(writer->row, writer->row_size, *writer->row ? "," : "");
    if (isfinite(number)) text_append(writer->row, writer->row_size, "%.9g", number);
}

static pdyn_status append_step(pdyn_writer *writer, const pdyn_step_info *info) {
    double number[STEP_COLUMNS];
    struct text_locale locale;
    if (!text_begin(&locale)) return context_no_memory(writer->context);
    step_numbers(info, number);
    *writer->row = '\0';
    for (int k = 0; k < STEP_COLUMNS; k++) append_number(writer, number[k]);
    for (int b = 0; b < writer->sim->bodies; b++)
        append_number(writer, writer->sim->objective.body[b].residual);
    text_append(writer->row, writer->row_size, "\n");
    text_end(&locale);
    return write_row(writer);
}

pdyn_status pdyn_writer_step(pdyn_writer *writer, const pdyn_step_info *info) {
    if (!writer || !info) return PDYN_BAD_CALL;
    double start = clock_ms();
    pdyn_status status = append_step(writer, info);
    report_step(&writer->report, writer->sim, info);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

pdyn_status metrics_reopen(pdyn_writer *writer) {
    const char *path = writer_path(writer, "metrics.csv");
    writer->metrics = fopen(path, "r+be");
    if (!writer->metrics)
        return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: cannot open the file: %s",
                            path, strerror(errno));
    setvbuf(writer->metrics, NULL, _IONBF, 0);
    if (fseek(writer->metrics, 0, SEEK_END) || ftell(writer->metrics) < writer->metrics_size)
        return context_fail(writer->context, PDYN_BAD_INPUT,
                            "%.1024s: the file is shorter than when the state was saved", path);
    if (ftruncate(fileno(writer->metrics), writer->metrics_size) ||
        fseek(writer->metrics, 0, SEEK_END))
        return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: cannot be cut: %s", path,
                            strerror(errno));
    return PDYN_OK;
}

/* The rows of metrics.csv, one per step. */
#include "base/clock.h"
#include "base/file_out.h"
#include "base/sized.h"
#include "base/text.h"
#include "writer.h"

#include <errno.h>
#include <fcntl.h>
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
    bool cut = !ftruncate(fileno(writer->metrics), writer->metrics_size) &&
               !fseek(writer->metrics, 0, SEEK_END);
    clearerr(writer->metrics);
    return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: writing failed: %s%s",
                        writer_path(writer, "metrics.csv"), strerror(error),
                        cut ? "" : "; the last row is incomplete");
}

/* Opens metrics.csv without following a link. `create`: O_CREAT or 0. */
static pdyn_status open_stream(pdyn_writer *writer, int create) {
    int descriptor;
    const char *path = writer_path(writer, "metrics.csv");
    pdyn_status status = file_open_in_place(writer->context, path, create, &descriptor);
    if (status != PDYN_OK) return status;
    writer->metrics = fdopen(descriptor, "r+b");
    if (!writer->metrics) {
        close(descriptor);
        return context_no_memory(writer->context);
    }
    setvbuf(writer->metrics, NULL, _IONBF, 0);
    return PDYN_OK;
}

static pdyn_status fail_cut(pdyn_writer *writer) {
    return context_fail(writer->context, PDYN_IO_FAILED, "%.1024s: cannot be cut: %s",
                        writer_path(writer, "metrics.csv"), strerror(errno));
}

pdyn_status metrics_open(pdyn_writer *writer) {
#define STEP_HEADER(column, member) "," #column
    static const char header[] = STEP_NUMBERS(STEP_HEADER);
#undef STEP_HEADER
    pdyn_status status = open_stream(writer, O_CREAT);
    if (status != PDYN_OK) return status;
    if (ftruncate(fileno(writer->metrics), 0)) return fail_cut(writer);
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

pdyn_status pdyn_writer_step_sized(pdyn_writer *writer, const pdyn_step_info *info, size_t size) {
    pdyn_step_info known;
    if (!writer || !info) return PDYN_BAD_CALL;
    sized_copy(&known, sizeof known, info, size);
    double start = clock_ms();
    pdyn_status status = append_step(writer, &known);
    report_step(&writer->report, writer->sim, &known);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

pdyn_status metrics_reopen(pdyn_writer *writer) {
    pdyn_status status = open_stream(writer, 0);
    if (status != PDYN_OK) return status;
    if (fseek(writer->metrics, 0, SEEK_END) || ftell(writer->metrics) < writer->metrics_size)
        return context_fail(writer->context, PDYN_BAD_INPUT,
                            "%.1024s: the file is shorter than when the state was saved",
                            writer_path(writer, "metrics.csv"));
    if (ftruncate(fileno(writer->metrics), writer->metrics_size) ||
        fseek(writer->metrics, 0, SEEK_END))
        return fail_cut(writer);
    return PDYN_OK;
}

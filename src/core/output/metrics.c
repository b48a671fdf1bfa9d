/* The rows of metrics.csv and probes.csv, one per step. */
#include "base/clock.h"
#include "base/sized.h"
#include "base/text.h"
#include "writer.h"

#include "projdyn/probe.h"

#include <math.h>
#include <string.h>

/* ---- rows ------------------------------------------------------------------------------------ */

/* A row is composed in writer->row. */
static void append_text(pdyn_writer *writer, const char *text) {
    text_append(writer->row, writer->row_size, "%s%s", *writer->row ? "," : "", text);
}

/* Appends a column; it is empty for a number that is not finite. */
static void append_number(pdyn_writer *writer, double number) {
    text_append(writer->row, writer->row_size, *writer->row ? "," : "");
    if (isfinite(number)) text_append(writer->row, writer->row_size, "%.9g", number);
}

static pdyn_status write_row(pdyn_writer *writer, struct csv_file *file) {
    text_append(writer->row, writer->row_size, "\n");
    pdyn_status status =
        csv_append(writer->context, writer_path(writer, "%s", file->name), file, writer->row);
    *writer->row = '\0';
    return status;
}

/* ---- metrics.csv ----------------------------------------------------------------------------- */

static pdyn_status begin_metrics(pdyn_writer *writer) {
#define STEP_HEADER(column, member) "," #column
    static const char header[] = STEP_NUMBERS(STEP_HEADER);
#undef STEP_HEADER
    append_text(writer, header + 1);
    for (int b = 0; b < writer->sim->bodies; b++)
        text_append(writer->row, writer->row_size, ",residual_%s", writer->sim->body[b].name);
    return write_row(writer, &writer->metrics);
}

static pdyn_status append_step(pdyn_writer *writer, const pdyn_step_info *info) {
    double number[STEP_COLUMNS];
    step_numbers(info, number);
    for (int k = 0; k < STEP_COLUMNS; k++) append_number(writer, number[k]);
    for (int b = 0; b < writer->sim->bodies; b++)
        append_number(writer, writer->sim->objective.body[b].residual);
    return write_row(writer, &writer->metrics);
}

/* ---- probes.csv ------------------------------------------------------------------------------ */

static pdyn_status begin_probes(pdyn_writer *writer) {
    pdyn_probe_info probe;
    append_text(writer, "time_s");
    for (int k = 0; (probe = pdyn_get_probe(writer->sim, k)).name; k++)
        for (int m = 0; m < probe.values; m++) append_text(writer, probe.column[m]);
    return write_row(writer, &writer->probes);
}

static pdyn_status append_probes(pdyn_writer *writer, double time) {
    pdyn_probe_info probe;
    append_number(writer, time);
    for (int k = 0; (probe = pdyn_get_probe(writer->sim, k)).name; k++)
        for (int m = 0; m < probe.values; m++) append_number(writer, probe.value[m]);
    return write_row(writer, &writer->probes);
}

/* ---- both ------------------------------------------------------------------------------------ */

pdyn_status metrics_open(pdyn_writer *writer) {
    const char *path = writer_path(writer, "%s", writer->metrics.name);
    pdyn_status status = csv_create(writer->context, path, &writer->metrics);
    if (status == PDYN_OK) status = begin_metrics(writer);
    if (status != PDYN_OK) return status;
    path = writer_path(writer, "%s", writer->probes.name);
    if (!writer->sim->probes) return previous_run_remove_file(writer, path);
    status = csv_create(writer->context, path, &writer->probes);
    return status == PDYN_OK ? begin_probes(writer) : status;
}

pdyn_status metrics_reopen(pdyn_writer *writer) {
    pdyn_status status = csv_reopen(
        writer->context, writer_path(writer, "%s", writer->metrics.name), &writer->metrics);
    if (status != PDYN_OK || !writer->sim->probes) return status;
    return csv_reopen(writer->context, writer_path(writer, "%s", writer->probes.name),
                      &writer->probes);
}

static pdyn_status append_rows(pdyn_writer *writer, const pdyn_step_info *info) {
    struct text_locale locale;
    if (!text_begin(&locale)) return context_no_memory(writer->context);
    pdyn_status status = append_step(writer, info);
    if (status == PDYN_OK && writer->sim->probes) status = append_probes(writer, info->time);
    text_end(&locale);
    return status;
}

pdyn_status pdyn_writer_step_sized(pdyn_writer *writer, const pdyn_step_info *info, size_t size) {
    pdyn_step_info known;
    if (!writer || !info) return PDYN_BAD_CALL;
    sized_copy(&known, sizeof known, info, size);
    double start = clock_ms();
    pdyn_status status = append_rows(writer, &known);
    report_step(&writer->report, writer->sim, &known);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

/* The rows of metrics.csv and probes.csv, one per step. */
#include "base/bad_call.h"
#include "base/clock.h"
#include "base/sized.h"
#include "base/text.h"
#include "sim/probes.h"
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

static const char *path_of(pdyn_writer *writer, const struct csv_file *file) {
    return writer_path(writer, "%s", file->name);
}

static pdyn_status write_row(pdyn_writer *writer, struct csv_file *file) {
    text_append(writer->row, writer->row_size, "\n");
    pdyn_status status = csv_append(path_of(writer, file), file, writer->row);
    *writer->row = '\0';
    return status;
}

/* ---- metrics.csv ----------------------------------------------------------------------------- */

/* Bytes for the numbers of a step, and for the name or the number of another column. */
enum { STEP_BYTES = 1024, COLUMN_BYTES = NAME_LENGTH + 32 };

static void begin_residuals(pdyn_writer *writer) {
    for (int b = 0; b < writer->sim->bodies; b++)
        text_append(writer->row, writer->row_size, ",residual_%s", writer->sim->body[b].name);
}

/* The number of constraints of the same type before this one on its body. */
static int number_of_type(const pdyn_sim *sim, int constraint) {
    const struct batch *const *batch = (const struct batch *const *)sim->objective.batch;
    const struct batch *of = batch[constraint];
    int number = 0;
    for (int k = constraint - 1; k >= 0 && batch[k]->view.body == of->view.body; k--)
        number += batch[k]->type == of->type;
    return number;
}

/* energy_BODY.TYPE_J of the first constraint of a type on a body, energy_BODY.TYPE.1_J of the next:
 * numbered as in Python. */
static void begin_energies(pdyn_writer *writer) {
    const struct objective *o = &writer->sim->objective;
    for (int k = 0; k < writer->sim->constraints; k++) {
        const struct batch *b = o->batch[k];
        int number = number_of_type(writer->sim, k);
        if (!type_stores_energy(b->type)) continue;
        text_append(writer->row, writer->row_size, ",energy_%s.%s", b->view.body->name,
                    b->type->name);
        if (number) text_append(writer->row, writer->row_size, ".%d", number);
        text_append(writer->row, writer->row_size, "_J");
    }
    if (o->barrier) append_text(writer, "energy_contact_J");
}

static void append_energies(pdyn_writer *writer) {
    const struct objective *o = &writer->sim->objective;
    for (int k = 0; k < writer->sim->constraints; k++)
        if (type_stores_energy(o->batch[k]->type)) append_number(writer, o->batch[k]->energy);
    if (o->barrier) append_number(writer, o->barrier->energy);
}

static pdyn_status begin_metrics(pdyn_writer *writer) {
#define STEP_HEADER(column, member) "," #column
    static const char header[] = STEP_NUMBERS(STEP_HEADER);
#undef STEP_HEADER
    append_text(writer, header + 1);
    begin_residuals(writer);
    begin_energies(writer);
    return write_row(writer, &writer->metrics);
}

static pdyn_status append_step(pdyn_writer *writer, const pdyn_step_info *info) {
    double number[STEP_COLUMNS];
    step_numbers(info, number);
    for (int k = 0; k < STEP_COLUMNS; k++) append_number(writer, number[k]);
    for (int b = 0; b < writer->sim->bodies; b++)
        append_number(writer, writer->sim->objective.body[b].residual);
    append_energies(writer);
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

size_t metrics_row_size(const pdyn_sim *sim) {
    size_t columns = (size_t)sim->bodies + (size_t)sim->constraints + 1, names = 0;
    for (int k = 0; k < sim->constraints; k++) names += strlen(sim->objective.batch[k]->type->name);
    return STEP_BYTES + COLUMN_BYTES * columns + names +
           (sim->probes ? (size_t)PROBE_COLUMN * (size_t)sim->probes->values : 0);
}

pdyn_status metrics_open(pdyn_writer *writer) {
    pdyn_status status =
        csv_create(writer->context, path_of(writer, &writer->metrics), &writer->metrics);
    if (status == PDYN_OK) status = begin_metrics(writer);
    if (status != PDYN_OK) return status;
    const char *path = path_of(writer, &writer->probes);
    if (!writer->sim->probes) return previous_run_remove_file(path);
    status = csv_create(writer->context, path, &writer->probes);
    return status == PDYN_OK ? begin_probes(writer) : status;
}

pdyn_status metrics_reopen(pdyn_writer *writer) {
    pdyn_status status =
        csv_reopen(writer->context, path_of(writer, &writer->metrics), &writer->metrics);
    if (status != PDYN_OK || !writer->sim->probes) return status;
    return csv_reopen(writer->context, path_of(writer, &writer->probes), &writer->probes);
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
    if (HAS_NULL(writer, info)) return PDYN_BAD_CALL;
    sized_copy(&known, sizeof known, info, size);
    if (known.time != writer->sim->time) /* residuals, energies and probes are those of now */
        return bad_call(__func__,
                        "info: expected that of the last step, to %.9g s, found one to %.9g s",
                        writer->sim->time, known.time);
    double start = clock_ms();
    pdyn_status status = append_rows(writer, &known);
    report_step(&writer->report, writer->sim, &known);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

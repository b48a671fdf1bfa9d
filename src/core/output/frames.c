/* Frames of a run: VTK and PLY files, one for each part, and the series that list them. */
#include "base/bad_call.h"
#include "base/clock.h"
#include "base/text.h"
#include "series.h"

/* ---- parts ----------------------------------------------------------------------------------- */

static int count_parts(const pdyn_writer *writer) {
    return writer->sim->bodies + 1 + writer->sim->scene.solids;
}

static struct part part_of_frame(const pdyn_writer *writer, int part) {
    const pdyn_sim *sim = writer->sim;
    int solid = part - sim->bodies - 1;
    if (part < sim->bodies) return (struct part){"", pdyn_get_body(sim, part).name, part, -1};
    if (solid < 0) return (struct part){"", sim->kinematic.points ? BOUNDARY : NULL, -1, -1};
    const struct scene_solid *s = &sim->scene.solid[solid];
    return (struct part){SOLIDS_FOLDER, s->motion.keys ? s->name : NULL, -1, solid};
}

/* ---- all series ------------------------------------------------------------------------------ */

pdyn_status frames_write_series(pdyn_writer *writer, int frames) {
    pdyn_status status = PDYN_OK;
    for (int p = 0; p < count_parts(writer) && status == PDYN_OK; p++)
        status = series_write(writer, part_of_frame(writer, p), frames);
    return status;
}

/* Lists frame f in all series. */
static pdyn_status list_frame(pdyn_writer *writer, int f) {
    struct text_locale locale;
    pdyn_status status = PDYN_OK;
    if (!text_begin(&locale)) return context_no_memory(writer->context);
    for (int p = 0; p < count_parts(writer) && status == PDYN_OK; p++) {
        struct part part = part_of_frame(writer, p);
        if (part.name) status = series_append(writer, part, f);
    }
    text_end(&locale);
    return status;
}

/* ---- frames ---------------------------------------------------------------------------------- */

static pdyn_status write_part(pdyn_writer *writer, struct part part) {
    if (!part.name) return PDYN_OK;
    const char *path =
        writer_path(writer, "%s%s_%06d" SHAPE_ENDING, part.folder, part.name, writer->frames);
    if (part.solid >= 0) return vtk_write_solid(writer->sim, part.solid, path);
    if (part.body < 0) return vtk_write_boundary(writer->sim, true, path);
    pdyn_status status = vtk_write_body(writer->sim, part.body, path);
    if (status != PDYN_OK || !writer->ply) return status;
    return ply_write_body(writer->sim, part.body,
                          writer_path(writer, "%s_%06d" PLY_ENDING, part.name, writer->frames));
}

pdyn_status frames_reserve_times(pdyn_writer *writer, int frames) {
    double *grown = context_grow(writer->context, writer->time, &writer->capacity, (size_t)frames,
                                 sizeof *grown);
    if (!grown && frames) return PDYN_NO_MEMORY;
    writer->time = grown;
    return PDYN_OK;
}

/* The next frame replaces those of its time and later: the times of a series rise. */
static pdyn_status append_time(pdyn_writer *writer) {
    double time = pdyn_time(writer->sim);
    while (writer->frames && writer->time[writer->frames - 1] >= time) writer->frames--;
    pdyn_status status = frames_reserve_times(writer, writer->frames + 1);
    if (status == PDYN_OK) writer->time[writer->frames] = time;
    return status;
}

/* Writes the files of a frame before the series that list them: a series never names a missing
 * file. */
static pdyn_status write_frame(pdyn_writer *writer) {
    pdyn_status status = append_time(writer);
    for (int p = 0; p < count_parts(writer) && status == PDYN_OK; p++)
        status = write_part(writer, part_of_frame(writer, p));
    if (status == PDYN_OK) status = list_frame(writer, writer->frames);
    if (status == PDYN_OK) writer->frames++;
    return status;
}

pdyn_status pdyn_writer_frame(pdyn_writer *writer) {
    if (HAS_NULL(writer)) return PDYN_BAD_CALL;
    double start = clock_ms();
    pdyn_status status = write_frame(writer);
    writer->report.output_ms += clock_ms() - start;
    return status;
}

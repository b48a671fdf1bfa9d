/* projdyn usd: the frames of a run as one USD stage in text (OpenUSD, format "usda 1.0"), for
 * Houdini, Maya and other programs. */
#include "app.h"
#include "new_file.h"
#include "run_to_file.h"
#include "usd_look.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: projdyn usd DIR [-o FILE]\n"
    "\n"
    "Writes the frames of a run as one file of USD, for Houdini, Maya and others: surfaces, soft "
    "and\n"
    "rigid bodies and solids as meshes, particles as points, fluids as meshes where `projdyn mesh "
    "DIR`\n"
    "has made them for all frames; with velocities, and materials in the colours of the scene or,\n"
    "without, of pictures.\n"
    "\n"
    "  -o, --output FILE  output file, .usda or .usd (default DIR/run.usda)\n"
    "  -h, --help         prints this text\n";

enum {
    PRIM_SIZE = PART_NAME + 96, /* of the name of a prim, with room for additions */
};

struct stage {
    FILE *file;
    const struct run *run;
    double start, rate;    /* time of the first frame, s; frames per second */
    struct usd_look *look; /* of each part that has a prim */
    char looks[PRIM_SIZE]; /* name of the prim that holds the materials */
};

/* ---- values ---------------------------------------------------------------------------------- */

typedef void put_fn(FILE *file, const struct vtk_frame *frame);

static void put_vectors(FILE *file, const float *v, int count, int digits) {
    for (int i = 0; i < count; i++, v += 3)
        fprintf(file, "%s(%.*g, %.*g, %.*g)", i ? ", " : "", digits, (double)v[0], digits,
                (double)v[1], digits, (double)v[2]);
}

static void put_points(FILE *file, const struct vtk_frame *frame) {
    put_vectors(file, frame->x, frame->count, 7);
}

static void put_velocities(FILE *file, const struct vtk_frame *frame) {
    put_vectors(file, frame->velocity, frame->count, 4);
}

static void put_normals(FILE *file, const struct vtk_frame *frame) {
    put_vectors(file, frame->normal, frame->count, 4);
}

static void put_counts(FILE *file, const struct vtk_frame *frame) {
    for (int t = 0; t < frame->triangles; t++) fputs(t ? ", 3" : "3", file);
}

static void put_corners(FILE *file, const struct vtk_frame *frame) {
    for (int k = 0; k < 3 * frame->triangles; k++)
        fprintf(file, "%s%d", k ? ", " : "", frame->triangle[k]);
}

/* ---- attributes ------------------------------------------------------------------------------ */

/* One value for all times, that of the first frame. */
static int put_constant(struct stage *stage, const struct part *part, const char *name,
                        put_fn *put) {
    char path[RUN_PATH];
    struct vtk_frame frame;
    int code = part_read_frame(stage->run, part, 0, path, &frame);
    if (code != EXIT_GOOD) return code;
    fprintf(stage->file, "        %s = [", name);
    put(stage->file, &frame);
    fputs("]\n", stage->file);
    vtk_frame_free(&frame);
    return EXIT_GOOD;
}

static double time_code(const struct stage *stage, const struct part *part, int f) {
    return round((part_time(part, f) - stage->start) * stage->rate * 1e6) * 1e-6;
}

/* A value for each frame. */
static int put_samples(struct stage *stage, const struct part *part, const char *name,
                       put_fn *put) {
    int code = EXIT_GOOD;
    if (part->rest) return put_constant(stage, part, name, put);
    fprintf(stage->file, "        %s.timeSamples = {\n", name);
    for (int f = 0; f < stage->run->frames && code == EXIT_GOOD; f++) {
        char path[RUN_PATH];
        struct vtk_frame frame;
        code = part_read_frame(stage->run, part, f, path, &frame);
        if (code != EXIT_GOOD) break;
        fprintf(stage->file, "            %.10g: [", time_code(stage, part, f));
        put(stage->file, &frame);
        fputs("],\n", stage->file);
        vtk_frame_free(&frame);
    }
    fputs("        }\n", stage->file);
    return code;
}

/* ---- prims ----------------------------------------------------------------------------------- */

/* Whether a part has this name. */
static bool is_name_of_part(const struct run *run, const char *name) {
    bool found = false;
    for (int p = 0; p < run->parts; p++) found |= !strcmp(run->part[p].name, name);
    return found;
}

/* The name of the prim: letters, digits and '_' alone, and no digit first; one that has changed
 * gets the number of the part, and then '_' as long as a part has this name, so that it is unique.
 */
static void make_name(const struct run *run, const struct part *part, char name[PRIM_SIZE]) {
    bool digit = isdigit((unsigned char)*part->name);
    int size = snprintf(name, PRIM_SIZE, "%s%s", digit ? "_" : "", part->name);
    for (char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c)) *c = '_';
    bool changed = strcmp(name, part->name) != 0;
    if (changed) size += snprintf(name + size, 16, "_%d", (int)(part - run->part));
    while (changed && is_name_of_part(run, name) && size < PRIM_SIZE - 1)
        name[size++] = '_', name[size] = 0;
}

/* Begins a prim with its colour, for programs that read no materials, and its material. */
static void begin_prim(struct stage *stage, const struct part *part, const char *type) {
    char name[PRIM_SIZE];
    struct usd_look *look = &stage->look[part - stage->run->part];
    bool points = !strcmp(type, "Points");
    if (points) look->opacity = 1.0;
    make_name(stage->run, part, name);
    fprintf(stage->file,
            "\n    def %s \"%s\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )\n"
            "    {\n        rel material:binding = </run/%s/%s>\n"
            "        color3f[] primvars:displayColor = [(%.4g, %.4g, %.4g)]\n"
            "        float[] primvars:displayOpacity = [%g]\n",
            type, name, stage->looks, name, look->color[0], look->color[1], look->color[2],
            look->opacity);
    if (look->two_sided && !points) fputs("        uniform bool doubleSided = 1\n", stage->file);
}

static int put_particles(struct stage *stage, const struct part *part) {
    begin_prim(stage, part, "Points");
    int code = put_samples(stage, part, "point3f[] points", put_points);
    if (code == EXIT_GOOD) code = put_samples(stage, part, "vector3f[] velocities", put_velocities);
    fprintf(stage->file,
            "        float[] widths = [%.7g] (\n            interpolation = \"constant\"\n        "
            ")\n    }\n",
            2.0 * part->radius);
    return code;
}

/* surface: the part, or the surface of a fluid, whose triangles are others in each frame. */
static int put_mesh(struct stage *stage, const struct part *part, const struct part *surface) {
    int (*put)(struct stage *, const struct part *, const char *, put_fn *) =
        surface == part ? put_constant : put_samples;
    begin_prim(stage, part, "Mesh");
    fputs("        uniform token subdivisionScheme = \"none\"\n", stage->file);
    int code = put(stage, surface, "int[] faceVertexCounts", put_counts);
    if (code == EXIT_GOOD) code = put(stage, surface, "int[] faceVertexIndices", put_corners);
    if (code == EXIT_GOOD) code = put_samples(stage, surface, "point3f[] points", put_points);
    if (code == EXIT_GOOD && part->kind == BODY)
        code = put_samples(stage, surface, "vector3f[] velocities", put_velocities);
    if (code == EXIT_GOOD && surface != part) {
        fputs("        normal3f[] normals (\n            interpolation = \"vertex\"\n        )\n",
              stage->file);
        code = put_samples(stage, surface, "normal3f[] normals", put_normals);
    }
    fputs("    }\n", stage->file);
    return code;
}

/* The surface of a fluid must have the frames of the run: `projdyn mesh` makes those that were
 * there, or those of --frames. */
static int check_frames(const struct run *run, const struct part *surface) {
    int listed = (int)json_array_size(surface->files);
    bool same = listed == run->frames;
    for (int f = 0; f < run->frames && same; f++)
        same = part_has_time(surface, f, part_time(&run->part[0], f));
    if (same) return EXIT_GOOD;
    return run_error("%s/mesh/%s.vtk.series: expected the %d frames of the run, found %d%s: run "
                     "`projdyn mesh %s` again, or delete the folder mesh for particles",
                     run->directory, surface->name, run->frames, listed,
                     listed == run->frames ? " of other times" : "",
                     shell_word(run->directory).text);
}

/* Meshes of the other formats of `projdyn mesh` are not read. */
static int refuse_other_formats(const struct run *run, const struct part *part) {
    static const char *const ending[] = {"ply", "obj"};
    for (int k = 0; k < 2; k++) {
        char path[RUN_PATH];
        run_path(path, run, "mesh/%s_000000.%s", part->name, ending[k]);
        if (!access(path, F_OK))
            return run_error("%s: expected a mesh with --format vtk: run `projdyn mesh %s` again, "
                             "or delete the folder mesh for particles",
                             path, shell_word(run->directory).text);
    }
    return EXIT_GOOD;
}

/* A fluid: the surface that `projdyn mesh` has made, else its particles. */
static int put_fluid(struct stage *stage, const struct part *part) {
    char path[RUN_PATH];
    struct part surface = {.kind = BODY, .folder = "mesh/", .name = part->name};
    run_path(path, stage->run, "mesh/%s.vtk.series", part->name);
    if (access(path, F_OK)) {
        int code = refuse_other_formats(stage->run, part);
        return code == EXIT_GOOD ? put_particles(stage, part) : code;
    }
    int code = part_open_series(stage->run, &surface);
    if (code == EXIT_GOOD) code = check_frames(stage->run, &surface);
    if (code == EXIT_GOOD) code = put_mesh(stage, part, &surface);
    json_decref(surface.series);
    return code;
}

static int put_part(struct stage *stage, const struct part *part) {
    if (part->kind == BOUNDARY) return EXIT_GOOD;
    if (part->fluid) return put_fluid(stage, part);
    return part->radius > 0.0 ? put_particles(stage, part) : put_mesh(stage, part, part);
}

/* ---- materials ------------------------------------------------------------------------------- */

static void put_material(FILE *file, const char *looks, const char *name,
                         const struct usd_look *look) {
    fprintf(file,
            "\n        def Material \"%s\"\n        {\n"
            "            token outputs:surface.connect = </run/%s/%s/surface.outputs:surface>\n"
            "\n            def Shader \"surface\"\n            {\n"
            "                uniform token info:id = \"UsdPreviewSurface\"\n"
            "                color3f inputs:diffuseColor = (%.4g, %.4g, %.4g)\n"
            "                float inputs:ior = %g\n"
            "                float inputs:opacity = %g\n"
            "                float inputs:roughness = %g\n"
            "                token outputs:surface\n            }\n        }\n",
            name, looks, name, look->color[0], look->color[1], look->color[2], look->ior,
            look->opacity, look->roughness);
}

/* The materials of all prims, which have their names. */
static void put_materials(struct stage *stage) {
    fprintf(stage->file, "\n    def Scope \"%s\"\n    {", stage->looks);
    for (int p = 0; p < stage->run->parts; p++) {
        char name[PRIM_SIZE];
        if (stage->run->part[p].kind == BOUNDARY) continue;
        make_name(stage->run, &stage->run->part[p], name);
        put_material(stage->file, stage->looks, name, &stage->look[p]);
    }
    fputs("    }\n", stage->file);
}

/* ---- the command ----------------------------------------------------------------------------- */

static int put_stage(struct stage *stage) {
    const struct run *run = stage->run;
    const struct part *first = &run->part[0];
    int last = run->frames - 1, code = usd_find_looks(run, stage->look);
    if (code != EXIT_GOOD) return code;
    strcpy(stage->looks, "Looks");
    while (is_name_of_part(run, stage->looks)) strcat(stage->looks, "_");
    stage->start = part_time(first, 0);
    stage->rate = last ? 1.0 / (part_time(first, 1) - stage->start) : 24.0;
    fprintf(
        stage->file,
        "#usda 1.0\n(\n    defaultPrim = \"run\"\n    doc = \"projdyn %s\"\n"
        "    metersPerUnit = 1\n    upAxis = \"%s\"\n    startTimeCode = 0\n"
        "    endTimeCode = %.10g\n    timeCodesPerSecond = %.10g\n    framesPerSecond = %.10g\n)\n"
        "\ndef Xform \"run\"\n{",
        pdyn_version(), run_is_z_up(run) ? "Z" : "Y", time_code(stage, first, last), stage->rate,
        stage->rate);
    for (int p = 0; p < run->parts && code == EXIT_GOOD; p++) code = put_part(stage, &run->part[p]);
    if (code == EXIT_GOOD) put_materials(stage);
    fputs("}\n", stage->file);
    return code;
}

/* Programs choose the reader by the ending; .usd may be text. */
static int check_ending(const char *path) {
    const char *ending = strrchr(path, '.');
    if (ending && (!strcmp(ending, ".usda") || !strcmp(ending, ".usd"))) return EXIT_GOOD;
    return run_error(
        "--output: found \"%s\", expected a file ending with .usda or .usd, which holds "
        "text; `usdcat FILE.usda -o FILE.usdc` converts it",
        path);
}

static int write_stage(struct run *run, const char *path) {
    char *temporary;
    int code = check_ending(path);
    if (code == EXIT_GOOD) code = run_open_with_report(run);
    if (code != EXIT_GOOD) return code;
    struct stage stage = {.run = run, .look = calloc((size_t)run->parts, sizeof *stage.look)};
    if (!stage.look) return report_no_memory();
    stage.file = new_file_open(path, &temporary);
    code = stage.file ? put_stage(&stage) : report_write_error(path);
    free(stage.look);
    if (!stage.file) return code;
    bool written = new_file_close(stage.file, temporary, path, code == EXIT_GOOD);
    return code == EXIT_GOOD && !written ? report_write_error(path) : code;
}

int usd_main(int argc, char **argv) {
    return run_to_file(argc, argv, usage, "run.usda", write_stage);
}

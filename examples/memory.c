/* A scene without a file: scenes/water_on_cloth.json, made by a program. Prints the hash of the
 * state after the number of steps given as argument. C or C++.
 *
 *     cc -o memory memory.c $(pkg-config --cflags --libs projdyn) && ./memory 5
 */
#include <projdyn/scene.h>

#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 93, CELLS = SIDE - 1, NX = 50, NY = 8, NZ = 50 };
static double vertex[SIDE * SIDE][3], particle[NX * NY * NZ][3];
static int triangle[CELLS * CELLS][6]; /* two triangles per cell, with alternating diagonals */

static const char *const values[][2] = {
    {"duration", "3"},
    {"frame_interval", "0.04"},
    {"time_step.maximum", "0.005"},
    {"solver", "{\"tolerance\": 0.3, \"outer_iterations\": 100, \"linear_tolerance\": 0.3}"},
    {"bodies.water.particles", "{\"radius\": 0.005, \"fill\": [{\"file\": \"water.ply\"}]}"},
    {"bodies.water.constraints.fluid", "{\"compression\": 0.002, \"viscosity\": 0.2}"},
    {"bodies.sheet.surface", "{\"translate\": [0, 0.28, 0], \"area_density\": 0.3}"},
    {"bodies.sheet.surface.mesh", "sheet.ply"},
    {"bodies.sheet.constraints.spring.stretching_stiffness", "10000"},
    {"bodies.sheet.constraints.bending.bending_rigidity", "1e-4"},
    {"bodies.sheet.constraints.pin.vertices.border", "true"},
    {"solids.tray.box", "{\"minimum\": [-0.55, 0, -0.55], \"maximum\": [0.55, 0.4, 0.55]}"},
    {"solids.tray.open.0", "+y"},
    {"outlets.0.box", "{\"minimum\": [-0.6, -0.1, -0.6], \"maximum\": [0.6, 2, 0.6]}"},
    {"outlets.0.outside", "true"}};

/* A sheet of 0.9 m x 0.9 m whose middle hangs 0.1 m below its border. */
static void make_sheet(void) {
    for (int i = 0; i < SIDE * SIDE; i++) {
        double a = (i % SIDE) / (double)CELLS - 0.5, b = (i / SIDE) / (double)CELLS - 0.5;
        vertex[i][0] = 0.9 * a, vertex[i][2] = 0.9 * b;
        vertex[i][1] = -0.1 * (1 - 4 * a * a) * (1 - 4 * b * b);
    }
    for (int c = 0; c < CELLS * CELLS; c++) {
        int i = c % CELLS, j = c / CELLS, p = j * SIDE + i, q = p + 1, s = p + SIDE, r = s + 1;
        const int even[6] = {p, s, r, p, r, q}, odd[6] = {p, s, q, q, s, r};
        for (int k = 0; k < 6; k++) triangle[c][k] = (i + j) % 2 ? odd[k] : even[k];
    }
}

/* Particles of radius 5 mm on a lattice, from the corner (-0.25, 0.24, -0.25) m on. */
static void make_water(void) {
    const double corner[3] = {-0.25, 0.24, -0.25};
    for (int i = 0; i < NX * NY * NZ; i++) {
        const int cell[3] = {i % NX, i / NX % NY, i / NX / NY};
        for (int k = 0; k < 3; k++) particle[i][k] = corner[k] + 0.005 * (2 * cell[k] + 1);
    }
}

static pdyn_status load(pdyn_scene *scene, pdyn_sim **sim) {
    pdyn_status status =
        pdyn_scene_mesh(scene, "sheet.ply", SIDE * SIDE, vertex[0], 2 * CELLS * CELLS, triangle[0]);
    if (status == PDYN_OK)
        status = pdyn_scene_particles(scene, "water.ply", NX * NY * NZ, particle[0], NULL);
    for (size_t k = 0; k < sizeof values / sizeof *values && status == PDYN_OK; k++)
        status = pdyn_scene_set(scene, values[k][0], "%s", values[k][1]);
    return status == PDYN_OK ? pdyn_scene_load(scene, sim) : status;
}

int main(int argc, char **argv) {
    pdyn_context *context = NULL;
    pdyn_scene *scene = NULL;
    pdyn_sim *sim = NULL;
    make_sheet();
    make_water();
    pdyn_status status = pdyn_create(NULL, &context);
    if (status == PDYN_OK) status = pdyn_scene_create(context, "water on a cloth", &scene);
    if (status == PDYN_OK) status = load(scene, &sim);
    for (int k = 0; k < (argc > 1 ? atoi(argv[1]) : 1) && status == PDYN_OK; k++)
        status = pdyn_step(sim, NULL);
    if (status == PDYN_OK) printf("%016llx\n", (unsigned long long)pdyn_state_hash(sim));
    else fprintf(stderr, "%s\n", pdyn_last_error(context));
    pdyn_free(sim);
    pdyn_scene_free(scene);
    pdyn_destroy(context);
    return status != PDYN_OK;
}

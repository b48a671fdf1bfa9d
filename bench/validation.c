/* The fluid against experiments and exact results. Each command writes CSV files into DIRECTORY and
 * prints a table as markdown:
 *
 *     validation martin_moyce DIRECTORY CELLS[:INTEGRATOR]...  dam break, CELLS particles across
 *     validation tank DIRECTORY SECONDS DEPTHxWIDTH...  at rest, so many particles deep and wide
 *     validation sloshing DIRECTORY SECONDS CELLS       first mode, CELLS particles along the tank
 *
 * The box of a tank holds fluid up to its faces: particles rest half a spacing from them. So
 * lengths count from the faces, and water ends half a spacing beyond its outermost particles. */
#include "validation.h"

#include <stdlib.h>
#include <string.h>

void *allocate(size_t count, size_t size) {
    void *block = calloc(count, size);
    if (!block) die("out of memory");
    return block;
}

/* At rest the error is about 0.45 p d / w. */
static double stiffness(const struct water *water) {
    double pressure = DENSITY * g * water->cells[1] * water->spacing;
    return 0.45 * pressure * water->spacing / 1e-3;
}

static const char solved[] = "'tolerance': 0.1, 'linear_tolerance': 0.1, 'linear_iterations': 2000";
static const char cut_short[] = "'tolerance': 0.01, 'linear_tolerance': 0, "
                                "'linear_iterations': 10, 'outer_iterations': 1";

pdyn_sim *water_load(pdyn_context *context, const struct water *water) {
    const double d = water->spacing, *tank = water->tank;
    const int *n = water->cells;
    return load_text(
        context,
        "{'duration': %.17g, 'frame_interval': %.17g, 'time_step': {'integrator': "
        "'%s', '%s': %.17g}, "
        "'solver': {%s}, 'bodies': [{'name': 'water', 'velocity': [%.17g, 0, 0], "
        "'particles': {'radius': %.17g, 'rest_density': %d, 'fill': [{'box': "
        "{'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, %.17g]}}]}, 'constraints': "
        "[{'type': 'fluid', 'stiffness': %.17g, 'viscosity': %.17g}]}], 'solids': "
        "[{'box': {'minimum': [0, 0, 0], 'maximum': [%.17g, %.17g, %.17g]}, 'open': "
        "['+y']}]}",
        water->duration, water->duration, water->integrator ? water->integrator : "euler",
        water->adaptive ? "maximum" : "fixed", water->step, water->cut_short ? cut_short : solved,
        water->speed, 0.5 * d, DENSITY, n[0] * d, n[1] * d, n[2] * d, stiffness(water),
        water->viscosity, tank[0], tank[1], tank[2]);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sort(double *values, int count) { qsort(values, (size_t)count, sizeof *values, ascending); }

void fit_add(struct fit *fit, double x, double y) {
    fit->n++, fit->x += x, fit->y += y, fit->xx += x * x, fit->xy += x * y;
}

double fit_slope(const struct fit *fit) {
    return (fit->n * fit->xy - fit->x * fit->y) / (fit->n * fit->xx - fit->x * fit->x);
}

int main(int argc, char **argv) {
    const char *command = argc > 3 ? argv[1] : "";
    pdyn_context *context = make_context(0);
    if (!strcmp(command, "martin_moyce")) martin_moyce(context, argv[2], argc - 3, argv + 3);
    else if (!strcmp(command, "tank") && argc > 4)
        tank(context, argv[2], atof(argv[3]), argc - 4, argv + 4);
    else if (!strcmp(command, "sloshing") && argc == 5)
        sloshing(context, argv[2], atof(argv[3]), atoi(argv[4]));
    else if (!strcmp(command, "elastica")) elastica(context, argv[2], argc - 3, argv + 3);
    else if (!strcmp(command, "catenary")) catenary(context, argv[2], argc - 3, argv + 3);
    else if (!strcmp(command, "chain") && argc > 4)
        chain(context, argv[2], atoi(argv[3]), argc - 4, argv + 4);
    else if (!strcmp(command, "buckling")) buckling(context, argv[2], argc - 3, argv + 3);
    else if (!strcmp(command, "sheet")) sheet(context, argv[2], argc - 3, argv + 3);
    else if (!strcmp(command, "stretch")) stretch(context, argv[2], argc - 3, argv + 3);
    else
        die("usage: validation martin_moyce DIRECTORY CELLS... | tank DIRECTORY SECONDS "
            "DEPTHxWIDTH... | sloshing DIRECTORY SECONDS CELLS");
    pdyn_destroy(context);
    return 0;
}

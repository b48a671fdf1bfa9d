/* A note about angles that are multiples of 30 or 45 degrees in radians, such as 1.5708. */
#include "angles.h"

#include <math.h>
#include <string.h>

static const double rounding = 2e-3; /* rad: 3.14 stands for 180 degrees */

/* The usual angle, degrees, that `angle` is in radians; 0: none. */
static double usual_angle(double angle) {
    static const double steps[] = {30.0, 45.0};
    double turned = fabs(angle) * 180.0 / acos(-1.0);
    for (int k = 0; k < 2; k++) {
        double nearest = steps[k] * round(turned / steps[k]);
        if (nearest > 0.0 && nearest <= 360.0 &&
            fabs(turned - nearest) * acos(-1.0) / 180.0 < rounding)
            return copysign(nearest, angle);
    }
    return 0.0;
}

void angles_note(const struct json_at *at, const char *unit, const double *value, int count) {
    for (int k = 0; k < count && !strcmp(unit, "degrees"); k++) {
        double usual = usual_angle(value[k]);
        if (usual != 0.0)
            json_note(at, "%g degrees is the angle of %g degrees in radians; the unit is degrees",
                      value[k], usual);
    }
}

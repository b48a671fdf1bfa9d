/* Surfaces of fluids for the page, which draws them instead of what it makes of the particles. */
#ifndef RENDER_WATER_SURFACE_H
#define RENDER_WATER_SURFACE_H

#include "browser.h"
#include "run_directory.h"

/* Makes the surfaces of all fluids at a frame and hands them to the page, if its view shows water
 * as a surface. Returns an exit code, after a message unless it is EXIT_GOOD. */
int water_surface_send(struct browser *browser, const struct run *run, int frame);

#endif

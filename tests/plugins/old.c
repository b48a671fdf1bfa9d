/* A plug-in of another version. */
#include "projdyn/module.h"

const pdyn_plugin pdyn_plugin_table = {PDYN_ABI - 1, "old", NULL, NULL};

/* A plug-in with another PDYN_ABI. */
#include "projdyn/module.h"

const pdyn_plugin pdyn_plugin_table = {PDYN_ABI - 1, "old", NULL, NULL};

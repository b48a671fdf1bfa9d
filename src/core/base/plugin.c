/* Loading plug-ins: shared objects with one data symbol, pdyn_plugin_table. A plug-in is never
 * unloaded, because simulations and other contexts may refer to its tables. */
#include "bad_call.h"
#include "context.h"
#include "projdyn/module.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static pdyn_status fail_load(const char *path) {
    const char *why = dlerror(), *dot = strrchr(path, '.');
    return set_error(PDYN_BAD_INPUT, "%.1024s: the plug-in cannot be loaded: %s%s", path,
                     why ? why : "unknown reason",
                     dot && !strcmp(dot, ".c")
                         ? "; compile it first: cc -shared -fPIC "
                           "$(pkg-config --cflags projdyn) -o NAME.so NAME.c -lm"
                         : "");
}

/* Opens a shared object. dlopen searches system directories for a name without a slash; "./" in
 * front makes it the current directory. */
static void *open_object(pdyn_context *context, const char *path) {
    if (strchr(path, '/')) return dlopen(path, RTLD_NOW | RTLD_LOCAL);
    size_t size = strlen(path) + 3;
    char *here = NEW_ARRAY(context, size, char);
    if (!here) return NULL;
    snprintf(here, size, "./%s", path);
    void *object = dlopen(here, RTLD_NOW | RTLD_LOCAL);
    FREE_ARRAY(context, here, size);
    return object;
}

/* Whether the process has memory at an address. */
static bool is_mapped(const void *at) {
    uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
    unsigned char unused;
    return !mincore((void *)((uintptr_t)at / page * page), 1, &unused) || errno != ENOMEM;
}

/* The type whose table of parameters runs on into other data, because it has no end {0}: there is
 * no memory at what would be a name. NULL: none. */
static const pdyn_constraint_type *find_endless(const pdyn_plugin *plugin) {
    const pdyn_constraint_type *const *t = plugin->abi == PDYN_ABI ? plugin->constraints : NULL;
    for (; t && *t; t++)
        for (const pdyn_param *p = (*t)->params; p && p->name; p++)
            if (!is_mapped(p->name)) return *t;
    return NULL;
}

static pdyn_status register_table(pdyn_context *context, const pdyn_plugin *plugin) {
    const pdyn_constraint_type *endless = find_endless(plugin);
    if (!endless) return pdyn_register(context, plugin);
    return set_error(PDYN_BAD_INPUT,
                     "type \"%.64s\": its table of parameters has no end: expected {0} after the "
                     "last one",
                     endless->name ? endless->name : "");
}

pdyn_status pdyn_load_plugin(pdyn_context *context, const char *path) {
    if (HAS_NULL(context, path)) return PDYN_BAD_CALL;
    if (!*path) return bad_call(__func__, "path is empty");
    dlerror();
    void *object = open_object(context, path);
    if (!object) return fail_load(path);
    const pdyn_plugin *plugin = dlsym(object, "pdyn_plugin_table");
    if (!plugin)
        return set_error(PDYN_BAD_INPUT,
                         "%.1024s: not a plug-in: it has no symbol pdyn_plugin_table", path);
    pdyn_status status = register_table(context, plugin);
    if (status != PDYN_BAD_INPUT) return status;
    return set_error(status, "%.1000s: %.1000s", path, pdyn_last_error(NULL));
}

#include "warning_support.h"

#include <string.h>

pdyn_warning find_warning(const pdyn_sim *sim, const char *code, const char *subject) {
    pdyn_warning w;
    for (int k = 0; (w = pdyn_get_warning(sim, k)).code; k++)
        if (!strcmp(w.code, code) && !strcmp(w.subject, subject)) return w;
    return (pdyn_warning){0};
}

bool warns(const char *scene, const char *code, const char *subject) {
    pdyn_sim *sim = test_open(scene);
    bool found = find_warning(sim, code, subject).code;
    test_close(sim);
    return found;
}

#include "wrong_support.h"

#include "projdyn/conformance.h"

#include <string.h>

struct told {
    const char *expected;
    bool found;
    char all[4096];
};

static void listen(void *user, const char *text) {
    struct told *told = user;
    size_t length = strlen(told->all);
    told->found |= strstr(text, told->expected) != NULL;
    snprintf(told->all + length, sizeof told->all - length, "  %s\n", text);
}

static bool is_reported(const pdyn_plugin *plugin, const char *expected) {
    struct told told = {.expected = expected ? expected : ""};
    int faults = 1;
    pdyn_context *context = test_context(1);
    if (pdyn_register(context, plugin) != PDYN_OK) listen(&told, pdyn_last_error(context));
    else assert_int_equal(pdyn_conformance(context, NULL, listen, &told, &faults), PDYN_OK);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
    if (expected ? told.found : !faults) return true;
    print_error("expected %s%s, found:\n%s", expected ? "the fault " : "no fault", told.expected,
                told.all);
    return false;
}

bool wrong_type_is_reported(pdyn_constraint_type type, const char *expected) {
    const pdyn_constraint_type *const types[] = {&type, NULL};
    const pdyn_plugin plugin = {PDYN_ABI, "p", types, NULL};
    return is_reported(&plugin, expected);
}

void wrong_expect_plugin(const pdyn_plugin *plugin, const char *expected) {
    assert_true(is_reported(plugin, expected));
}

void wrong_expect(pdyn_constraint_type type, const char *expected) {
    assert_true(wrong_type_is_reported(type, expected));
}

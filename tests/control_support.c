#include "control_support.h"

pdyn_context *context;

int control_set_up(void **state) {
    context = test_context(2);
    return test_enter_directory(state);
}

int control_tear_down(void **state) {
    pdyn_destroy(context);
    return test_leave_directory(state);
}

void good(pdyn_status status) {
    if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
}

void refused(pdyn_status status, const char *expected) {
    assert_int_equal(status, PDYN_BAD_INPUT);
    assert_string_equal(pdyn_last_error(context), expected);
}

void take_steps(pdyn_sim *sim, int count) {
    for (int k = 0; k < count; k++) good(pdyn_step(sim, NULL));
}

int all_points(const void *par, const pdyn_body *body) { return (void)par, body->count; }

void select_point(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int e = first; e < last; e++) b->column[e] = b->body->first + e, b->coefficient[e] = 1.0;
}

void put_on_plane(const void *par, const pdyn_batch *b, int first, int last) {
    (void)par;
    for (int k = 3 * first; k < 3 * last; k++) b->p[k] = k % 3 == 1 ? 0.0 : b->u[k];
}

void continues(pdyn_sim *sim, const char *text) {
    good(pdyn_save(sim, "state"));
    pdyn_sim *other = test_load(context, text);
    good(pdyn_restore(other, "state"));
    take_steps(sim, 5), take_steps(other, 5);
    assert_true(pdyn_state_hash(sim) == pdyn_state_hash(other));
    pdyn_free(other);
    test_remove_file("state");
}

/* Forged states: the bytes of a saved state are changed and its checksum is corrected. Such a state
 * is refused, and the simulation continues as before it, or is accepted and harmless.
 * PROJDYN_FORGED=N forges N states of each scene. */
#include "contact/contact_parts.h"
#include "small_scenes.h"
#include "support.h"

#include "base/snapshot_file.h"
#include "sim/live_particles.h"

#include <math.h>
#include <string.h>

enum { STEPS = 12, STATES = 150 /* forged states of each scene */ };

/* ---- files of states ------------------------------------------------------------------------- */

/* The file has HEAD bytes, the content, and TAIL bytes with the hash of the content. */
enum { HEAD = 16, TAIL = 8 };
struct file {
    unsigned char data[1 << 20];
    size_t size;
};

static void read_file(const char *path, struct file *out) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    out->size = fread(out->data, 1, sizeof out->data, file);
    assert_true(out->size > HEAD + TAIL && out->size < sizeof out->data);
    assert_int_equal(fclose(file), 0);
}

/* Writes the file with a correct checksum. */
static void write_file(const char *path, struct file *file) {
    uint64_t hash = hash_bytes(HASH_BEGIN, file->data + HEAD, file->size - HEAD - TAIL);
    memcpy(file->data + file->size - TAIL, &hash, sizeof hash);
    test_write_file(path, (const char *)file->data, file->size);
}

/* Replaces the int that `after` bytes of content follow. */
static void replace_int(const char *path, size_t after, int expected, int value) {
    static struct file file;
    int found;
    read_file(path, &file);
    unsigned char *at = file.data + file.size - TAIL - after - sizeof found;
    memcpy(&found, at, sizeof found);
    assert_int_equal(found, expected);
    memcpy(at, &value, sizeof value);
    write_file(path, &file);
}

/* ---- random bytes ---------------------------------------------------------------------------- */

static void assert_finite(const pdyn_sim *sim) {
    const pdyn_state s = pdyn_get_state(sim);
    for (int k = 0; k < 3 * s.particles; k++) assert_true(isfinite(s.x[k]) && isfinite(s.v[k]));
}

/* Restores the good state, then the forged one, from memory or its file, and takes a step. next:
 * the hash after a step from the good state. Returns whether the forged state was refused. A
 * simulation whose step failed is replaced. */
static bool try_forged(pdyn_context *context, const char *text, pdyn_sim **sim,
                       const struct file *memory, uint64_t next) {
    pdyn_status status = pdyn_restore(*sim, "state");
    if (status != PDYN_OK) fail_msg("%s", pdyn_last_error(context));
    status = memory ? pdyn_restore_memory(*sim, memory->data, memory->size)
                    : pdyn_restore(*sim, "forged");
    bool refused = status != PDYN_OK;
    if (refused) {
        assert_int_equal(status, PDYN_BAD_INPUT);
        assert_error("state");
    }
    status = pdyn_step(*sim, NULL);
    if (refused) assert_true(status == PDYN_OK && pdyn_state_hash(*sim) == next);
    assert_finite(*sim);
    if (status == PDYN_OK) return refused;
    pdyn_free(*sim);
    *sim = test_load(context, text);
    return refused;
}

/* Values that are valid for few fields. */
static const double numbers[] = {0.0, -1.0, 1e-300, 1e9, 1e300, -1e300, NAN, INFINITY};
static const int integers[] = {0, -1, 1, 1 << 20, INT32_MAX, INT32_MIN};
enum {
    NUMBERS = sizeof numbers / sizeof *numbers,
    INTEGERS = sizeof integers / sizeof *integers,
    WORD = sizeof(double)
};

static size_t random_below(uint64_t *seed, size_t count) {
    return (size_t)(0.5 * (test_random(seed) + 1.0) * (double)count);
}

/* Changes one byte, or replaces an integer or a number. */
static void forge(struct file *file, int kind, uint64_t *seed) {
    size_t at = random_below(seed, file->size - HEAD - TAIL - WORD);
    if (kind % 3) at -= at % sizeof(int);
    unsigned char *word = file->data + HEAD + at;
    if (kind % 3 == 0) word[0] ^= (unsigned char)(1 + random_below(seed, UINT8_MAX));
    if (kind % 3 == 1) memcpy(word, &integers[random_below(seed, INTEGERS)], sizeof *integers);
    if (kind % 3 == 2) memcpy(word, &numbers[random_below(seed, NUMBERS)], sizeof *numbers);
}

static void forge_states(const char *text, int count, uint64_t seed) {
    static struct file file;
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, text);
    int refused = 0;
    for (int k = 0; k < STEPS; k++) test_step(sim);
    assert_int_equal(pdyn_save(sim, "state"), PDYN_OK);
    test_step(sim);
    uint64_t next = pdyn_state_hash(sim);
    read_file("state", &file);
    for (int k = 0; k < count; k++) {
        static struct file forged;
        forged = file;
        forge(&forged, k, &seed);
        write_file("forged", &forged);
        bool as_file = try_forged(context, text, &sim, NULL, next);
        assert_true(try_forged(context, text, &sim, &forged, next) == as_file);
        refused += as_file;
    }
    pdyn_free(sim);
    assert_in_range(refused, 1, count - 1);
    assert_int_equal(pdyn_bytes_in_use(context), 0);
    pdyn_destroy(context);
    test_remove_file("state"), test_remove_file("forged");
}

static void test_states(void **state) {
    (void)state;
    const char *count = getenv("PROJDYN_FORGED");
    for (int k = 0; k < SMALL_SCENES; k++)
        if (!test_lacks_solver(small_scenes[k]))
            forge_states(small_scenes[k], count ? atoi(count) : STATES, (uint64_t)k);
}

/* Bytes of a state in memory that were changed or cut off, without a correct checksum. */
static void test_damaged_memory(void **state) {
    (void)state;
    static struct file file;
    uint64_t seed = 0;
    pdyn_sim *sim = test_open(cloth);
    assert_int_equal(pdyn_save_memory(sim, file.data, sizeof file.data, &file.size), PDYN_OK);
    for (int k = 0; k < STATES; k++) {
        size_t at = random_below(&seed, file.size);
        unsigned char *cut = malloc(at + 1); /* exact, for the address sanitizer */
        memcpy(cut, file.data, at);
        assert_int_equal(pdyn_restore_memory(sim, cut, at), PDYN_BAD_INPUT);
        free(cut);
        file.data[at] ^= 1;
        assert_int_equal(pdyn_restore_memory(sim, file.data, file.size), PDYN_BAD_INPUT);
        assert_error("the state in memory: ");
        file.data[at] ^= 1;
    }
    assert_int_equal(pdyn_restore_memory(sim, file.data, file.size), PDYN_OK);
    test_step(sim);
    test_close(sim);
}

/* ---- fields ---------------------------------------------------------------------------------- */

static void vacant_too_many(pdyn_sim *sim) { sim->live->vacant[0] = 401; }
static void vacant_negative(pdyn_sim *sim) { sim->live->vacant[0] = -1; }
static void slot_out_of_range(pdyn_sim *sim) { sim->live->slot[0] = 1 << 20; }
static void slot_negative(pdyn_sim *sim) { sim->live->slot[0] = -1; }
static void slot_twice(pdyn_sim *sim) { sim->live->slot[0] = sim->live->slot[1]; }
static void layers_negative(pdyn_sim *sim) { sim->live->inlet[0].layers = -1e300; }
static void layers_behind(pdyn_sim *sim) { sim->live->inlet[0].layers -= 3.0; }
static void layers_part(pdyn_sim *sim) { sim->live->inlet[0].layers -= 0.5; }
static void live_flag(pdyn_sim *sim) { memset(sim->live->live, 2, 1); }
static void emitted_negative(pdyn_sim *sim) { sim->live->emitted = -1; }
static void time_late(pdyn_sim *sim) { sim->time = 1e300; }
static void time_nan(pdyn_sim *sim) { sim->time = NAN; }
static void frame_negative(pdyn_sim *sim) { sim->frame = -1; }
static void steps_negative(pdyn_sim *sim) { sim->steps = -1; }
static void step_long(pdyn_sim *sim) { sim->last_h = 1.0; }
static void history_other(pdyn_sim *sim) { sim->history = 1e-9; }
static void damping_large(pdyn_sim *sim) { sim->eps = 2.0; }
static void flag_two(pdyn_sim *sim) { memset(&sim->far_off, 2, 1); }
static void position_far(pdyn_sim *sim) { sim->x[4] = -1e11; }
static void velocity_large(pdyn_sim *sim) { sim->v[4] = 1e9; }
static void before_far(pdyn_sim *sim) { sim->x_before[4] = 1e11; }
static void before_fast(pdyn_sim *sim) { sim->v_before[4] = -1e9; }
static void acceleration_nan(pdyn_sim *sim) { sim->constraint_acceleration[4] = NAN; }
static void position_nan(pdyn_sim *sim) { sim->x[4] = NAN; }
static void pressure_infinite(pdyn_sim *sim) { sim->pressure[0] = INFINITY; }
static void region_empty(pdyn_sim *sim) { sim->objective.contact->broad.region[0].min[0] = 1e3; }
static void region_large(pdyn_sim *sim) { sim->objective.contact->broad.region[0].max[0] = 1e3; }
static void contact_nan(pdyn_sim *sim) { sim->objective.contact->at[5] = NAN; }
static void contact_far(pdyn_sim *sim) { sim->objective.contact->at[5] = 1e11; }

static const struct {
    const char *text;
    void (*forge)(pdyn_sim *sim);
    const char *says;
} field[] = {
    {inlet, vacant_too_many, "not live"},
    {inlet, vacant_negative, "not live"},
    {inlet, slot_out_of_range, "not live"},
    {inlet, slot_negative, "not live"},
    {inlet, slot_twice, "not live"},
    {inlet, layers_negative, "layers"},
    {inlet, layers_behind, "layers"},
    {inlet, layers_part, "layers"},
    {inlet, live_flag, "flag of a live particle"},
    {inlet, emitted_negative, "emitted"},
    {fluid, time_late, "time"},
    {fluid, time_nan, "time"},
    {fluid, frame_negative, "frames"},
    {fluid, steps_negative, "steps"},
    {fluid, step_long, "step length"},
    {fluid, history_other, "history"},
    {fluid, damping_large, "damping"},
    {fluid, flag_two, "flag"},
    {fluid, position_nan, "position"},
    {tets, position_far, "position"},
    {tets, velocity_large, "velocity"},
    {tets, before_far, "position"},
    {tets, before_fast, "velocity"},
    {tets, acceleration_nan, "acceleration"},
    {fluid, pressure_infinite, "pressure"},
    {cloth, region_empty, "region"},
    {cloth, region_large, "region"},
    {cloth, contact_nan, "position of contact"},
    {cloth, contact_far, "position of contact"},
};

/* Restores the file "forged": it must be refused with this text and leave the simulation usable. */
static void refused(pdyn_context *context, const char *text, const char *says) {
    pdyn_sim *sim = test_load(context, text);
    test_step(sim);
    uint64_t hash = pdyn_state_hash(sim);
    assert_int_equal(pdyn_restore(sim, "forged"), PDYN_BAD_INPUT);
    const char *error = pdyn_last_error(context);
    if (!strstr(error, "not a saved state of this scene") || !strstr(error, says))
        fail_msg("expected \"%s\", found \"%s\"", says, error);
    assert_true(pdyn_state_hash(sim) == hash);
    test_step(sim);
    pdyn_free(sim);
}

static void test_fields(void **state) {
    (void)state;
    pdyn_context *context = test_context(1);
    for (size_t k = 0; k < sizeof field / sizeof *field; k++) {
        pdyn_sim *sim = test_load(context, field[k].text);
        for (int n = 0; n < STEPS; n++) test_step(sim);
        field[k].forge(sim);
        assert_int_equal(pdyn_save(sim, "forged"), PDYN_OK);
        pdyn_free(sim);
        refused(context, field[k].text, field[k].says);
    }
    pdyn_destroy(context);
    test_remove_file("forged");
}

/* The content of a state of the fluid ends with the number of multipliers and the multipliers. */
static void test_multipliers(void **state) {
    (void)state;
    static const int wrong[] = {-1, INT32_MIN, INT32_MAX};
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, fluid);
    test_step(sim);
    int count = pdyn_get_state(sim).particles;
    for (int k = 0; k < 3; k++) {
        assert_int_equal(pdyn_save(sim, "forged"), PDYN_OK);
        replace_int("forged", (size_t)count * sizeof(double), count, wrong[k]);
        refused(context, fluid, "number of multipliers");
    }
    test_close(sim);
    test_remove_file("forged");
}

/* ---- the writer ------------------------------------------------------------------------------ */

static void clean_up(void) {
    static const char *const file[] = {"out/metrics.csv",
                                       "out/state.pdyn",
                                       "out/sheet.vtk.series",
                                       "out/sheet_000000.vtk",
                                       "out/lock",
                                       "out/files.json",
                                       "out/sheet.obj",
                                       "out/solids/solid0.vtk.series",
                                       "out/solids/solid0_000000.vtk",
                                       "out/solids",
                                       "out"};
    for (size_t k = 0; k < sizeof file / sizeof *file; k++) assert_int_equal(remove(file[k]), 0);
}

/* The content of a writer's state ends with the number of frames and their times. */
static void test_writer(void **state) {
    (void)state;
    static const int wrong[] = {-1, 1000, INT32_MAX};
    pdyn_context *context = test_context(1);
    pdyn_sim *sim = test_load(context, cloth);
    pdyn_writer *writer = NULL, *resumed = NULL;
    assert_int_equal(pdyn_writer_open(sim, "out", false, &writer), PDYN_OK);
    test_step(sim);
    assert_int_equal(pdyn_writer_frame(writer), PDYN_OK);
    assert_int_equal(pdyn_writer_save(writer), PDYN_OK);
    pdyn_writer_close(writer);
    pdyn_sim *other = test_load(context, cloth);
    uint64_t hash = pdyn_state_hash(other);
    for (int k = 0; k < 3; k++) {
        replace_int("out/state.pdyn", sizeof(double), 1, wrong[k]);
        assert_int_equal(pdyn_writer_resume(other, "out", &resumed), PDYN_BAD_INPUT);
        assert_error("number of its frames");
        assert_null(resumed);
        assert_true(pdyn_time(other) == 0.0 && pdyn_state_hash(other) == hash);
        replace_int("out/state.pdyn", sizeof(double), wrong[k], 1);
    }
    assert_int_equal(pdyn_writer_resume(other, "out", &resumed), PDYN_OK);
    assert_true(pdyn_state_hash(other) == pdyn_state_hash(sim));
    pdyn_writer_close(resumed);
    pdyn_free(sim), pdyn_free(other);
    pdyn_destroy(context);
    clean_up();
}

/* A frame is appended to a series; a series that was changed since the last frame is replaced. */
static void test_series(void **state) {
    (void)state;
    static const char path[] = "out/sheet.vtk.series";
    static struct file appended, whole;
    pdyn_sim *sim = test_open(cloth);
    pdyn_writer *writer = NULL;
    assert_int_equal(pdyn_writer_open(sim, "out", false, &writer), PDYN_OK);
    for (int k = 0; k < 4; k++) {
        if (k == 3) {
            read_file(path, &appended);
            test_write_text(path, "{\"files\": []}\n");
        }
        assert_int_equal(pdyn_writer_frame(writer), PDYN_OK);
        test_step(sim);
    }
    read_file(path, &whole);
    size_t entries = appended.size - strlen("]}\n");
    assert_true(whole.size > appended.size);
    assert_memory_equal(whole.data, appended.data, entries);
    assert_memory_equal(whole.data + entries, ",\n{\"name\": \"sheet_000003.vtk\"", 29);
    assert_int_equal(pdyn_writer_save(writer), PDYN_OK);
    pdyn_writer_close(writer);
    test_close(sim);
    for (int k = 1; k < 4; k++) {
        char frame[64];
        snprintf(frame, sizeof frame, "out/sheet_%06d.vtk", k);
        test_remove_file(frame);
        snprintf(frame, sizeof frame, "out/solids/solid0_%06d.vtk", k);
        test_remove_file(frame);
    }
    clean_up();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_states), cmocka_unit_test(test_damaged_memory),
        cmocka_unit_test(test_fields), cmocka_unit_test(test_multipliers),
        cmocka_unit_test(test_writer), cmocka_unit_test(test_series),
    };
    return cmocka_run_group_tests_name("forged", tests, test_enter_directory, test_leave_directory);
}

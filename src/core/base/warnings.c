/* Warnings: counting, text, saved states. */
#include "warnings.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

const char *warning_name(enum warning_code code) {
    static const char *const names[] = {
#define WARNING_NAME(constant, code) code,
        WARNING_LIST(WARNING_NAME)
#undef WARNING_NAME
    };
    return names[code];
}

static struct warning *find(struct warning_list *list, enum warning_code code,
                            const char *subject) {
    for (int k = 0; k < list->count; k++)
        if (list->item[k].code == code && !strcmp(list->item[k].subject, subject))
            return &list->item[k];
    return NULL;
}

bool warnings_has(const struct warning_list *list, enum warning_code code) {
    for (int k = 0; k < list->count; k++)
        if (list->item[k].code == code) return true;
    return false;
}

/* A new warning without text. In a full list the last entry is used again. */
static struct warning *append(struct warning_list *list, enum warning_code code,
                              const char *subject, double time) {
    struct warning *w = &list->item[list->count - (list->count == WARNINGS_MAX)];
    list->count += list->count < WARNINGS_MAX;
    *w = (struct warning){.code = code, .first = time};
    snprintf(w->subject, sizeof w->subject, "%s", subject);
    return w;
}

struct warning *warnings_count(struct warning_list *list, enum warning_code code,
                               const char *subject, double time, long count, double value) {
    struct warning *w = find(list, code, subject);
    if (!w) w = append(list, code, subject, time);
    w->count += count, w->last = time, w->worst = fmax(w->worst, value);
    return w;
}

void warnings_say(pdyn_context *context, struct warning *w, const char *format, ...) {
    bool first = !*w->text;
    va_list args;
    va_start(args, format);
    text_write(w->text, sizeof w->text, format, args);
    va_end(args);
    if (first)
        context_log(context, PDYN_LOG_WARNING, "%s%s%s [%s]", w->subject, *w->subject ? ": " : "",
                    w->text, warning_name(w->code));
}

static bool is_text(const char *text, size_t size) { return memchr(text, '\0', size) != NULL; }

static bool is_valid(const struct warning *w) {
    return w->code >= 0 && w->code < WARNING_CODES && w->count >= 0 && isfinite(w->first) &&
           isfinite(w->last) && isfinite(w->worst) && is_text(w->subject, sizeof w->subject) &&
           is_text(w->text, sizeof w->text);
}

void warnings_persist(struct warning_list *list, struct snapshot_file *file) {
    snapshot_file_count(file, &list->count, sizeof *list->item,
                        "the number of warnings is invalid");
    snapshot_file_require(file, list->count <= WARNINGS_MAX, "the number of warnings is too large");
    if (file->status != PDYN_OK) list->count = 0;
    snapshot_file_bytes(file, list->item, (size_t)list->count * sizeof *list->item);
    for (int k = 0; k < list->count; k++)
        snapshot_file_require(file, is_valid(&list->item[k]), "a warning is invalid");
    if (file->status != PDYN_OK) list->count = 0;
}

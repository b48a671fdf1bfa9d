/* pdyn_scene_text: the text of a scene with its overrides applied. */
#include "base/text.h"
#include "json_file.h"

#include <stdlib.h>

pdyn_status pdyn_scene_text(pdyn_context *context, const char *path, const char *const *set,
                            int count, void (*write)(void *user, const char *text), void *user) {
    struct json_file file;
    struct text_locale locale;
    if (!context || !path || !write || count < 0 || (count && !set)) return PDYN_BAD_CALL;
    if (!text_begin(&locale)) return context_no_memory(context);
    pdyn_status status = json_file_open(context, path, NULL, set, count, &file);
    if (status == PDYN_OK) {
        char *dump = json_compose(file.root, JSON_INDENT(2) | JSON_REAL_PRECISION(15));
        json_file_close(&file);
        if (dump) write(user, dump);
        else status = context_no_memory(context);
        free(dump);
    }
    text_end(&locale);
    return status;
}

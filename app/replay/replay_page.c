/* Writes the page: the template with its two placeholders replaced. */
#include "replay_page.h"
#include "new_file.h"
#include "replay_planes.h"

#include <stdlib.h>
#include <string.h>

/* Metadata inside a <script> element, where '<' must not occur: it is written as \u003c, which
 * JSON allows in strings, the only place where JSON can have a '<'. */
static int write_metadata(struct stream *stream, const struct run *run) {
    json_t *meta = replay_metadata(run);
    char *text =
        meta ? json_dumps(meta, JSON_COMPACT | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(9)) : NULL;
    json_decref(meta);
    if (!text) return report_no_memory();
    for (const char *at = text; *at;) {
        size_t plain = strcspn(at, "<");
        stream_text(stream, at, plain);
        at += plain;
        if (!*at) break;
        stream_text(stream, "\\u003c", 6);
        at++;
    }
    free(text);
    return EXIT_GOOD;
}

/* Writes the template; replaces @META@ by the metadata and @DATA@ by the data. */
int replay_print_page(const struct run *run, FILE *file) {
    static struct stream stream; /* static: 48 KiB are too much for a stack */
    static const char meta[] = "@META@", data[] = "@DATA@";
    const char *at_meta = strstr(replay_template, meta), *at_data = strstr(replay_template, data);
    stream = (struct stream){.file = file};
    stream_text(&stream, replay_template, (size_t)(at_meta - replay_template));
    int code = write_metadata(&stream, run);
    at_meta += sizeof meta - 1;
    stream_text(&stream, at_meta, (size_t)(at_data - at_meta));
    if (code == EXIT_GOOD) code = replay_write_data(run, &stream);
    at_data += sizeof data - 1;
    stream_text(&stream, at_data, strlen(at_data));
    return code;
}

/* The page appears complete or not at all, see new_file.h. */
int replay_write_page(const struct run *run, const char *path) {
    char *temporary;
    FILE *file = new_file_open(path, &temporary);
    if (!file) return report_write_error(path);
    int code = replay_print_page(run, file);
    bool good = code == EXIT_GOOD && !ferror(file);
    if (new_file_close(file, temporary, path, good) || code != EXIT_GOOD) return code;
    return report_write_error(path);
}

/* The keys of --camera. */
#include "camera_keys.h"

#include "app.h"
#include "read_file.h"
#include "run_directory.h"

#include <stdlib.h>
#include <string.h>

/* What messages call the keys: the file, or nothing for those in the argument. */
static const char *file_name(const char *argument) { return *argument == '[' ? "" : argument; }

/* The text in compact form, after a check of its syntax. */
static int parse(const char *argument, const char *text, size_t size, char **keys) {
    const char *file = file_name(argument);
    json_error_t error;
    json_t *array = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    if (!array)
        return run_error("render: --camera %s%s%d:%d: expected JSON: %s", file, *file ? ":" : "",
                         error.line, error.column, error.text);
    *keys = json_dumps(array, JSON_COMPACT | JSON_ENCODE_ANY);
    json_decref(array);
    return *keys ? EXIT_GOOD : report_no_memory();
}

int camera_keys_read(const char *argument, char **keys) {
    *keys = NULL;
    if (*argument == '[') return parse(argument, argument, strlen(argument), keys);
    char *text;
    size_t size;
    int code = read_file(argument, &text, &size);
    if (code == EXIT_GOOD) code = parse(argument, text, size, keys);
    free(text);
    return code;
}

int camera_keys_send(struct browser *browser, const char *argument, const char *keys) {
    char *expression;
    json_t *fault;
    if (asprintf(&expression, "useCamera(%s)", keys) < 0) return report_no_memory();
    int code = browser_evaluate(browser, expression, &fault);
    free(expression);
    if (code != EXIT_GOOD) return code;
    const char *text = json_string_value(fault), *file = file_name(argument);
    if (*text) code = run_error("render: --camera %s%s%s", file, *file ? ": " : "", text);
    json_decref(fault);
    return code;
}

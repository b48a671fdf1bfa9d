/* Pictures to PNG files or, through ffmpeg, to a film. */
#include "film.h"
#include "app.h"
#include "new_file.h"
#include "program.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define PALETTE "split[a][b];[a]palettegen=stats_mode=full[p];[b][p]paletteuse=dither=none"

static const struct encoder {
    const char *ending, *container, *options[10];
} encoders[FILM_FORMATS] = {
    [FILM_PNG] = {".png", NULL, {NULL}},
    [FILM_MP4] = {".mp4",
                  "mp4",
                  {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", "-movflags",
                   "+faststart"}},
    [FILM_WEBM] = {".webm", "webm", {"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"}},
    [FILM_GIF] = {".gif", "gif", {"-vf", PALETTE}},
};

bool film_find_format(const char *path, enum film_format *format) {
    for (int k = 0; k < FILM_FORMATS; k++) {
        size_t length = strlen(path), tail = strlen(encoders[k].ending);
        *format = (enum film_format)k;
        if (length > tail && !strcmp(path + length - tail, encoders[k].ending)) return true;
    }
    return false;
}

/* Starts ffmpeg, which reads PNG pictures from `in`. Does not return. */
static void run_ffmpeg(const struct film *film, const char *program, double fps, int in) {
    const struct encoder *encoder = &encoders[film->format];
    char rate[32];
    snprintf(rate, sizeof rate, "%.9g", fps);
    const char *args[32] = {program,      "-v", "error", "-y",  "-f", "image2pipe",
                            "-framerate", rate, "-c:v",  "png", "-i", "-"};
    int count = 12;
    for (int k = 0; encoder->options[k]; k++) args[count++] = encoder->options[k];
    /* Programs show a picture of less than 2/100 s for a tenth of a second. The end of the input
     * passes the last picture: a film of less than 1/100 s would have none. */
    if (film->format == FILM_GIF && fps > 50.0) args[count - 1] = "fps=50:eof_action=pass," PALETTE;
    args[count++] = "-f";
    args[count++] = encoder->container;
    args[count++] = film->temporary ? film->temporary : film->path;
    if (dup2(in, 0) < 0) _exit(127);
    signal(SIGPIPE, SIG_DFL);
    execv(program, (char *const *)args);
    _exit(127);
}

static int start_ffmpeg(struct film *film, double fps) {
    static const char *const names[] = {"ffmpeg", NULL};
    char program[4096];
    int ends[2];
    if (!find_program(names, program, sizeof program)) {
        fputs("projdyn: render: ffmpeg is not installed; on Debian: apt-get install ffmpeg\n",
              stderr);
        return EXIT_FAILED;
    }
    film->target = new_file_open(film->path, &film->temporary);
    if (!film->target) return report_write_error(film->path);
    if (pipe2(ends, O_CLOEXEC)) return report_write_error("ffmpeg");
    film->process = fork();
    if (!film->process) run_ffmpeg(film, program, fps, ends[0]);
    close(ends[0]);
    film->file = fdopen(ends[1], "w");
    return film->process > 0 && film->file ? EXIT_GOOD : report_write_error("ffmpeg");
}

bool film_is_numbered(const char *path) { return strchr(path, '%'); }

bool film_check_number(const char *path) {
    const char *number = strchr(path, '%');
    size_t digits = number ? strspn(number + 1, "0123456789") : 0;
    return !number || (digits <= 2 && number[1 + digits] == 'd' && !strchr(number + 1, '%'));
}

/* Path of the numbered picture of a frame: %d, %4d or %04d in `pattern`, always with zeros. */
static char *numbered_path(const char *pattern, long frame) {
    const char *number = strchr(pattern, '%');
    char *end, *path;
    int digits = (int)strtol(number + 1, &end, 10), before = (int)(number - pattern);
    return asprintf(&path, "%.*s%0*ld%s", before, pattern, digits, frame, end + 1) < 0 ? NULL
                                                                                       : path;
}

int film_open(struct film *film, const char *path, double fps) {
    *film = (struct film){.path = path};
    film_find_format(path, &film->format);
    return film->format == FILM_PNG ? EXIT_GOOD : start_ffmpeg(film, fps);
}

/* Value of a digit of base64; -1 if it is none. */
static int digit_value(char digit) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *at = digit ? strchr(digits, digit) : NULL;
    return at ? (int)(at - digits) : -1;
}

/* Writes a PNG in base64; false if writing failed. */
static bool write_picture(FILE *file, const char *picture) {
    unsigned bits = 0;
    int count = 0, value;
    for (; (value = digit_value(*picture)) >= 0; picture++) {
        bits = bits << 6 | (unsigned)value;
        count += 6;
        if (count >= 8 && putc((int)(bits >> (count -= 8) & 255), file) == EOF) break;
    }
    return !ferror(file);
}

static int write_file(const char *path, const char *picture) {
    char *temporary;
    FILE *file = new_file_open(path, &temporary);
    if (file && new_file_close(file, temporary, path, write_picture(file, picture)))
        return EXIT_GOOD;
    return report_write_error(path);
}

int film_add(struct film *film, long frame, const char *picture) {
    if (film->format != FILM_PNG)
        return write_picture(film->file, picture) ? EXIT_GOOD : report_write_error("ffmpeg");
    if (!film_is_numbered(film->path)) return write_file(film->path, picture);
    char *path = numbered_path(film->path, frame);
    int code = path ? write_file(path, picture) : report_no_memory();
    free(path);
    return code;
}

/* Ends ffmpeg; the film appears at its path if all is good. */
static int finish_film(struct film *film, bool good) {
    int status = -1;
    if (film->process > 0 && !good) kill(film->process, SIGKILL);
    if (film->file && fclose(film->file)) good = false;
    if (film->process > 0) waitpid(film->process, &status, 0);
    if (good && status) fprintf(stderr, "projdyn: render: %s: ffmpeg failed\n", film->path);
    good = good && !status;
    if (!film->target) return EXIT_FAILED;
    if (new_file_close(film->target, film->temporary, film->path, good)) return EXIT_GOOD;
    return good ? report_write_error(film->path) : EXIT_FAILED;
}

int film_close(struct film *film, bool good) {
    if (film->format != FILM_PNG) return finish_film(film, good);
    return good ? EXIT_GOOD : EXIT_FAILED;
}

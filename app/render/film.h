/* Where the pictures of `projdyn render` go: PNG files, or a film that ffmpeg makes. */
#ifndef FILM_H
#define FILM_H

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

enum film_format { FILM_PNG, FILM_MP4, FILM_WEBM, FILM_GIF, FILM_FORMATS };

struct film {
    enum film_format format;
    const char *path;
    FILE *file;      /* the pipe to ffmpeg; NULL: closed */
    FILE *target;    /* the film while it is made, see new_file.h */
    char *temporary; /* its name */
    pid_t process;   /* ffmpeg */
};

/* Format by the ending of a file name; false if it is none of them. */
bool film_find_format(const char *path, enum film_format *format);
/* Whether a path stands for numbered pictures: it has a '%'. */
bool film_is_numbered(const char *path);
/* Whether a path has no '%', or one alone, of the form %d or %0Nd with at most two digits. */
bool film_check_number(const char *path);

/* Functions that return int return an exit code, after a message unless it is EXIT_GOOD. The
 * caller calls film_close() in any case. */

/* Opens the output. fps: pictures per second of a film */
int film_open(struct film *film, const char *path, double fps);
/* Adds the picture of a frame, a PNG in base64: a PNG file appears complete or not at all. */
int film_add(struct film *film, long frame, const char *picture);
/* good: the film appears at its path; otherwise nothing is left of it. */
int film_close(struct film *film, bool good);

#endif

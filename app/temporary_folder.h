/* A private folder for files of the program that nobody keeps. */
#ifndef TEMPORARY_FOLDER_H
#define TEMPORARY_FOLDER_H

enum { TEMPORARY_FOLDER = 4096 }; /* size of its path */

/* Makes a folder projdyn-NAME-RANDOM in TMPDIR, or else in /tmp. Returns an exit code, after a
 * message unless it is EXIT_GOOD; the path is empty then. */
int temporary_folder_make(const char *name, char path[TEMPORARY_FOLDER]);
/* Removes the folder with all that it contains; path "": does nothing. */
void temporary_folder_remove(const char *path);

#endif

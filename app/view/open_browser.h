/* Opens the page in the browser of the desktop. */
#ifndef OPEN_BROWSER_H
#define OPEN_BROWSER_H

#include "temporary_folder.h"

/* Starts xdg-open, if it is installed, on a file that leads to `url` and that only the user can
 * read: others would see the token among the arguments of a process. folder: gets the
 * temporary folder of the file, which the caller removes. */
void open_browser(const char *url, char folder[TEMPORARY_FOLDER]);

#endif

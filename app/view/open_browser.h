/* Opens the page in the browser of the desktop. */
#ifndef OPEN_BROWSER_H
#define OPEN_BROWSER_H

#include <stddef.h>

/* Starts xdg-open, if it is installed, on a file that leads to `url` and that only the user can
 * read: others would see the token among the arguments of a process. Puts the name of the file's
 * directory into `folder`, size bytes. */
void open_browser(const char *url, char *folder, size_t size);
/* Removes the file and its directory; folder "": does nothing. */
void close_browser(const char *folder);

#endif

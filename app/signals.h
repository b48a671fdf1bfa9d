/* The signals by which users and batch systems end a program: SIGINT (Ctrl-C), SIGTERM, and SIGHUP
 * when its terminal closes. */
#ifndef SIGNALS_H
#define SIGNALS_H

typedef void signal_fn(int number);

/* Handles them; SIGHUP stays ignored under nohup. flags: of sigaction. */
void signals_catch(signal_fn *handler, int flags);

/* Handles those that have their default action, and would end the program. */
void signals_catch_default(signal_fn *handler);

#endif

/* progress.h - a progress bar, only on a terminal and for work of more than a second */
#ifndef CLI_PROGRESS_H
#define CLI_PROGRESS_H

/* Draws done / total (total <= 0: unknown, shows done alone); cheap to call often. */
void progress(const char *what, double done, double total);
/* Erases the bar; messages call it themselves. */
void progress_clear(void);

#endif

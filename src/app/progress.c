/* A terminal gets one line that is overwritten; other outputs get at most a line per second. */
#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "dm2/base/clock.h"

void progress_start(struct progress *p, enum progress_mode mode, int64_t steps, size_t elements)
{
    double now = clock_now();
    *p = (struct progress){.steps = steps, .elements = elements, .start = now, .shown = now};
    p->tty = isatty(STDERR_FILENO) == 1;
    p->on = mode == PROGRESS_ALWAYS || (mode == PROGRESS_AUTO && p->tty);
}

static void format_time(double seconds, char *out, size_t size)
{
    if (seconds < 60)
        (void)snprintf(out, size, "%.1f s", seconds);
    else if (seconds < 3600)
        (void)snprintf(out, size, "%d:%02d min", (int)(seconds / 60), (int)seconds % 60);
    else
        (void)snprintf(out, size, "%d:%02d h", (int)(seconds / 3600), (int)(seconds / 60) % 60);
}

void progress_step(struct progress *p, int64_t step, const char *slowest)
{
    if (!p->on)
        return;
    double now = clock_now(), elapsed = now - p->start;
    if (step < p->steps && now - p->shown < (p->tty ? 0.2 : 1.0))
        return;
    p->shown = now;
    char left[32], line[400];
    format_time(step > 0 ? elapsed / (double)step * (double)(p->steps - step) : 0, left, sizeof left);
    double rate = elapsed > 0 ? (double)p->elements * (double)step / elapsed : 0;
    (void)snprintf(line, sizeof line, "step %lld of %lld, %.1f %%, %.3g element-steps/s, %s left%s%s",
                   (long long)step, (long long)p->steps, 100.0 * (double)step / (double)p->steps, rate, left,
                   slowest == NULL ? "" : ", slowest ", slowest == NULL ? "" : slowest);
    size_t width = strlen(line);
    if (p->tty)
        (void)fprintf(stderr, "\r%s%*s", line, width < p->width ? (int)(p->width - width) : 0, "");
    else
        (void)fprintf(stderr, "%s\n", line);
    p->width = width;
    (void)fflush(stderr);
}

void progress_end(struct progress *p)
{
    if (p->on && p->tty && p->width > 0)
        (void)fputc('\n', stderr);
    p->width = 0;
}

/* run.log has lines "name: value" behind the head of the session, whose first line names the program; scripts
 * read the rate from its line "X element-steps/s". timing.csv has one row per server. Both files differ from
 * run to run, unlike all other files of the run directory. */
#include "dm2/cluster/report.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "dm2/base/bytes.h"
#include "dm2/base/csv.h"
#include "dm2/base/number.h"

static void add_text(struct bytes_writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add_text(struct bytes_writer *w, const char *format, ...)
{
    char line[1024];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(line, sizeof line, format, args);
    va_end(args);
    if (n > 0)
        bytes_put_raw(w, line, (size_t)n < sizeof line ? (size_t)n : sizeof line - 1);
}

double report_rate(const struct run_report *r)
{
    return r->stepping > 0 ? (double)r->elements * (double)r->timed / r->stepping : 0;
}

static void add_log(struct bytes_writer *w, const struct run_report *r, const struct results_verdict *verdict)
{
    uint64_t migrants = 0, bytes = 0, messages = 0;
    for (int k = 0; k < r->ranks; k++) {
        const struct server_times *t = &r->servers[k].times;
        migrants += t->migrants;
        bytes += t->bytes_in + t->bytes_out;
        messages += t->messages_in + t->messages_out;
    }
    add_text(w, "deck: %s\n", r->deck);
    add_text(w, "elements: %zu\n", r->elements);
    add_text(w, "steps: %lld\n", (long long)r->steps);
    add_text(w, "subdomains: %d\n", r->ranks);
    add_text(w, "time: %.3f s in all, %.3f s set-up, %.3f s compiling and writing results\n", r->total,
             r->set_up, r->output);
    add_text(w, "time steps alone: %.6f s for %lld steps, %.6f ms per step\n", r->stepping,
             (long long)r->timed, r->timed > 0 ? 1e3 * r->stepping / (double)r->timed : 0.0);
    add_text(w, "speed: %.6g element-steps/s\n", report_rate(r));
    add_text(w, "rebuilds: %llu, of them %llu with a second round trip\n", (unsigned long long)r->rebuilds,
             (unsigned long long)r->redone);
    add_text(w, "migrants: %llu\n", (unsigned long long)migrants);
    add_text(w, "g: %zu bytes per boundary element of an update\n", r->update_bytes);
    add_text(w, "network: %llu bytes in %llu messages\n", (unsigned long long)bytes,
             (unsigned long long)messages);
    if (r->copies > 0)
        add_text(w, "copies of the state: %lld in %.6f s, %.2f %% of the time\n", (long long)r->copies,
                 r->copying, r->total > 0 ? 100 * r->copying / r->total : 0.0);
    if (r->losses > 0)
        add_text(w, "servers lost and made good: %d\n", r->losses);
    add_text(w, "client: %.6f s waiting for servers, %.6f s relaying\n", r->wait, r->relay);
    if (r->prediction != NULL)
        bytes_put_raw(w, r->prediction, strlen(r->prediction));
    for (int k = 0; k < r->ranks; k++) {
        const struct server_report *s = &r->servers[k];
        const struct server_times *t = &s->times;
        add_text(
            w,
            "subdomain %d: %s, %zu cells, %llu elements, %llu mirrored, %.1f MB, %.0f bytes per element; "
            "forces %.3f s "
            "(%.3f s ahead of messages), integration %.3f s, rebuilds %.3f s, packing %.3f s, waiting %.3f "
            "s, unpacking %.3f s\n",
            k, s->name, s->cells, (unsigned long long)s->owned, (unsigned long long)s->mirrored,
            1e-6 * (double)s->bytes, s->owned > 0 ? (double)s->bytes / (double)s->owned : 0.0, t->forces,
            t->ahead, t->integrate, t->rebuild, t->pack, t->wait, t->unpack);
    }
    if (verdict->stop[0] != '\0')
        add_text(w, "%s\n", verdict->stop);
    if (verdict->warning[0] != '\0')
        add_text(w, "%s\n", verdict->warning);
    add_text(w, "%s\n", verdict->energy);
}

static void add_number(struct bytes_writer *w, double x)
{
    char text[NUMBER_TEXT_MAX];
    size_t n = number_format(x, text);
    bytes_put_raw(w, ",", 1);
    bytes_put_raw(w, text, n);
}

static void add_table(struct bytes_writer *w, const struct run_report *r)
{
    add_text(
        w,
        "server,host,cells,elements,mirrored,bytes,steps,forces [s],ahead [s],integrate [s],rebuild [s],pack "
        "[s],wait [s],"
        "unpack [s],output "
        "[s],cpu [s],rebuilds,migrants,mirrored_steps,messages_in,messages_out,bytes_in,bytes_out\n");
    for (int k = 0; k < r->ranks; k++) {
        const struct server_report *s = &r->servers[k];
        const struct server_times *t = &s->times;
        char host[2 * SOCKET_NAME];
        (void)csv_quote(s->name, host, sizeof host);
        add_text(w, "%d,%s,%zu,%llu,%llu,%llu,%llu", k, host, s->cells, (unsigned long long)s->owned,
                 (unsigned long long)s->mirrored, (unsigned long long)s->bytes, (unsigned long long)t->steps);
        const double seconds[] = {t->forces, t->ahead,  t->integrate, t->rebuild, t->pack,
                                  t->wait,   t->unpack, t->output,    t->cpu};
        for (size_t p = 0; p < sizeof seconds / sizeof seconds[0]; p++)
            add_number(w, seconds[p]);
        const uint64_t counts[] = {t->rebuilds,     t->migrants, t->mirrored, t->messages_in,
                                   t->messages_out, t->bytes_in, t->bytes_out};
        for (size_t p = 0; p < sizeof counts / sizeof counts[0]; p++)
            add_text(w, ",%llu", (unsigned long long)counts[p]);
        add_text(w, "\n");
    }
}

enum dm2_status report_write(const struct run_report *report, struct results *results, struct dm2_error *err)
{
    struct bytes_writer log = {0}, table = {0};
    struct results_verdict verdict;
    enum dm2_status status = DM2_OK;
    results_verdict(results, &verdict);
    add_log(&log, report, &verdict);
    add_table(&table, report);
    if (log.failed || table.failed)
        status = dm2_fail(err, DM2_MEMORY, "no memory for the run's log");
    if (status == DM2_OK)
        status = results_log(results, (const char *)log.data, log.length, err);
    if (status == DM2_OK)
        status = results_text(results, "timing.csv", (const char *)table.data, table.length, err);
    bytes_free(&log);
    bytes_free(&table);
    return status;
}

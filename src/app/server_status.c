/* Up or not, client in session, version, load: the facts that matter before starting a run, or while
 * waiting for one. The line of a server that does not answer gives the reason, and the remaining servers
 * are asked all the same. */
#include "server_status.h"

#include <string.h>
#include <time.h>

#include "dm2/cluster/inquiry.h"

/* Prints "busy with ADDR since TIME: rank 0 of 2 of DECK, step 7". */
static void print_session(FILE *to, const struct report_message *m)
{
    char since[32] = "";
    time_t start = time(NULL) - (time_t)m->seconds;
    struct tm utc;
    if (gmtime_r(&start, &utc) != NULL)
        (void)strftime(since, sizeof since, "%Y-%m-%dT%H:%M:%SZ", &utc);
    (void)fprintf(to, "busy with %s since %s", m->peer, since);
    if (m->ranks > 0)
        (void)fprintf(to, ": rank %d of %d of %s, step %lld", m->rank, m->ranks, m->deck, (long long)m->step);
}

static void print_report(FILE *to, const struct report_message *m)
{
    if (m->busy)
        print_session(to, m);
    else
        (void)fputs("free", to);
    if (m->waiting > 0)
        (void)fprintf(to, "; %u waiting", m->waiting);
    (void)fprintf(to, "; dm2 %s; load ", m->version);
    if (m->load >= 0)
        (void)fprintf(to, "%.2f", m->load);
    else
        (void)fputs("unknown", to);
    (void)fprintf(to, " on %d core%s\n", m->cores, m->cores == 1 ? "" : "s");
}

enum dm2_status server_status_print(FILE *to, const struct endpoints *servers, const struct auth_key *key,
                                    double seconds, int cancel, struct dm2_error *err)
{
    size_t down = 0;
    for (size_t k = 0; k < servers->n; k++) {
        const struct endpoint *s = &servers->items[k];
        struct report_message m;
        struct dm2_error why = {0};
        char name[SOCKET_NAME];
        enum dm2_status status = inquiry_ask(s, key, seconds, cancel, &m, &why);
        if (status == DM2_INTERRUPTED || status == DM2_MEMORY)
            return dm2_fail(err, status, "%s", why.text);
        (void)snprintf(name, sizeof name, "%s:%d", s->host, s->port);
        (void)fprintf(to, "%s%s: ", name, s->spare ? " (spare)" : "");
        if (status == DM2_OK) {
            print_report(to, &m);
        } else {
            bool named =
                strncmp(why.text, name, strlen(name)) == 0 && strncmp(why.text + strlen(name), ": ", 2) == 0;
            (void)fprintf(to, "not usable: %s\n", named ? why.text + strlen(name) + 2 : why.text);
            down++;
        }
        (void)fflush(to);
    }
    return down == 0 ? DM2_OK : dm2_fail(err, DM2_NET, "%zu of %zu servers cannot be used", down, servers->n);
}

/* dm2-model predict. All rows are computed before the first is printed, so that an error leaves standard
 * output empty. */
#include <stdio.h>
#include <stdlib.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/base/version.h"
#include "model_commands.h"
#include "model_options.h"

static const int PAPER_SERVERS[] = {2, 4, 8};

static void print_csv(const struct prediction *rows, size_t count)
{
    (void)printf("n,s,servers,p_x,p_y,t_seq,t_comm,t_dist,speedup,efficiency\n");
    for (size_t i = 0; i < count; i++) {
        const struct prediction *r = &rows[i];
        const double fields[] = {r->n,     r->s,      r->servers, r->p_x,     r->p_y,
                                 r->t_seq, r->t_comm, r->t_dist,  r->speedup, r->efficiency};
        for (size_t f = 0; f < sizeof fields / sizeof fields[0]; f++) {
            char text[NUMBER_TEXT_MAX];
            (void)number_format(fields[f], text);
            (void)printf("%s%s", f > 0 ? "," : "", text);
        }
        (void)printf("\n");
    }
}

static void print_notes(const struct prediction *rows, size_t count)
{
    bool inferred = false, general = false, client = false;
    for (size_t i = 0; i < count; i++) {
        inferred |= !rows[i].measured;
        general |= rows[i].general;
        client |= rows[i].client_bound;
    }
    if (general)
        (void)printf("g  general form: counted on the bisected grid of cells\n");
    if (inferred)
        (void)printf("*  m_N and b_N are not known for this number of servers, but inferred from others\n");
    if (client)
        (void)printf("c  the client's link is what takes the time\n");
}

static void print_table(const struct perf *p, const struct prediction *rows, size_t count)
{
    (void)printf("d_x %g cm, d_y %g cm, L_x %g cm, L_y %g cm, k %.4g s, g %g bytes\n", p->d_x, p->d_y, p->l_x,
                 p->l_y, p->k, p->g);
    for (size_t i = 0; i < count; i++) {
        const struct prediction *r = &rows[i];
        if (i == 0 || r->n != rows[i - 1].n)
            (void)printf(
                "\n%.0f elements, aspect ratio %g: p_x %.1f, p_y %.1f elements, T_seq %.5g ms per step\n"
                "servers   exchanged   T_comp ms   T_comm ms   T_dist ms   speedup  efficiency\n",
                r->n, r->s, r->p_x, r->p_y, r->t_seq * 1e3);
        (void)printf("%7d %11.1f %11.5g %11.5g %11.5g %9.3f %11.3f  %s%s%s\n", r->servers, r->exchanged,
                     r->t_comp * 1e3, r->t_comm * 1e3, r->t_dist * 1e3, r->speedup, r->efficiency,
                     r->general ? "g" : "", r->measured ? "" : "*", r->client_bound ? "c" : "");
    }
    (void)printf("\n");
    print_notes(rows, count);
}

static enum dm2_status run_prediction(const struct model_options *o, struct dm2_error *err)
{
    const int *servers = o->servers_count > 0 ? o->servers : PAPER_SERVERS;
    size_t n_servers =
        o->servers_count > 0 ? o->servers_count : sizeof PAPER_SERVERS / sizeof PAPER_SERVERS[0];
    if (o->n_count == 0)
        return dm2_fail(err, DM2_USAGE, "predict needs a number of elements: --n");
    struct prediction *rows = mem_zalloc(o->n_count, n_servers * sizeof *rows);
    if (rows == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory for %zu predictions", o->n_count * n_servers);
    enum dm2_status status = DM2_OK;
    for (size_t i = 0; status == DM2_OK && i < o->n_count; i++)
        for (size_t j = 0; status == DM2_OK && j < n_servers; j++)
            status = predict(&o->perf, o->n[i], o->s, servers[j], &o->form, &rows[i * n_servers + j], err);
    if (status == DM2_OK && o->csv)
        print_csv(rows, o->n_count * n_servers);
    else if (status == DM2_OK)
        print_table(&o->perf, rows, o->n_count * n_servers);
    free(rows);
    return status;
}

enum dm2_status model_predict_command(const char *argv0, int argc, char **argv, struct dm2_error *err)
{
    (void)argv0;
    struct model_options o;
    struct option table[MODEL_OPTIONS];
    model_options_start(&o, table);
    enum dm2_status status = options_parse(table, MODEL_OPTIONS, argc, argv, &o.operands, err);
    if (status == DM2_OK)
        status = model_options_finish(&o, err);
    if (status == DM2_OK && o.help) {
        (void)printf(
            "usage: dm2-model predict --n N [options]\n"
            "Time per step, speedup and efficiency of 2, 4 and 8 (or other numbers of) servers.\n\n");
        options_print(stdout, table, MODEL_OPTIONS);
    } else if (status == DM2_OK && o.version) {
        (void)printf("dm2-model %s\n", DM2_VERSION);
    } else if (status == DM2_OK) {
        status = run_prediction(&o, err);
    }
    model_options_free(&o);
    return status;
}

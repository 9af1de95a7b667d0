/* For tests of the engine: a deck in memory, run in this process on any number of ranks, without a
 * socket. The exchange consists of the calls of a server: update, or sort_out, transport of the
 * parcels, take_in. */
#ifndef DM2_TESTS_ENGINE_HELP_H
#define DM2_TESTS_ENGINE_HELP_H

#include "check.h"
#include "deck_help.h"
#include "record_help.h"

#include "dm2/cluster/decomposition.h"
#include "dm2/engine/model.h"
#include "dm2/engine/rebuild.h"
#include "dm2/engine/subdomain.h"

enum { ENGINE_RANKS_MAX = 64 };

struct engine {
    struct loaded deck;
    struct model *model;
    struct decomposition parts;
    struct domain_map map;
    struct subdomain *sd[ENGINE_RANKS_MAX];
    struct rebuild_plan plan;
    size_t migrants; /* elements that changed owner so far */
    size_t rebuilds;
    bool ahead;           /* every move begins the next forces, as on a server; off for the last step */
    bool ahead_measures;  /* and these forces measure */
    struct dm2_error err; /* of the last failed call */
};

/* The whole state, gathered from all ranks: elements by id, pairs by ids. */
struct engine_state {
    struct element *e;
    struct element_measure *m; /* of the last measuring step; NULL unless asked for */
    struct pair_record *pair;
    size_t n, n_pairs;
};

static inline void engine_must(const struct engine *g, enum dm2_status status)
{
    if (status != DM2_OK) {
        printf("%s\n", g->err.text);
        exit(1);
    }
}

/* Builds the model of g->deck and cuts its grid; no subdomain yet. */
static inline void engine_cut(struct engine *g, int ranks)
{
    if (g->deck.status != DM2_OK) {
        printf("%s\n", g->deck.report.text);
        exit(1);
    }
    engine_must(g, model_build(&g->deck.config, &g->model, &g->err));
    engine_must(g, decomposition_bisect(model_grid(g->model), ranks, NULL, &g->parts, &g->err));
    g->map = (struct domain_map){.grid = &g->parts.grid, .ranks = ranks, .owner = g->parts.owner};
    rebuild_plan_start(&g->plan, &g->deck.config, model_margins(g->model));
}

/* Loads the deck and cuts its grid; no subdomain yet. */
static inline void engine_load(struct engine *g, const char *text, const char *const *defines, int ranks)
{
    memset(g, 0, sizeof *g);
    g->deck = load_text(text, defines, -1);
    engine_cut(g, ranks);
}

/* Starts from the deck's initial state. */
static inline void engine_start(struct engine *g, const char *text, const char *const *defines, int ranks)
{
    engine_load(g, text, defines, ranks);
    for (int r = 0; r < ranks; r++)
        engine_must(g, subdomain_create(g->model, &g->map, r, &g->sd[r], &g->err));
}

/* Starts from the initial state of a deck in a file, with its included files. */
static inline void engine_start_file(struct engine *g, const char *path, const char *const *defines,
                                     int ranks)
{
    memset(g, 0, sizeof *g);
    g->deck = load_path(path, defines, -1);
    engine_cut(g, ranks);
    for (int r = 0; r < ranks; r++)
        engine_must(g, subdomain_create(g->model, &g->map, r, &g->sd[r], &g->err));
}

/* Starts from any state, after engine_load. */
static inline void engine_restore(struct engine *g, int64_t step, const struct engine_state *s)
{
    for (int r = 0; r < g->map.ranks; r++) {
        const struct state_view view = {
            .step = step, .elements = s->e, .n_elements = s->n, .pairs = s->pair, .n_pairs = s->n_pairs};
        subdomain_free(g->sd[r]);
        engine_must(g, subdomain_restore(g->model, &g->map, r, &view, &g->sd[r], &g->err));
    }
    rebuild_plan_done(&g->plan);
}

static inline void engine_stop(struct engine *g)
{
    for (int r = 0; r < g->map.ranks; r++)
        subdomain_free(g->sd[r]);
    decomposition_free(&g->parts);
    model_free(g->model);
    loaded_free(&g->deck);
}

static inline enum dm2_status engine_forces(struct engine *g, bool measure)
{
    for (int r = 0; r < g->map.ranks; r++) {
        enum dm2_status status = subdomain_forces(g->sd[r], measure, &g->err);
        if (status != DM2_OK)
            return status;
    }
    return DM2_OK;
}

/* Sends the new state of owned elements to their mirrors. */
static inline void engine_update(struct engine *g)
{
    size_t width = subdomain_update_width(g->model);
    for (int from = 0; from < g->map.ranks; from++) {
        for (int to = 0; to < g->map.ranks; to++) {
            size_t n = subdomain_send_count(g->sd[from], to);
            if (from == to || n == 0)
                continue;
            double *numbers = malloc(n * width * sizeof *numbers);
            CHECK_EQ_INT(subdomain_receive_count(g->sd[to], from), n);
            subdomain_pack_update(g->sd[from], to, numbers);
            engine_must(g, subdomain_take_update(g->sd[to], from, numbers, &g->err));
            free(numbers);
        }
    }
}

/* Sorts all elements into cells and ranks anew. */
static inline void engine_rebuild(struct engine *g)
{
    int n = g->map.ranks;
    struct parcel *parcels = calloc((size_t)(n * n), sizeof *parcels),
                  *mine = calloc((size_t)n, sizeof *mine);
    for (int from = 0; from < n; from++) {
        engine_must(g, subdomain_sort_out(g->sd[from], parcels + from * n, &g->err));
        for (int to = 0; to < n; to++)
            g->migrants += parcels[from * n + to].n_migrants;
    }
    for (int to = 0; to < n; to++) {
        for (int from = 0; from < n; from++)
            mine[from] = parcels[(n - 1 - from) * n + to]; /* in another order than the ranks' */
        engine_must(g, subdomain_take_in(g->sd[to], mine, (size_t)n, &g->err));
    }
    free(parcels);
    free(mine);
    g->rebuilds++;
    rebuild_plan_done(&g->plan);
}

/* The totals of the bodies under force, of all ranks to all ranks. */
static inline void engine_take_totals(struct engine *g)
{
    struct load_totals sum[FORCED_MAX] = {{.contacts = 0}};
    size_t n = model_forced(g->model);
    for (int r = 0; r < g->map.ranks; r++)
        for (size_t i = 0; i < n; i++)
            load_totals_merge(&sum[i], &subdomain_load_totals(g->sd[r])[i]);
    for (int r = 0; r < g->map.ranks; r++)
        subdomain_take_totals(g->sd[r], sum);
}

/* The second half of a step: leapfrog and exchange. *out (may be NULL) merges the measures of the ranks. */
static inline enum dm2_status engine_move(struct engine *g, struct measures *out)
{
    double dmax = 0.0;
    bool survey = rebuild_plan_survey(&g->plan);
    struct spread spread = spread_none();
    if (out != NULL)
        measures_clear(out);
    for (int r = 0; r < g->map.ranks; r++) {
        double moved;
        struct measures part;
        enum dm2_status status = subdomain_move(g->sd[r], &moved, out == NULL ? NULL : &part, &g->err);
        if (status != DM2_OK)
            return status;
        dmax = moved > dmax ? moved : dmax;
        if (survey) {
            struct spread own;
            subdomain_survey(g->sd[r], &own);
            spread_merge(&spread, &own);
        }
        if (out != NULL)
            measures_merge(out, &part);
    }
    engine_take_totals(g);
    for (int r = 0; r < g->map.ranks && g->ahead; r++)
        subdomain_forces_ahead(g->sd[r], g->ahead_measures);
    if (rebuild_plan_step(&g->plan, dmax, survey ? &spread : NULL))
        engine_rebuild(g);
    else
        engine_update(g);
    return DM2_OK;
}

static inline void engine_step(struct engine *g, struct measures *out)
{
    engine_must(g, engine_forces(g, out != NULL));
    engine_must(g, engine_move(g, out));
}

static inline void engine_run(struct engine *g, int64_t steps)
{
    bool ahead = g->ahead;
    for (int64_t k = 0; k < steps; k++) {
        g->ahead = ahead && k + 1 < steps;
        engine_step(g, NULL);
    }
    g->ahead = ahead;
}

static inline int engine_by_id(const void *a, const void *b)
{
    const struct element *ea = a, *eb = b;
    return ea->id < eb->id ? -1 : ea->id > eb->id;
}

static inline int engine_by_ids(const void *a, const void *b)
{
    const struct pair_record *pa = a, *pb = b;
    if (pa->id_a != pb->id_a)
        return pa->id_a < pb->id_a ? -1 : 1;
    return pa->id_b < pb->id_b ? -1 : pa->id_b > pb->id_b;
}

/* Gathers the state. Ids are 0 .. n-1, so the measures of an element lie at its id. */
static inline struct engine_state engine_collect(struct engine *g, bool measured)
{
    struct engine_state s = {0};
    for (int r = 0; r < g->map.ranks; r++)
        s.n += subdomain_owned(g->sd[r]);
    s.e = calloc(s.n + 1, sizeof *s.e);
    s.m = measured ? calloc(s.n + 1, sizeof *s.m) : NULL;
    size_t at = 0;
    for (int r = 0; r < g->map.ranks; r++) {
        size_t own = subdomain_owned(g->sd[r]), n_pairs;
        struct element_measure *m = measured ? calloc(own + 1, sizeof *m) : NULL;
        struct pair_record *pairs;
        engine_must(g, subdomain_collect(g->sd[r], s.e + at, m, &g->err));
        for (size_t k = 0; k < own && measured; k++)
            s.m[s.e[at + k].id] = m[k];
        at += own;
        free(m);
        engine_must(g, subdomain_collect_pairs(g->sd[r], &pairs, &n_pairs, &g->err));
        s.pair = realloc(s.pair, (s.n_pairs + n_pairs + 1) * sizeof *s.pair);
        if (n_pairs > 0)
            memcpy(s.pair + s.n_pairs, pairs, n_pairs * sizeof *s.pair);
        s.n_pairs += n_pairs;
        free(pairs);
    }
    qsort(s.e, s.n, sizeof *s.e, engine_by_id);
    if (s.n_pairs > 0)
        qsort(s.pair, s.n_pairs, sizeof *s.pair, engine_by_ids);
    return s;
}

static inline void engine_state_free(struct engine_state *s)
{
    free(s->e);
    free(s->m);
    free(s->pair);
    *s = (struct engine_state){0};
}

static inline bool engine_same_element(const struct element *a, const struct element *b)
{
    return record_difference(a, b, false) == NULL;
}

static inline bool engine_same_pair(const struct pair_record *a, const struct pair_record *b)
{
    return a->id_a == b->id_a && a->id_b == b->id_b && a->linked == b->linked &&
           memcmp(&a->stretch, &b->stretch, sizeof a->stretch) == 0 &&
           memcmp(&a->spring, &b->spring, sizeof a->spring) == 0;
}

/* Fails the test at the first element and the first pair whose bits differ. */
static inline void engine_check_same(const struct engine_state *got, const struct engine_state *want,
                                     const char *what)
{
    size_t e = 0, p = 0;
    CHECK_REPORT(got->n == want->n, "%s: %zu elements, expected %zu", what, got->n, want->n);
    while (e < got->n && e < want->n && engine_same_element(&got->e[e], &want->e[e]))
        e++;
    CHECK_REPORT(e == want->n, "%s: element %zu differs: r (%.17g, %.17g) and (%.17g, %.17g)", what, e,
                 got->e[e].r[0], got->e[e].r[1], want->e[e].r[0], want->e[e].r[1]);
    CHECK_REPORT(got->n_pairs == want->n_pairs, "%s: %zu pairs, expected %zu", what, got->n_pairs,
                 want->n_pairs);
    while (p < got->n_pairs && p < want->n_pairs && engine_same_pair(&got->pair[p], &want->pair[p]))
        p++;
    CHECK_REPORT(p == want->n_pairs,
                 "%s: pair %zu differs: (%u, %u) spring %.17g, expected (%u, %u) spring %.17g", what, p,
                 got->pair[p].id_a, got->pair[p].id_b, got->pair[p].spring, want->pair[p].id_a,
                 want->pair[p].id_b, want->pair[p].spring);
}

/* kinetic + potential + elastic + thermal + chemical + phase + damped - work, which an exact integration
 * conserves. */
static inline double engine_total(const struct engine *g, const struct measures *m)
{
    struct exact_sum total = m->kinetic, minus = {.hi = ~m->work.hi, .lo = ~m->work.lo};
    int shift = model_scales(g->model).energy;
    exact_merge(&total, &m->potential);
    exact_merge(&total, &m->elastic);
    exact_merge(&total, &m->thermal);
    exact_merge(&total, &m->chemical);
    exact_merge(&total, &m->phase);
    exact_merge(&total, &m->damped);
    exact_merge(&total, &minus); /* ~work is -work less one quantum */
    return exact_value(&total, shift);
}

#endif

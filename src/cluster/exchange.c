/* Segments of a server.
 *
 * An update holds positions and the other numbers that change, as doubles in an order that both ends know,
 * without ids. The receiver knows how many elements each source sends, so that the length of a segment alone
 * shows a segment that is missing, doubled or wrong. A rebuild holds records; an empty parcel is not sent.
 * The engine checks whether an element belongs where it arrives. */
#include "exchange.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "relay.h"

enum dm2_status exchange_open(struct exchange *x, const struct model *model, int rank, int ranks,
                              struct dm2_error *err)
{
    *x = (struct exchange){.rank = rank,
                           .ranks = ranks,
                           .width = subdomain_update_width(model),
                           .limits = record_limits_of(model)};
    x->out = mem_zalloc((size_t)ranks, sizeof *x->out);
    x->in = mem_zalloc((size_t)ranks, sizeof *x->in);
    x->came = mem_zalloc((size_t)ranks, 1);
    if (x->out != NULL && x->in != NULL && x->came != NULL)
        return DM2_OK;
    exchange_free(x);
    return dm2_fail(err, DM2_MEMORY, "no memory for the exchange among %d ranks", ranks);
}

void exchange_free(struct exchange *x)
{
    free(x->values);
    free(x->out);
    free(x->in);
    free(x->came);
    *x = (struct exchange){0};
}

/* Room for the doubles of n elements; NULL without memory. */
static double *reserve_values(struct exchange *x, size_t n)
{
    double *values = NULL;
    if (n <= SIZE_MAX / x->width)
        values = mem_grown(x->values, &x->values_cap, 0, n * x->width, sizeof *values);
    if (values != NULL)
        x->values = values;
    return values;
}

/* Appends the head of a segment, without its length; returns where the segment starts. */
static size_t start_segment(struct bytes_writer *w, int from, int to)
{
    bytes_put_u16(w, (uint16_t)from);
    bytes_put_u16(w, (uint16_t)to);
    bytes_put_u32(w, 0);
    return w->length;
}

static void end_segment(struct bytes_writer *w, size_t start)
{
    if (w->length - start > UINT32_MAX)
        w->failed = true;
    else
        bytes_patch_u32(w, start - 4, (uint32_t)(w->length - start));
}

enum dm2_status exchange_pack_update(struct exchange *x, const struct subdomain *sd, struct bytes_writer *w,
                                     uint32_t *count, struct dm2_error *err)
{
    *count = 0;
    for (int to = 0; to < x->ranks; to++) {
        size_t n = to == x->rank ? 0 : subdomain_send_count(sd, to);
        if (n == 0)
            continue;
        double *values = reserve_values(x, n);
        if (values == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory to send %zu elements", n);
        subdomain_pack_update(sd, to, values);
        size_t start = start_segment(w, x->rank, to);
        bytes_put_f64s(w, values, n * x->width);
        end_segment(w, start);
        ++*count;
    }
    return w->failed ? dm2_fail(err, DM2_MEMORY, "no memory for the elements to send") : DM2_OK;
}

enum dm2_status exchange_pack_rebuild(struct exchange *x, struct subdomain *sd, struct bytes_writer *w,
                                      uint32_t *count, uint64_t *migrants, struct dm2_error *err)
{
    enum dm2_status status = subdomain_sort_out(sd, x->out, err);
    *count = 0;
    *migrants = 0;
    if (status != DM2_OK)
        return status;
    for (int to = 0; to < x->ranks; to++) {
        const struct parcel *p = &x->out[to];
        if (to == x->rank || p->n_migrants + p->n_pairs + p->n_mirrors == 0)
            continue;
        size_t start = start_segment(w, x->rank, to);
        wire_put_parcel(w, p);
        end_segment(w, start);
        ++*count;
        *migrants += p->n_migrants;
    }
    return w->failed ? dm2_fail(err, DM2_MEMORY, "no memory for the elements to send") : DM2_OK;
}

/* Takes the next segment: its source, and a reader of its bytes. False where the segment is cut, doubled, or
 * not for this rank. */
static bool get_segment(struct exchange *x, struct bytes_reader *r, int *from, struct bytes_reader *segment)
{
    *from = bytes_get_u16(r);
    int to = bytes_get_u16(r);
    uint32_t length = bytes_get_u32(r);
    const unsigned char *data = bytes_get_raw(r, length);
    if (r->failed || to != x->rank || *from >= x->ranks || *from == x->rank || x->came[*from])
        return false;
    x->came[*from] = 1;
    *segment = bytes_reader_of(data, length);
    return true;
}

static enum dm2_status fail_segments(const struct exchange *x, struct dm2_error *err)
{
    return dm2_fail(err, DM2_PROTOCOL, "rank %d got segments that are cut, doubled or not its own", x->rank);
}

enum dm2_status exchange_take_update(struct exchange *x, struct subdomain *sd, struct bytes_reader *r,
                                     uint32_t count, struct dm2_error *err)
{
    memset(x->came, 0, (size_t)x->ranks);
    for (uint32_t k = 0; k < count; k++) {
        int from;
        struct bytes_reader segment;
        if (!get_segment(x, r, &from, &segment))
            return fail_segments(x, err);
        size_t n = subdomain_receive_count(sd, from);
        if (n == 0 || segment.length / 8 / x->width != n || segment.length != 8 * n * x->width)
            return dm2_fail(err, DM2_PROTOCOL,
                            "rank %d got %zu bytes from rank %d for %zu mirrored elements of %zu bytes",
                            x->rank, segment.length, from, n, 8 * x->width);
        double *values = reserve_values(x, n);
        if (values == NULL)
            return dm2_fail(err, DM2_MEMORY, "no memory to take %zu elements", n);
        bytes_get_f64s(&segment, values, n * x->width);
        enum dm2_status status = subdomain_take_update(sd, from, values, err);
        if (status != DM2_OK)
            return status;
    }
    if (!bytes_done(r))
        return fail_segments(x, err);
    for (int from = 0; from < x->ranks; from++)
        if (from != x->rank && !x->came[from] && subdomain_receive_count(sd, from) > 0)
            return dm2_fail(err, DM2_PROTOCOL,
                            "rank %d got nothing from rank %d, of which it mirrors %zu elements", x->rank,
                            from, subdomain_receive_count(sd, from));
    return DM2_OK;
}

/* A value that cannot be ends the run, because the next try would compute it again. */
static enum dm2_status fail_parcel(const struct exchange *x, int from, const char *why, struct dm2_error *err)
{
    if (why[0] == '\0')
        return dm2_fail(err, DM2_PROTOCOL,
                        "rank %d got a parcel from rank %d that is cut, or for which there is no memory",
                        x->rank, from);
    return dm2_fail(err, DM2_NUMERIC, "rank %d got a parcel from rank %d with a value that cannot be: %s",
                    x->rank, from, why);
}

enum dm2_status exchange_take_rebuild(struct exchange *x, struct subdomain *sd, struct bytes_reader *r,
                                      uint32_t count, struct dm2_error *err)
{
    enum dm2_status status = DM2_OK;
    size_t n = 0;
    memset(x->came, 0, (size_t)x->ranks);
    for (uint32_t k = 0; k < count && status == DM2_OK; k++) {
        int from;
        struct bytes_reader segment;
        if (!get_segment(x, r, &from, &segment)) {
            status = fail_segments(x, err);
            break;
        }
        char why[BYTES_WHY] = "";
        segment.why = why;
        wire_get_parcel(&segment, &x->limits, &x->in[n]);
        if (!bytes_done(&segment)) {
            wire_parcel_free(&x->in[n]);
            status = fail_parcel(x, from, why, err);
            break;
        }
        n++;
    }
    if (status == DM2_OK && !bytes_done(r))
        status = fail_segments(x, err);
    if (status == DM2_OK) {
        x->in[n] = x->out[x->rank]; /* its arrays are the engine's: not freed here */
        status = subdomain_take_in(sd, x->in, n + 1, err);
    }
    for (size_t k = 0; k < n; k++)
        wire_parcel_free(&x->in[k]);
    return status;
}

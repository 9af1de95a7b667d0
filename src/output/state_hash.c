/* The hash of a record mixes every field, doubles by their bits, -0 as 0 like in the state file; the last
 * round makes each bit of the hash depend on every field. Padding is not hashed, because the fields are mixed
 * one by one. */
#include "dm2/output/state_hash.h"

#include <stdlib.h>
#include <string.h>

#include "dm2/base/mem.h"
#include "dm2/base/number.h"
#include "dm2/engine/record.h"

/* One round of splitmix64 (Steele, Lea and Flood, 2014) over the running hash. */
static uint64_t mix_value(uint64_t h, uint64_t value)
{
    h = (h ^ value) + 0x9e3779b97f4a7c15U;
    h = (h ^ h >> 30) * 0xbf58476d1ce4e5b9U;
    h = (h ^ h >> 27) * 0x94d049bb133111ebU;
    return h ^ h >> 31;
}

static uint64_t mix_double(uint64_t h, double value)
{
    uint64_t bits;
    value = number_plus_zero(value);
    memcpy(&bits, &value, sizeof bits);
    return mix_value(h, bits);
}

uint64_t state_hash_element(const struct element *e)
{
    uint64_t h = mix_value(1, e->id);
    h = mix_value(h, (uint64_t)e->was << 48 | (uint64_t)e->bonds << 32 | e->grain);
    h = mix_value(h, (uint64_t)e->body << 32 | (uint64_t)e->kind << 16 | (uint64_t)e->flags << 8 | e->probes);
    h = mix_value(h, (uint64_t)(uint32_t)e->image[0] << 32 | (uint32_t)e->image[1]);
    double fields[ELEMENT_DOUBLES];
    record_doubles(e, fields);
    for (size_t k = 0; k < ELEMENT_DOUBLES; k++)
        h = mix_double(h, fields[k]);
    return h;
}

uint64_t state_hash_pair(const struct pair_record *p)
{
    uint64_t h = mix_value(2, (uint64_t)p->id_a << 32 | p->id_b);
    h = mix_value(h, p->linked);
    h = mix_double(h, p->stretch);
    return mix_double(h, p->spring);
}

uint64_t state_hash_section(enum section kind, const void *record)
{
    struct bytes_writer w = {0};
    uint64_t h = mix_value(3, (uint64_t)kind);
    section_kinds[kind].put(&w, record);
    for (size_t k = 0; k < w.length; k += sizeof h) {
        uint64_t part = 0;
        for (size_t b = 0; b < sizeof h && k + b < w.length; b++)
            part |= (uint64_t)w.data[k + b] << 8 * b;
        h = mix_value(h, part);
    }
    bytes_free(&w);
    return h;
}

enum dm2_status state_hash_subdomain(const struct subdomain *sd, uint64_t *out, struct dm2_error *err)
{
    size_t n = subdomain_owned(sd), n_pairs = 0;
    struct element *elements = mem_alloc(n, sizeof *elements);
    struct pair_record *pairs = NULL;
    struct section_array sections[SECTION_COUNT] = {{.n = 0}};
    if (elements == NULL)
        return dm2_fail(err, DM2_MEMORY, "no memory to hash the state of %zu elements", n);
    enum dm2_status status = subdomain_collect(sd, elements, NULL, err);
    if (status == DM2_OK)
        status = subdomain_collect_pairs(sd, &pairs, &n_pairs, err);
    if (status == DM2_OK)
        status = subdomain_collect_sections(sd, sections, err);
    if (status == DM2_OK) {
        uint64_t sum = 0;
        for (size_t k = 0; k < n; k++)
            sum += state_hash_element(&elements[k]);
        for (size_t k = 0; k < n_pairs; k++)
            sum += state_hash_pair(&pairs[k]);
        for (int kind = 0; kind < SECTION_COUNT; kind++)
            for (size_t k = 0; k < sections[kind].n; k++)
                sum += state_hash_section((enum section)kind,
                                          section_record((enum section)kind, &sections[kind], k));
        *out = sum;
    }
    section_free(sections);
    free(elements);
    free(pairs);
    return status;
}

/* Binding has three passes over the blocks: the first finds the kind of each block, the second the names of
 * the materials, so that the order of blocks does not matter, the third reads all values.
 *
 * A missing block or keyword is a finding only where no unknown word is near its name, because `sise = 1 2`
 * is one mistake, not an unknown keyword and a missing keyword. */
#include "bind.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "bind_loads.h"
#include "bind_start.h"
#include "dm2/base/mem.h"
#include "dm2/deck/shape.h"

static const struct deck_block *block_at(const struct deck_binding *b, size_t block)
{
    return &b->tree->blocks[block];
}

static const struct deck_entry *entry_of(const struct deck_binding *b, size_t block, const char *key)
{
    return block < b->tree->n_blocks ? deck_tree_entry(b->tree, block_at(b, block), key) : NULL;
}

bool binding_given(const struct deck_binding *b, size_t block, const char *key)
{
    const struct deck_entry *entry = entry_of(b, block, key);
    return entry != NULL && !entry->bad;
}

bool binding_bad(const struct deck_binding *b, size_t block, const char *key)
{
    const struct deck_entry *entry = entry_of(b, block, key);
    return entry != NULL && entry->bad;
}

struct deck_place binding_place(const struct deck_binding *b, size_t block, const char *key, size_t i)
{
    const struct deck_entry *entry = entry_of(b, block, key);
    if (block >= b->tree->n_blocks)
        return b->tree->end;
    if (entry == NULL)
        return block_at(b, block)->word;
    return i < entry->n ? b->tree->nodes[b->tree->values[entry->first + i]].place : entry->key;
}

/* --- the kinds of blocks --- */

static struct deck_place name_of(const struct deck_binding *b, size_t block, size_t i)
{
    return b->tree->names[block_at(b, block)->first_name + i];
}

/* The i-th name of a block without its quotes. */
static struct deck_place bare_name_of(const struct deck_binding *b, size_t block, size_t i)
{
    struct deck_place name = name_of(b, block, i);
    if (place_bytes(b->tree->source, name)[0] == '"') {
        name.offset++;
        name.length -= 2;
    }
    return name;
}

static void check_single(struct deck_binding *b, size_t block)
{
    enum block_kind kind = b->kinds[block];
    if (b->single[kind] == b->tree->n_blocks)
        b->single[kind] = block;
    else if (schema_block(kind)->single)
        findings_error(b->findings, block_at(b, block)->word, "there is a block '%s' before; a deck has one",
                       schema_block(kind)->name);
}

static bool kind_is_named(enum block_kind kind)
{
    return kind == BLOCK_MATERIAL || kind == BLOCK_BODY || kind == BLOCK_PROBE || kind == BLOCK_PROFILE ||
           kind == BLOCK_VOID || kind == BLOCK_FLAW || kind == BLOCK_PHASE || kind == BLOCK_REACTION ||
           kind == BLOCK_LOAD || kind == BLOCK_WALL;
}

/* Checks the number of names between the word and the brace, and whether they are valid names. */
static bool check_head(struct deck_binding *b, size_t block)
{
    const struct block_schema *schema = schema_block(b->kinds[block]);
    const struct deck_block *at = block_at(b, block);
    size_t extra = b->kinds[block] == BLOCK_INTERFACE ? 1 : 0, n = at->n_names;
    bool ok = schema->single                   ? n == 0
              : b->kinds[block] == BLOCK_PHASE ? n == 2
              : kind_is_named(b->kinds[block]) ? n == 1
              : b->kinds[block] == BLOCK_STOP  ? n == 0
                                               : n == extra || n == extra + 2;
    struct place_text text;
    if (!ok) {
        struct deck_place place =
            n == 0 ? at->word : place_span(name_of(b, block, 0), name_of(b, block, n - 1));
        if (!at->bad)
            findings_error(b->findings, place, "between '%s' and '{' belongs %s, found %zu name%s",
                           schema->name, schema->names, n, n == 1 ? "" : "s");
        return false;
    }
    for (size_t i = 0; i < n && kind_is_named(b->kinds[block]); i++) {
        struct deck_place name = name_of(b, block, i);
        if (place_bytes(b->tree->source, name)[0] == '"' || name.length > NAME_MAX_LENGTH) {
            findings_error(b->findings, name, "a name is letters, digits and _, at most %d, not %s",
                           NAME_MAX_LENGTH, place_text(b->tree->source, name, &text));
            return false;
        }
    }
    return true;
}

static bool find_kinds(struct deck_binding *b)
{
    struct deck_tree *tree = b->tree;
    b->kinds = mem_zalloc(tree->n_blocks, sizeof *b->kinds);
    bool ok = b->kinds != NULL;
    for (int kind = 0; kind < BLOCK_COUNT; kind++) {
        b->blocks[kind] = mem_zalloc(tree->n_blocks, sizeof(size_t));
        ok = ok && b->blocks[kind] != NULL;
    }
    if (!ok)
        return false;
    for (int kind = 0; kind < BLOCK_COUNT; kind++)
        b->single[kind] = tree->n_blocks;
    struct word_list known = schema_block_names();
    for (size_t i = 0; i < tree->n_blocks; i++) {
        struct deck_place word = tree->blocks[i].word;
        const char *bytes = place_bytes(tree->source, word);
        struct place_text text;
        struct word_hint hint;
        b->kinds[i] = schema_find_block(bytes, word.length);
        if (b->kinds[i] != BLOCK_COUNT)
            check_single(b, i);
        else if (!tree->blocks[i].bad)
            findings_error(b->findings, word, "there is no block '%s'%s",
                           place_text(tree->source, word, &text),
                           words_hint(&known, bytes, word.length, &hint));
    }
    return true;
}

static bool unknown_block_like(const struct deck_binding *b, const char *name)
{
    for (size_t i = 0; i < b->tree->n_blocks; i++) {
        struct deck_place word = block_at(b, i)->word;
        if (b->kinds[i] == BLOCK_COUNT && words_near(place_bytes(b->tree->source, word), word.length, name))
            return true;
    }
    return false;
}

static void check_missing_blocks(struct deck_binding *b)
{
    for (int kind = 0; kind < BLOCK_COUNT && !b->tree->incomplete; kind++) {
        const struct block_schema *schema = schema_block((enum block_kind)kind);
        if (schema->required && b->single[kind] == b->tree->n_blocks && !unknown_block_like(b, schema->name))
            findings_error(b->findings, b->tree->end, "the deck has no block '%s'", schema->name);
    }
}

/* --- blocks that fill arrays of the config --- */

/* Appends the blocks of this kind that have a valid head to `blocks`, which holds `used` of them, up to
 * `max`. Returns their new number. */
static size_t collect_blocks(struct deck_binding *b, enum block_kind kind, size_t max, size_t *blocks,
                             size_t used)
{
    for (size_t i = 0; i < b->tree->n_blocks; i++) {
        if (b->kinds[i] != kind || !check_head(b, i))
            continue;
        if (used == max) {
            findings_error(b->findings, block_at(b, i)->word, "the deck has more than %zu blocks '%s'", max,
                           schema_block(kind)->name);
            break;
        }
        blocks[used++] = i;
    }
    return used;
}

struct named_thing {
    const char *name;
    size_t block;
};

static int compare_named(const void *a, const void *b)
{
    const struct named_thing *x = a, *y = b;
    int order = strcmp(x->name, y->name);
    return order != 0 ? order : x->block < y->block ? -1 : x->block > y->block;
}

/* Copies the names of n blocks to `names`, `stride` bytes apart. A repeated name is a finding. False: no
 * memory. */
static bool name_things(struct deck_binding *b, const size_t *blocks, size_t n, char *names, size_t stride)
{
    struct named_thing *sorted = mem_zalloc(n, sizeof *sorted);
    if (sorted == NULL)
        return false;
    for (size_t i = 0; i < n; i++) {
        struct deck_place name = name_of(b, blocks[i], 0);
        memcpy(names + i * stride, place_bytes(b->tree->source, name), name.length);
        sorted[i] = (struct named_thing){names + i * stride, blocks[i]};
    }
    qsort(sorted, n, sizeof *sorted, compare_named);
    for (size_t i = 1; i < n; i++) {
        struct place_text kind;
        if (strcmp(sorted[i].name, sorted[i - 1].name) == 0)
            findings_error(b->findings, name_of(b, sorted[i].block, 0), "there is a %s '%s' before",
                           place_text(b->tree->source, block_at(b, sorted[i].block)->word, &kind),
                           sorted[i].name);
    }
    free(sorted);
    return true;
}

static bool unknown_key_like(const struct deck_binding *b, size_t block, const struct block_schema *schema,
                             const char *name)
{
    const struct deck_block *at = block_at(b, block);
    for (size_t i = 0; i < at->n_entries; i++) {
        struct deck_place key = b->tree->entries[at->first_entry + i].key;
        const char *bytes = place_bytes(b->tree->source, key);
        if (schema_find_key(schema, bytes, key.length) < 0 && words_near(bytes, key.length, name))
            return true;
    }
    return false;
}

bool binding_missing(const struct deck_binding *b, size_t block, const char *key)
{
    return entry_of(b, block, key) == NULL && !block_at(b, block)->bad &&
           !unknown_key_like(b, block, schema_block(b->kinds[block]), key);
}

/* Reads all entries of a block into `base`. Bit i of *set: the i-th keyword of the schema was given; of *bad:
 * its value did not read. */
static void read_entries(struct deck_binding *b, size_t block, void *base, uint32_t *set, uint32_t *bad)
{
    const struct deck_block *at = block_at(b, block);
    const struct block_schema *schema = schema_block(b->kinds[block]);
    struct word_list known = schema_key_names(schema);
    *set = *bad = 0;
    for (size_t i = 0; i < at->n_entries; i++) {
        struct deck_entry *entry = &b->tree->entries[at->first_entry + i];
        const char *word = place_bytes(b->tree->source, entry->key);
        int key = schema_find_key(schema, word, entry->key.length);
        struct place_text text;
        struct word_hint hint;
        if (key < 0) {
            findings_error(b->findings, entry->key, "'%s' is no keyword of '%s'%s",
                           place_text(b->tree->source, entry->key, &text), schema->name,
                           words_hint(&known, word, entry->key.length, &hint));
        } else if (*set >> key & 1u) {
            findings_error(b->findings, entry->key, "'%s' is given twice", schema->keys[key].name);
        } else {
            *set |= 1u << key;
            if (!value_read(b, &schema->keys[key], entry, base))
                *bad |= 1u << key;
        }
    }
}

static void check_missing_keys(struct deck_binding *b, size_t block, uint32_t set)
{
    const struct block_schema *schema = schema_block(b->kinds[block]);
    if (block_at(b, block)->bad)
        return;
    for (size_t i = 0; i < schema->n_keys; i++) {
        const struct deck_key *key = &schema->keys[i];
        bool replaced = b->steps_replaced && strcmp(key->name, "steps") == 0;
        if (key->required && (set >> i & 1u) == 0 && !replaced &&
            !unknown_key_like(b, block, schema, key->name))
            findings_error(b->findings, block_at(b, block)->word, "the block '%s' lacks '%s': %s",
                           schema->name, key->name, key->meaning);
    }
}

static void read_block(struct deck_binding *b, size_t block, void *base)
{
    uint32_t set, bad;
    read_entries(b, block, base, &set, &bad);
    if (b->kinds[block] != BLOCK_BODY || !start_is_taken(b, base))
        check_missing_keys(b, block, set);
}

/* The defaults of the row spacing and of the radius follow from the spacing. */
static void finish_body(struct deck_binding *b, size_t block, void *item)
{
    struct body_config *body = item;
    if (start_is_taken(b, body)) {
        start_take_body(b, block, body);
        return;
    }
    if (entry_of(b, block, "row_spacing") == NULL)
        body->row_spacing =
            body->lattice == LATTICE_HEXAGONAL ? body->spacing * 0.86602540378443864676 : body->spacing;
    if (entry_of(b, block, "radius") == NULL)
        body->radius = body->spacing / 2;
    if (binding_given(b, block, "solid_fraction"))
        body->packing_place = findings_place(b->findings, binding_place(b, block, "solid_fraction", 0));
}

/* The default of the range is the domain, that of the interval 1/20 of the run. */
static void finish_profile(struct deck_binding *b, size_t block, void *item)
{
    const struct config *c = b->config;
    struct profile_config *profile = item;
    if (entry_of(b, block, "range") == NULL) {
        profile->range[0] = c->origin[profile->axis];
        profile->range[1] = c->origin[profile->axis] + c->size[profile->axis];
    }
    if (profile->every < 1)
        profile->every = c->steps / 20 > 1 ? c->steps / 20 : 1;
}

/* The default of `report` depends on what is measured; a region has a bit in its elements' records. */
static void finish_probe(struct deck_binding *b, size_t block, void *item)
{
    const struct config *c = b->config;
    struct probe_config *probe = item;
    if (probe->report == 0)
        probe->report = 1u << REPORT_POSITION | 1u << REPORT_VELOCITY |
                        (entry_of(b, block, "body") != NULL ? 1u << REPORT_FORCE : 0u);
    probe->wall = probe->mover >= (int)c->n_bodies;
    if (probe->mover >= 0 && !probe->wall)
        shape_box(&c->bodies[probe->mover].shape, probe->box);
    for (const struct probe_config *p = c->probes; probe->mover < 0 && p <= probe; p++)
        probe->bit += p->mover < 0;
}

static const struct reaction_config initial_reaction = {.reactant = {-1, -1}, .product = -1};
static const struct void_config initial_void = {.body = -1};
static const struct flaw_config initial_flaw = {.body = -1};
static const struct probe_config initial_probe = {.mover = -1, .bit = -1};
static const struct wall_config initial_wall = {.material = -1};

static const struct deck_things things[BLOCK_COUNT] = {
    [BLOCK_MATERIAL] = {MATERIAL_MAX, sizeof(struct material_config), offsetof(struct config, materials),
                        offsetof(struct config, n_materials), NULL, NULL},
    [BLOCK_REACTION] = {REACTION_MAX, sizeof(struct reaction_config), offsetof(struct config, reactions),
                        offsetof(struct config, n_reactions), &initial_reaction, NULL},
    [BLOCK_BODY] = {BODY_MAX, sizeof(struct body_config), offsetof(struct config, bodies),
                    offsetof(struct config, n_bodies), NULL, finish_body},
    [BLOCK_VOID] = {VOID_MAX, sizeof(struct void_config), offsetof(struct config, voids),
                    offsetof(struct config, n_voids), &initial_void, NULL},
    [BLOCK_FLAW] = {FLAW_MAX, sizeof(struct flaw_config), offsetof(struct config, flaws),
                    offsetof(struct config, n_flaws), &initial_flaw, NULL},
    [BLOCK_WALL] = {WALL_MAX, sizeof(struct wall_config), offsetof(struct config, walls),
                    offsetof(struct config, n_walls), &initial_wall, NULL},
    [BLOCK_PROBE] = {PROBE_MAX, sizeof(struct probe_config), offsetof(struct config, probes),
                     offsetof(struct config, n_probes), &initial_probe, finish_probe},
    [BLOCK_PROFILE] = {PROFILE_MAX, sizeof(struct profile_config), offsetof(struct config, profiles),
                       offsetof(struct config, n_profiles), NULL, finish_profile},
    [BLOCK_STOP] = {STOP_MAX, sizeof(struct stop_config), offsetof(struct config, stops),
                    offsetof(struct config, n_stops), NULL, NULL},
};

const struct deck_things *binding_things(enum block_kind kind)
{
    return &things[kind];
}

/* Fills the array of things[kind] from all blocks of this kind. False: no memory. */
static bool bind_things(struct deck_binding *b, enum block_kind kind)
{
    const struct deck_things *thing = &things[kind];
    const size_t *blocks = b->blocks[kind];
    size_t n = collect_blocks(b, kind, thing->most, b->blocks[kind], 0);
    char *items = mem_zalloc(n, thing->size);
    if (items == NULL)
        return false;
    memcpy((char *)b->config + thing->items, &items, sizeof items);
    memcpy((char *)b->config + thing->count, &n, sizeof n);
    for (size_t i = 0; i < n; i++) {
        char *item = items + i * thing->size;
        if (thing->initial != NULL)
            memcpy(item, thing->initial, thing->size);
        schema_defaults(schema_block(kind), item);
        read_block(b, blocks[i], item);
        if (thing->finish != NULL)
            thing->finish(b, blocks[i], item);
    }
    return n == 0 || !kind_is_named(kind) || name_things(b, blocks, n, items, thing->size);
}

/* --- phases --- */

/* Sets each constant that the deck does not give to that of the parent phase. */
static void inherit_constants(struct deck_binding *b, size_t block, const struct material_config *from,
                              struct material_config *to)
{
    const struct block_schema *schema = schema_block(BLOCK_PHASE);
    for (size_t i = 0; i < schema->n_keys; i++) {
        size_t offset = schema->keys[i].offset;
        if (offset < offsetof(struct phase_config, state) || entry_of(b, block, schema->keys[i].name) != NULL)
            continue;
        offset -= offsetof(struct phase_config, state);
        memcpy((char *)to + offset, (const char *)from + offset, sizeof(double));
    }
    memcpy(to->name, from->name, sizeof to->name);
    to->mass = from->mass;
    to->t0 = from->t0;
}

/* The parent of phase i: the index of an earlier phase; -1: the material itself; -2: unknown, a finding was
 * added. */
static int find_parent_phase(struct deck_binding *b, size_t i)
{
    const struct phase_config *phases = b->config->phases, *phase = &phases[i];
    struct deck_place place = binding_place(b, b->blocks[BLOCK_PHASE][i], "from", 0);
    if (phase->from_name[0] == '\0')
        return -1;
    for (size_t k = 0; k < i; k++)
        if (phases[k].material == phase->material && strcmp(phases[k].name, phase->from_name) == 0)
            return (int)k;
    findings_error(b->findings, place, "the material '%s' has no phase '%s' before this one",
                   b->config->materials[phase->material].name, phase->from_name);
    return -2;
}

static bool bind_phases(struct deck_binding *b)
{
    struct config *c = b->config;
    size_t n = collect_blocks(b, BLOCK_PHASE, PHASE_MAX, b->blocks[BLOCK_PHASE], 0);
    c->phases = mem_zalloc(n, sizeof *c->phases);
    if (c->phases == NULL)
        return false;
    for (size_t k = 0; k < n; k++) {
        struct phase_config *phase = &c->phases[c->n_phases];
        size_t block = b->blocks[BLOCK_PHASE][c->n_phases] = b->blocks[BLOCK_PHASE][k];
        struct deck_place name = name_of(b, block, 1);
        *phase = (struct phase_config){.material = binding_material(b, name_of(b, block, 0))};
        memcpy(phase->name, place_bytes(b->tree->source, name), name.length);
        schema_defaults(schema_block(BLOCK_PHASE), phase);
        read_block(b, block, phase);
        if (phase->material < 0)
            continue;
        for (size_t i = 0; i < c->n_phases; i++)
            if (c->phases[i].material == phase->material && strcmp(c->phases[i].name, phase->name) == 0)
                findings_error(b->findings, name, "the material '%s' has a phase '%s' before",
                               c->materials[phase->material].name, phase->name);
        phase->from = find_parent_phase(b, c->n_phases);
        if (phase->from == -2)
            continue;
        inherit_constants(b, block,
                          phase->from < 0 ? &c->materials[phase->material] : &c->phases[phase->from].state,
                          &phase->state);
        c->n_phases++;
    }
    return true;
}

/* --- interactions --- */

static bool read_rule_head(struct deck_binding *b, size_t block, struct interaction_rule *rule)
{
    static const char relations[] = "grain|body";
    size_t first = 0;
    *rule = (struct interaction_rule){.relation = -1, .material = {-1, -1}};
    if (b->kinds[block] == BLOCK_INTERFACE) {
        struct deck_place word = name_of(b, block, 0);
        int choice = schema_find_choice(relations, place_bytes(b->tree->source, word), word.length);
        struct place_text text;
        if (choice < 0) {
            findings_error(b->findings, word, "an interface is one of 'grain' and 'body', not '%s'",
                           place_text(b->tree->source, word, &text));
            return false;
        }
        rule->relation = choice == 0 ? RELATION_OTHER_GRAIN : RELATION_OTHER_BODY;
        first = 1;
    }
    bool ok = true;
    for (size_t i = first; i < block_at(b, block)->n_names; i++) {
        rule->material[i - first] = binding_material(b, bare_name_of(b, block, i));
        ok = ok && rule->material[i - first] >= 0;
    }
    if (rule->material[0] > rule->material[1]) {
        int swap = rule->material[0];
        rule->material[0] = rule->material[1];
        rule->material[1] = swap;
    }
    return ok;
}

/* A distinct index for each combination of relation and materials that a rule can name. */
static long rule_pair_index(const struct interaction_rule *rule)
{
    return ((long)(rule->relation + 1) * (MATERIAL_MAX + 1) + rule->material[0] + 1) * (MATERIAL_MAX + 1) +
           rule->material[1] + 1;
}

static bool bind_rules(struct deck_binding *b)
{
    struct config *c = b->config;
    size_t n = collect_blocks(b, BLOCK_INTERACTION, RULE_MAX, b->blocks[BLOCK_INTERACTION], 0);
    n = collect_blocks(b, BLOCK_INTERFACE, RULE_MAX, b->blocks[BLOCK_INTERACTION], n);
    unsigned char *seen =
        mem_zalloc((size_t)(RELATION_COUNT + 1) * (MATERIAL_MAX + 1) * (MATERIAL_MAX + 1), 1);
    c->rules = mem_zalloc(n, sizeof *c->rules);
    bool ok = c->rules != NULL && seen != NULL;
    for (size_t i = 0; ok && i < n; i++) {
        struct interaction_rule *rule = &c->rules[c->n_rules];
        size_t block = b->blocks[BLOCK_INTERACTION][i];
        bool head = read_rule_head(b, block, rule);
        read_entries(b, block, &rule->value, &rule->set, &rule->bad);
        if (head && seen[rule_pair_index(rule)])
            findings_error(b->findings, block_at(b, block)->word,
                           "there is a block for the same pair before");
        if (!head)
            continue;
        seen[rule_pair_index(rule)] = 1;
        b->blocks[BLOCK_INTERACTION][c->n_rules++] = block;
    }
    free(seen);
    return ok;
}

/* --- loads --- */

static bool bind_loads(struct deck_binding *b)
{
    size_t n = collect_blocks(b, BLOCK_LOAD, LOAD_MAX, b->blocks[BLOCK_LOAD], 0);
    size_t *blocks = b->blocks[BLOCK_LOAD];
    name_text *names = mem_zalloc(n, sizeof *names);
    b->blocks[BLOCK_LOAD] = mem_zalloc(n * LOAD_QUANTITIES, sizeof *blocks);
    b->config->loads = mem_zalloc(n * LOAD_QUANTITIES, sizeof *b->config->loads);
    bool ok = names != NULL && b->blocks[BLOCK_LOAD] != NULL && b->config->loads != NULL &&
              (n == 0 || name_things(b, blocks, n, names[0], sizeof *names));
    for (size_t i = 0; i < n && ok; i++) {
        struct load_block read = load_block_start();
        schema_defaults(schema_block(BLOCK_LOAD), &read);
        read_block(b, blocks[i], &read);
        memcpy(read.common.name, names[i], sizeof names[i]);
        ok = load_bind(b, blocks[i], &read);
    }
    free(names);
    free(blocks);
    return ok;
}

static void bind_single(struct deck_binding *b, enum block_kind kind)
{
    size_t block = b->single[kind];
    if (block < b->tree->n_blocks && check_head(b, block))
        read_block(b, block, b->config);
}

bool deck_bind(struct deck_binding *b, int64_t steps)
{
    struct config *c = b->config;
    b->steps_replaced = steps >= 0;
    if (!find_kinds(b)) {
        b->findings->no_memory = true;
        return false;
    }
    schema_defaults(schema_block(BLOCK_DOMAIN), c);
    schema_defaults(schema_block(BLOCK_TIME), c);
    schema_defaults(schema_block(BLOCK_START), c);
    schema_defaults(schema_block(BLOCK_OUTPUT), c);
    c->output.vtp = true;
    c->output.fields = OUTPUT_ALL_FIELDS;
    bool ok = start_open(b);
    bind_single(b, BLOCK_START);
    ok = ok && bind_things(b, BLOCK_MATERIAL) && bind_phases(b) && bind_things(b, BLOCK_REACTION) &&
         bind_rules(b) && bind_things(b, BLOCK_BODY) && bind_things(b, BLOCK_WALL) && bind_loads(b) &&
         bind_things(b, BLOCK_VOID) && bind_things(b, BLOCK_FLAW) && bind_things(b, BLOCK_PROBE);
    bind_single(b, BLOCK_DOMAIN);
    bind_single(b, BLOCK_TIME);
    if (binding_given(b, b->single[BLOCK_TIME], "dt"))
        c->dt_place = findings_place(b->findings, binding_place(b, b->single[BLOCK_TIME], "dt", 0));
    bind_single(b, BLOCK_OUTPUT);
    check_missing_blocks(b);
    if (steps >= 0)
        c->steps = steps;
    c->deck_steps = c->steps;
    /* The domain and the time are bound by now; finish_profile and walls_finish read them. */
    ok = bind_things(b, BLOCK_PROFILE) && bind_things(b, BLOCK_STOP) && ok;
    walls_finish(b);
    start_finish(b);
    if (c->output.history_every < 0)
        c->output.history_every = c->steps / 200 > 150 ? c->steps / 200 : 150;
    b->findings->no_memory |= !ok;
    return !b->findings->no_memory;
}

void deck_binding_free(struct deck_binding *b)
{
    start_close(b);
    free(b->kinds);
    for (int kind = 0; kind < BLOCK_COUNT; kind++)
        free(b->blocks[kind]);
}

/* Resolution of interactions, and the other functions on a config. A rule sets some keywords of an
 * interaction. Of the rules that set a keyword for a pair the most specific one holds, so that `interface
 * body { linked = no }` changes nothing but `linked`. */
#include "dm2/deck/config.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <math.h>
#include <string.h>

#include "interaction_rule.h"
#include "schema.h"

int interaction_rule_rank(const struct interaction_rule *rule, int a, int b, enum relation relation)
{
    bool any = rule->material[0] < 0;
    bool same = rule->material[0] == a && rule->material[1] == b;
    bool swapped = rule->material[0] == b && rule->material[1] == a;
    if ((!any && !same && !swapped) || (rule->relation >= 0 && rule->relation != (int)relation))
        return -1;
    return (any ? 0 : 2) + (rule->relation >= 0 ? 1 : 0);
}

int interaction_rule_of(const struct config *c, int a, int b, enum relation relation, int key)
{
    int best = -1, best_rank = -1;
    for (size_t i = 0; i < c->n_rules; i++) {
        int rank = interaction_rule_rank(&c->rules[i], a, b, relation);
        if (rank > best_rank && (c->rules[i].set >> key & 1u) != 0) {
            best = (int)i;
            best_rank = rank;
        }
    }
    return best;
}

static void apply_rule(struct interaction_config *into, const struct interaction_rule *rule)
{
    const struct block_schema *schema = schema_block(BLOCK_INTERACTION);
    for (size_t i = 0; i < schema->n_keys; i++) {
        const struct deck_key *key = &schema->keys[i];
        if ((rule->set & ~rule->bad) >> i & 1u)
            memcpy((char *)into + key->offset, (const char *)&rule->value + key->offset, schema_size(key));
    }
}

struct interaction_config config_interaction(const struct config *c, int a, int b, enum relation relation)
{
    struct interaction_config out;
    memset(&out, 0, sizeof out);
    schema_defaults(schema_block(BLOCK_INTERACTION), &out);
    out.linked = relation == RELATION_SAME_GRAIN;
    for (int rank = 0; rank <= 3; rank++)
        for (size_t i = 0; i < c->n_rules; i++)
            if (interaction_rule_rank(&c->rules[i], a, b, relation) == rank)
                apply_rule(&out, &c->rules[i]);
    return out;
}

const char *config_kind_name(const struct config *c, size_t kind, struct kind_name *out)
{
    if (kind < c->n_materials) {
        (void)snprintf(out->text, sizeof out->text, "%s", c->materials[kind].name);
    } else {
        const struct phase_config *phase = &c->phases[kind - c->n_materials];
        (void)snprintf(out->text, sizeof out->text, "%s/%s", c->materials[phase->material].name, phase->name);
    }
    return out->text;
}

size_t config_movers(const struct config *c)
{
    return c->n_bodies + c->n_walls;
}

const char *config_mover_name(const struct config *c, size_t mover)
{
    return mover < c->n_bodies ? c->bodies[mover].name : c->walls[mover - c->n_bodies].name;
}

const double *config_velocity(const struct config *c, size_t mover)
{
    return mover < c->n_bodies ? c->bodies[mover].velocity : c->walls[mover - c->n_bodies].velocity;
}

bool config_wall_conducts(const struct config *c, size_t wall)
{
    return !isnan(c->walls[wall].temperature) || config_load(c, c->n_bodies + wall, LOAD_TEMPERATURE) != NULL;
}

const struct load_config *config_load(const struct config *c, size_t mover, enum load_quantity quantity)
{
    for (size_t i = 0; i < c->n_loads; i++)
        if (c->loads[i].mover == mover && c->loads[i].quantity == quantity)
            return &c->loads[i];
    return NULL;
}

bool config_is_placed(const struct config *c, size_t body)
{
    if (c->bodies[body].motion != MOTION_DRIVEN)
        return false;
    for (int q = LOAD_VELOCITY_X; q <= LOAD_STRESS_YY; q++)
        if (config_load(c, body, (enum load_quantity)q) != NULL)
            return true;
    return c->bodies[body].spin != 0;
}

size_t config_regions(const struct config *c)
{
    size_t n = 0;
    for (size_t p = 0; p < c->n_probes; p++)
        n += c->probes[p].mover < 0;
    return n;
}

double config_contact_distance(const struct config *c)
{
    double most = 0;
    for (size_t i = 0; i < c->n_bodies; i++)
        if (c->bodies[i].radius > most)
            most = c->bodies[i].radius;
    return 2 * most;
}

enum dm2_status config_fail(const char *place, struct dm2_error *err, enum dm2_status status,
                            const char *format, ...)
{
    char message[400];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(message, sizeof message, format, args);
    va_end(args);
    if (place == NULL)
        return dm2_fail(err, status, "%s", message);
    int where = (int)strcspn(place, "\n");
    return dm2_fail(err, status, "%.*s: error: %s%s", where, place, message, place + where);
}

void config_free(struct config *c)
{
    for (size_t i = 0; i < c->n_bodies; i++)
        free(c->bodies[i].packing_place);
    for (size_t i = 0; i < c->n_loads; i++) {
        free(c->loads[i].time);
        free(c->loads[i].value);
        free(c->loads[i].mass_place);
    }
    free(c->loads);
    for (size_t i = 0; i < c->n_walls; i++) {
        free(c->walls[i].points);
        free(c->walls[i].place);
    }
    free(c->walls);
    free(c->dt_place);
    free(c->start.without);
    free(c->materials);
    free(c->phases);
    free(c->reactions);
    free(c->bodies);
    free(c->probes);
    free(c->profiles);
    free(c->stops);
    free(c->voids);
    free(c->flaws);
    free(c->rules);
    free(c->output.snapshot_at);
    free(c->output.bodies);
    memset(c, 0, sizeof *c);
}

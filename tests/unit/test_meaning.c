/* The meaning of a deck: every keyword has a part, a deck written in another way has the same text, each
 * keyword that is changed alone is named, and every keyword reads back. */
#include "deck/schema.h"
#include "check.h"
#include "meaning_help.h"

#include <stdint.h>

/* One keyword of a block of the deck: its value written in two ways, another value (NULL: the keyword can
 * only be changed together with others), and whether the keyword may be left out because the value is the
 * default. */
struct entry {
    const char *key, *one, *two, *other;
    bool initial;
};

struct block {
    const char *word, *names;
    const struct entry *entries; /* up to one without a key */
};

static const struct entry domain[] = {{"size", "6 cm, 4 cm", "60 mm 4", "6.5, 4", 0},
                                      {"origin", "-0.5 cm, 0", "-5 mm, -0", "-0.25, 0", 0},
                                      {"boundary", "free periodic", "free periodic", "free free", 0},
                                      {"r_c", "0.125 cm", "1.25 mm", "0.126", 0},
                                      {"delta_r", "0.0125 cm", "0.125 mm", "0.013", 0},
                                      {"search", "cells+lists", "cells+lists", "lists", 1},
                                      {"rebuild_every", "0", "0", "3", 1},
                                      {"balance", "space", "space", "particles", 1},
                                      {"gravity", "0 -0.5", "0, -0.5 cm/us2", "0 -0.25", 0},
                                      {"damping", "0", "0", "0.5", 1},
                                      {0}};
static const struct entry steps[] = {
    {"dt", "0.0009765625 us", "2^-10", "0.0004", 0}, {"steps", "200", "2*100", "300", 0}, {0}};
static const struct entry first[] = {
    {"rho0", "8 g/cm3", "8000 kg/m3", "8.5", 0},
    {"c0", "0.5 cm/us", "5 km/s", "0.51", 0},
    {"s", "1.5", "3/2", "1.25", 0},
    {"shear", "0.25 Mbar", "25 GPa", "0.26", 0},
    {"yield", "0.001953125 Mbar", "2^-9", "0.002", 0},
    {"tensile", "0.015625 Mbar", "2^-6", "0.016", 0},
    {"softening", "1", "1.0", "2", 1},
    {"t0", "300 K", "3e2", NULL, 1}, /* as of the materials that react with it */
    {"tm", "1500", "1500 K", "1600", 0},
    {"cp", "0.0000038146972656250", "2^-18", "5e-6", 0},
    {"kappa", "0", "-0", "1e-10", 1},
    {0}};
static const struct entry second[] = {{"mass", "0.015625 g", "2^-6", "0.0156", 0},
                                      {"c0", "0.5", "5 km/s", "0.52", 0},
                                      {"s", "1.5", "1.5", "1.25", 0},
                                      {"cp", "4e-6", "4e-6", "5e-6", 0},
                                      {0}};
static const struct entry third[] = {{"rho0", "8", "8", "8.25", 0},
                                     {"c0", "0.5", "0.5", "0.55", 0},
                                     {"s", "1.5", "1.5", "1.25", 0},
                                     {"cp", "4e-6", "4e-6", "5e-6", 0},
                                     {0}};
static const struct entry fourth[] = {{"rho0", "8", "8", "8.25", 0},
                                      {"c0", "0.5", "0.5", "0.55", 0},
                                      {"s", "1.5", "1.5", "1.25", 0},
                                      {"t0", "300 K", "3e2", "310", 1},
                                      {0}};
static const struct entry beta[] = {{"transition", "pressure", "pressure", NULL, 0},
                                    {"p_line", "0.25 Mbar", "25 GPa", "0.26", 0},
                                    {"t_line", "300", "300 K", "310", 0},
                                    {"dp_dt", "0", "0", "1e-5", 1},
                                    {"hysteresis_p", "0", "0 GPa", "0.01", 1},
                                    {"latent", "0", "0", "1e-4", 1},
                                    {"reversible", "yes", "yes", "no", 1},
                                    {"rho0", "8.5", "8500 kg/m3", "8.6", 0},
                                    {"c0", "0.5", "0.5", "0.53", 1},
                                    {"s", "1.5", "1.5", "1.4", 1},
                                    {"shear", "0.25", "0.25", "0.2", 1},
                                    {"yield", "2^-9", "2^-9", "0.001", 1},
                                    {"tensile", "2^-6", "2^-6", "0.01", 1},
                                    {"softening", "1", "1", "2", 1},
                                    {"tm", "1500", "1500", "1400", 1},
                                    {"cp", "2^-18", "2^-18", "5e-6", 1},
                                    {"kappa", "0", "0", "1e-10", 1},
                                    {0}};
static const struct entry liquid[] = {
    {"from", "beta", "beta", NULL, 0},       {"transition", "temperature", "temperature", NULL, 0},
    {"t_line", "1500", "1500 K", "1510", 0}, {"dt_dp", "0", "0", "100", 1},
    {"hysteresis_t", "50", "50 K", "60", 0}, {0}};
static const struct entry burn[] = {{"reactants", "tin lead", "tin, lead", NULL, 0},
                                    {"product", "ash", "ash", NULL, 0},
                                    {"kind", "stoichiometric", "stoichiometric", NULL, 1},
                                    {"masses", "1 1", "2/2 1", "1 2", 0},
                                    {"k0", "1", "1", "2", 0},
                                    {"ea", "0", "0", "1", 0},
                                    {"heat", "0.25 cm2/us2", "25 kJ/g", "0.5", 0},
                                    {"threshold", "0.01", "1/100", "0.02", 1},
                                    {0}};
static const struct entry all[] = {{"potential", "morse", "morse", NULL, 1},
                                   {"calibration", "uniaxial", "uniaxial", "bulk", 1},
                                   {"scope", "linked", "linked", NULL, 1},
                                   {"zeta", "0.125", "1/8", "0.25", 0},
                                   {"a_p", "0", "0", "0.1", 1},
                                   {"a_t", "0", "0", "1e-4", 1},
                                   {"ct_ratio", "0", "0", "0.01", 1},
                                   {"kt_ratio", "0.25", "1/4", "0.2", 0},
                                   {"mu", "0.5", "0.5", "0.4", 0},
                                   {"yield", "0.001953125", "2^-9", "0.002", 0},
                                   {"tensile", "0.015625", "2^-6", "0.01", 0},
                                   {"link_form", "0", "0", "0.9", 1},
                                   {"link_break", "1.05", "1.05", "1.1", 1},
                                   {"conductance", "1", "1", "0.5", 1},
                                   {0}};
static const struct entry pair[] = {
    {"k", "0.25 Mbar*cm", "0.25", "0.26", 0}, {"shape", "3", "3", "4", 0}, {0}};
static const struct entry pair_b[] = {
    {"k", "0.25 Mbar*cm", "0.25", "0.26", 0}, {"shape", "3", "3", "4", 0}, {0}};
static const struct entry pair_c[] = {
    {"k", "0.25 Mbar*cm", "0.25", "0.26", 0}, {"shape", "3", "3", "4", 0}, {0}};
static const struct entry pair_d[] = {
    {"k", "0.25 Mbar*cm", "0.25", "0.26", 0}, {"shape", "3", "3", "4", 0}, {0}};
static const struct entry far[] = {{"potential", "lennard-jones", "lennard-jones", NULL, 0},
                                   {"epsilon", "0.0009765625", "2^-10", "1e-3", 0},
                                   {"sigma", "0.035", "0.35 mm", "0.036", 0},
                                   {"cutoff", "0.0625", "0.625 mm", "0.06", 0},
                                   {"scope", "all", "all", NULL, 0},
                                   {0}};
static const struct entry inner[] = {{"linked", "no", "no", "yes", 0}, {0}};
static const struct entry crystal[] = {
    {"shape", "polygon 0 1, 1 1, 1 2, 0 2", "polygon 0 10 mm 1 1 1 2 0 2", "polygon 0 1, 1 1, 1 2, 0 1.5", 0},
    {"structure", "crystal", "crystal", NULL, 1},
    {"lattice", "square", "square", NULL, 0},
    {"spacing", "0.0625", "0.625 mm", "0.064", 0},
    {"row_spacing", "0.0625", "0.625 mm", "0.07", 1},
    {"origin", "0 0.03125", "-0, 2^-5", "0 0.03", 0},
    {"angle", "0", "0 deg", "30 deg", 1},
    {"radius", "0.03125", "2^-5", "0.03", 1},
    {"material", "tin", "tin", "lead", 0},
    {"missing_links", "0", "0", "0.1", 1},
    {"seed", "0", "0", "7", 1},
    {"motion", "free", "free", "driven", 1},
    {"velocity", "0 -0.0078125", "0, -0.78125e-2 cm/us", "0 -0.01", 0},
    {"jitter", "0", "0", "1e-4", 1},
    {"spin", "0", "-0", "0.5", 1},
    {"temperature", "300", "300 K", "77", 1},
    {0}};
static const struct entry mixed[] = {
    {"shape", "disc 3, 2, 0.5", "disc 30 mm, 2 cm, 0.5", "disc 3 2 0.6", 0},
    {"spacing", "0.0625", "0.0625", "0.07", 0},
    {"mix", "tin 0.25, lead 0.75", "tin 1/4 lead 3/4", "tin 0.5, lead 0.5", 0},
    {"structure", "polycrystal", "polycrystal", NULL, 0},
    {"grain_size", "0.25", "2.5 mm", "0.3", 0},
    {0}};
static const struct entry powder[] = {
    {"shape", "rectangle 4 1 5 2", "rectangle 40 mm, 1, 5, 2 cm", "rectangle 4 1 5 2.5", 0},
    {"spacing", "0.0625", "0.0625", "0.06", 0},
    {"material", "ash", "ash", "tin", 0},
    {"structure", "discs", "discs", NULL, 0},
    {"grain_size", "0.25", "2.5 mm", "0.3", 0},
    {"grain_spread", "0", "0", "0.1", 1},
    {"solid_fraction", "0.5", "1/2", "0.4", 0},
    {0}};
static const struct entry lid[] = {
    {"shape", "rectangle 4 2.75 5 3.25", "rectangle 40 mm 2.75 5 3.25", "rectangle 4 2.75 5 3", 0},
    {"spacing", "0.0625", "0.0625", "0.06", 0},
    {"material", "tin", "tin", "lead", 0},
    {"motion", "driven", "driven", NULL, 0},
    {0}};
static const struct entry push[] = {
    {"body", "lid", "lid", NULL, 0},
    {"velocity_x", "0 us 0 cm/us, 1 us 0.25 cm/us, 2 us 0", "0 0, 1000 ns 2.5 km/s, 2 -0", "0 0, 1 0.2, 2 0",
     0},
    {"velocity_y", "0 0, 2 0.125, 3 0", "0 0 2 1/8 3 0", "0 0, 2.5 0.125, 3 0", 0},
    {"spin", "0 0, 2 0.5, 3 0", "0 0 2 1/2 3 0", "0 0, 3 0", 0},
    {"repeat", "no", "no", "yes", 1},
    {0}};
static const struct entry heat[] = {{"body", "ball", "ball", "plate", 0},
                                    {"temperature", "0 300, 1 400", "0 ns 300 K 1 us 400", "0 300, 1 500", 0},
                                    {"acceleration_x", "0 0, 1 0.5", "0 0 1 1/2", "0 0, 1 0.25", 0},
                                    {"acceleration_y", "0 0, 1 0.5", "0 0 1 1/2", "0 0.125, 1 0.5", 0},
                                    {0}};
static const struct entry hole[] = {
    {"shape", "disc 1.75 1.75 1", "disc 17.5 mm, 1.75, 10 mm", "disc 1.75 1.75 1.1", 0},
    {"body", "plate", "plate", "ball", 0},
    {0}};
static const struct entry hole_b[] = {{"shape", "disc 3 2 0.125", "disc 3 2 0.125", "disc 3 2 0.1", 0}, {0}};
static const struct entry flaw[] = {
    {"line", "0 1.5 3 2", "0, 15 mm, 3, 2", "0 1.5 3.1 2", 0}, {"body", "plate", "plate", "ball", 0}, {0}};
static const struct entry probe[] = {{"region", "0 1 1 2", "0, 10 mm, 1, 2", "0 1 1 1.5", 0}, {0}};
static const struct entry press[] = {
    {"shape", "rectangle 3 3 4 3.5", "rectangle 30 mm 3 4 3.5", "rectangle 3 3 4 3.4", 0},
    {"spacing", "0.0625", "0.0625", "0.07", 0},
    {"material", "ash", "ash", "tin", 0},
    {"motion", "driven", "driven", NULL, 0},
    {0}};
static const struct entry side[] = {
    {"shape", "rectangle 4.25 3 5 3.5", "rectangle 42.5 mm 3 5 3.5", "rectangle 4.25 3 5 3.4", 0},
    {"spacing", "0.0625", "0.0625", "0.07", 0},
    {"material", "ash", "ash", "tin", 0},
    {"motion", "driven", "driven", NULL, 0},
    {0}};
static const struct entry force[] = {{"body", "press", "press", NULL, 0},
                                     {"force_y", "0 0, 1 0.25", "0 0, 1 1/4", "0 0, 1 0.5", 0},
                                     {"stress_xx", "0 0, 1 -0.25", "0 0, 1 -25 GPa", "0 0, 1 -0.5", 0},
                                     {"length", "2", "20 mm", "3", 0},
                                     {"zeta", "0.7", "7/10", "0.5", 1},
                                     {"max_velocity", "0.5", "5 km/s", "0.25", 0},
                                     {"mass", "1000", "1 kg", "2000", 0},
                                     {0}};
static const struct entry gap[] = {{"body", "side", "side", NULL, 0},
                                   {"stress_xx", "0 0, 1 -0.25", "0 0, 1 -25 GPa", "0 0, 1 -0.5", 0},
                                   {"between", "lid press", "lid, press", "press lid", 0},
                                   {0}};
static const struct entry pull[] = {
    {"body", "side", "side", NULL, 0}, {"force_y", "0 0, 1 0.25", "0 0, 1 1/4", "0 0, 1 0.5", 0}, {0}};
static const struct entry felt[] = {
    {"body", "lid", "lid", "plate", 0}, {"report", "force, position", "position, force", "force", 0}, {0}};
static const struct entry rest[] = {
    {"unbalanced", "0.0001", "1e-4", "0.001", 0},
    {"kinetic", "0.25", "1/4", "0.5", 0},
    {"probe", "face vx above 0.5", "face vx above 1/2", "face vx below 0.5", 0},
    {"after", "1", "1 us", "2", 0},
    {0}};
static const struct entry profile[] = {{"axis", "x", "x", "y", 0},
                                       {"bins", "10", "10", "11", 0},
                                       {"range", "0 1", "0, 10 mm", "0 2", 0},
                                       {"every", "10", "10", "20", 1},
                                       {0}};
static const struct entry output[] = {{"history_every", "150", "150", "5", 1},
                                      {"snapshot_every", "0", "0", "10", 1},
                                      {"snapshot_at", "3 1 7", "7, 3, 1", "3 1", 0},
                                      {"checkpoint_every", "0", "0", "10", 1},
                                      {"format", "vtp", "vtp", "vtp xyz", 1},
                                      {"fields", "id velocity", "velocity, id", "id", 0},
                                      {"bodies", "plate", "plate", "ball", 0},
                                      {"strain", "no", "no", "yes", 1},
                                      {0}};
/* Blocks of one word keep their order where it numbers something; the two voids may be exchanged. */
static const struct block solid[] = {{"domain", "", domain},
                                     {"time", "", steps},
                                     {"material", "tin", first},
                                     {"material", "lead", second},
                                     {"material", "ash", third},
                                     {"material", "iron", fourth},
                                     {"phase", "tin beta", beta},
                                     {"phase", "tin liquid", liquid},
                                     {"reaction", "burn", burn},
                                     {"interaction", "", all},
                                     {"interaction", "tin lead", pair},
                                     {"interaction", "lead lead", pair_b},
                                     {"interaction", "lead ash", pair_c},
                                     {"interaction", "lead iron", pair_d},
                                     {"interaction", "ash ash", far},
                                     {"interface", "grain", inner},
                                     {"body", "plate", crystal},
                                     {"body", "ball", mixed},
                                     {"body", "powder", powder},
                                     {"body", "lid", lid},
                                     {"load", "push", push},
                                     {"load", "heat", heat},
                                     {"body", "press", press},
                                     {"body", "side", side},
                                     {"load", "force", force},
                                     {"load", "gap", gap},
                                     {"load", "pull", pull},
                                     {"void", "hole", hole},
                                     {"void", "bubble", hole_b},
                                     {"flaw", "slit", flaw},
                                     {"probe", "face", probe},
                                     {"probe", "lift", felt},
                                     {"stop", "", rest},
                                     {"profile", "across", profile},
                                     {"output", "", output}};
/* A deck of walls and loads. */
static const struct entry open_domain[] = {{"size", "6 cm, 4 cm", "60 mm 4", NULL, 0},
                                           {"boundary", "free free", "free free", NULL, 0},
                                           {"r_c", "0.125 cm", "1.25 mm", NULL, 0},
                                           {"delta_r", "0.0125 cm", "0.125 mm", NULL, 0},
                                           {0}};
static const struct entry heavy[] = {{"mass", "0.5", "1/2", "0.25", 0}, {0}};
static const struct entry light[] = {{"mass", "0.5", "1/2", "0.25", 0}, {0}};
static const struct entry springs[] = {
    {"potential", "quadratic", "quadratic", NULL, 0}, {"k", "1", "1", "2", 0}, {0}};
static const struct entry ram[] = {
    {"shape", "rectangle 1 1 2 1.5", "rectangle 10 mm 1 2 1.5", "rectangle 1 1 2 1.25", 0},
    {"spacing", "0.0625", "0.0625", "0.07", 0},
    {"material", "tin", "tin", "lead", 0},
    {"motion", "driven", "driven", NULL, 0},
    {0}};
static const struct entry sheet[] = {{"line", "0 1 2 1, 2 3", "0 10 mm 2 1 2 3", "0 1, 2 1.5, 2 3", 0},
                                     {"material", "tin", "tin", "lead", 0},
                                     {"rigid", "no", "no", NULL, 1},
                                     {"velocity", "0 0.5", "-0 5 km/s", "0 0.25", 0},
                                     {"spin", "0", "-0", "0.5", 1},
                                     {"temperature", "300", "300 K", "310", 0},
                                     {0}};
static const struct entry drum[] = {{"circle", "3 2 1.5", "30 mm 2 1.5", "3 2 1.25", 0},
                                    {"rigid", "yes", "yes", NULL, 0},
                                    {"temperature", "0", "0 K", "1", 0},
                                    {0}};
static const struct entry turn[] = {{"body", "drum", "drum", NULL, 0},
                                    {"spin", "0 0, 2 0.5", "0 0 2 1/2", "0 0, 3 0.5", 0},
                                    {"velocity_x", "0 0, 1 0.5", "0 0 1 1/2", "0 0, 1 0.25", 0},
                                    {0}};
static const struct entry squeeze[] = {{"body", "ram", "ram", NULL, 0},
                                       {"force_x", "0 0, 1 0.25", "0 0, 1 1/4", "0 0, 1 0.5", 0},
                                       {"stress_yy", "0 0, 1 -0.25", "0 0, 1 -25 GPa", "0 0, 1 -0.5", 0},
                                       {0}};
static const struct block walled[] = {{"domain", "", open_domain},  {"time", "", steps},
                                      {"material", "tin", heavy},   {"material", "lead", light},
                                      {"interaction", "", springs}, {"body", "ram", ram},
                                      {"load", "squeeze", squeeze}, {"load", "turn", turn},
                                      {"wall", "sheet", sheet},     {"wall", "drum", drum}};
static const struct deck {
    const struct block *blocks;
    size_t n;
} decks[] = {{solid, sizeof solid / sizeof solid[0]}, {walled, sizeof walled / sizeof walled[0]}};
enum { DECKS = sizeof decks / sizeof decks[0], BLOCKS_MOST = sizeof solid / sizeof solid[0] };

/* --- writing decks --- */

enum { TEXT_MOST = 1 << 16 };

static uint32_t drawn = 1;

static uint32_t draw(uint32_t below)
{
    drawn = drawn * 1664525u + 1013904223u;
    return (drawn >> 8) % below;
}

static void add(char *text, const char *more)
{
    size_t n = strlen(text);
    CHECK(n + strlen(more) < TEXT_MOST);
    memcpy(text + n, more, strlen(more) + 1);
}

static size_t count_entries(const struct block *b)
{
    size_t n = 0;
    while (b->entries[n].key != NULL)
        n++;
    return n;
}

/* Writes a block; with `random` in another way. `changed` gets its other value, where it is not NULL. */
static void add_block(char *text, const struct block *b, bool random, const struct entry *changed)
{
    size_t n = count_entries(b), first_entry = random ? draw((uint32_t)n) : 0;
    const char *end = random && draw(2) == 0 ? " # a comment\r\n" : "\n";
    add(text, b->word);
    add(text, " ");
    add(text, b->names);
    add(text, " {");
    add(text, end);
    for (size_t k = 0; k < n; k++) {
        const struct entry *e = &b->entries[(first_entry + k) % n];
        if (e->initial && e != changed && random && draw(2) == 0)
            continue;
        add(text, "  ");
        add(text, e->key);
        add(text, random && draw(2) == 0 ? "=" : " = ");
        add(text, e == changed ? e->other : random && draw(2) == 0 ? e->two : e->one);
        add(text, random && draw(3) == 0 ? ";" : end);
    }
    add(text, "}");
    add(text, end);
}

static void write_deck(char *text, const struct deck *deck, bool random, const struct entry *changed)
{
    size_t order[BLOCKS_MOST];
    for (size_t k = 0; k < deck->n; k++)
        order[k] = k;
    for (int swap = 0; swap < 200 && random; swap++) { /* of neighbours of other words, and of voids */
        size_t k = draw((uint32_t)deck->n - 1), a = order[k], b = order[k + 1];
        const char *word = deck->blocks[a].word;
        bool numbered = strcmp(word, deck->blocks[b].word) == 0 && strcmp(word, "void") != 0 &&
                        strcmp(word, "interaction") != 0;
        order[k] = numbered ? a : b;
        order[k + 1] = numbered ? b : a;
    }
    text[0] = '\0';
    for (size_t k = 0; k < deck->n; k++)
        add_block(text, &deck->blocks[order[k]], random, changed);
}

/* --- tests --- */

/* Is a keyword of a block of this word in the text? */
static bool has_keyword(const char *text, const char *word, const char *key)
{
    char line[100];
    size_t n = strlen(word);
    (void)snprintf(line, sizeof line, ": %s ", key);
    for (const char *at = text; (at = strstr(at, line)) != NULL; at++) {
        const char *begin = at;
        while (begin > text && begin[-1] != '\n')
            begin--;
        if (strncmp(begin, word, n) == 0 && (begin[n] == ' ' || begin[n] == ':'))
            return true;
    }
    return false;
}

/* The decks of this file give every keyword of the schema but the table's file, whose values are points, and
 * those of a run that begins from a state (test_start.c); every keyword is in the text of its part alone. */
TEST(every_keyword_has_a_part)
{
    char *text = malloc(TEXT_MOST);
    struct deck_meaning parts[DECKS][PART_COUNT];
    for (int d = 0; d < DECKS; d++) {
        write_deck(text, &decks[d], false, NULL);
        for (int part = 0; part < PART_COUNT; part++)
            parts[d][part] = meaning_of(text, 1u << part);
    }
    for (int kind = 0; kind < BLOCK_COUNT; kind++) {
        const struct block_schema *schema = schema_block((enum block_kind)kind);
        for (size_t k = 0; k < schema->n_keys && kind != BLOCK_INTERFACE && kind != BLOCK_START; k++) {
            const struct deck_key *key = &schema->keys[k];
            if (kind == BLOCK_BODY && strcmp(key->name, "from") == 0)
                continue;
            const char *word =
                kind == BLOCK_INTERACTION && strcmp(key->name, "linked") == 0 ? "interface" : schema->name;
            CHECK(key->part >= PART_MEANING && key->part < PART_COUNT);
            for (int part = 0; part < PART_COUNT && key->type != VALUE_FILE; part++) {
                bool there = has_keyword(parts[0][part].text, word, key->name) ||
                             has_keyword(parts[1][part].text, word, key->name);
                CHECK_REPORT(there == (part == (int)key->part),
                             "part %d and `%s` of %s: the decks of this test give every keyword", part,
                             key->name, schema->name);
            }
        }
    }
    for (int d = 0; d < DECKS; d++)
        for (int part = 0; part < PART_COUNT; part++)
            meaning_free(&parts[d][part]);
    free(text);
}

TEST(a_deck_written_in_another_way)
{
    char *text = malloc(TEXT_MOST), difference[MEANING_DIFFERENCE];
    for (int d = 0; d < DECKS; d++) {
        write_deck(text, &decks[d], false, NULL);
        struct deck_meaning want = meaning_of(text, PARTS_ALL);
        for (int k = 0; k < 200; k++) {
            write_deck(text, &decks[d], true, NULL);
            struct deck_meaning got = meaning_of(text, PARTS_ALL);
            bool differs = meaning_difference(want.text, want.length, got.text, got.length, difference);
            CHECK_REPORT(!differs, "%s\n%s", difference, text);
            CHECK_EQ_INT(memcmp(got.digest, want.digest, sizeof got.digest), 0);
            meaning_free(&got);
        }
        meaning_free(&want);
    }
    free(text);
}

/* The part of a keyword of a block. */
static enum deck_part part_of(const struct block *b, const struct entry *e)
{
    const struct block_schema *schema = schema_block(schema_find_block(b->word, strlen(b->word)));
    int key = schema_find_key(schema, e->key, strlen(e->key));
    CHECK_REPORT(key >= 0, "%s", e->key);
    return key < 0 ? PART_MEANING : schema->keys[key].part;
}

/* The deck with one value changed differs from `want`, its whole meaning, in this keyword, and from `states`,
 * what a state compares, where the keyword is part of it. */
static void check_changed(const struct deck *deck, const struct block *block, const struct entry *e,
                          const struct deck_meaning *want, const struct deck_meaning *states)
{
    char *text = malloc(TEXT_MOST), difference[MEANING_DIFFERENCE], begin[120];
    write_deck(text, deck, true, e);
    struct deck_meaning got = meaning_of(text, PARTS_ALL), state = meaning_of(text, 1u << PART_MEANING);
    bool differs = meaning_difference(want->text, want->length, got.text, got.length, difference);
    (void)snprintf(begin, sizeof begin, "`%s` of %s%s%s was ", e->key, block->word,
                   block->names[0] == '\0' ? "" : " ", block->names);
    CHECK_REPORT(differs && strncmp(difference, begin, strlen(begin)) == 0, "%s%s", begin,
                 differs ? difference : "the same");
    CHECK_EQ_INT(memcmp(state.digest, states->digest, sizeof state.digest) != 0,
                 part_of(block, e) == PART_MEANING);
    meaning_free(&got);
    meaning_free(&state);
    free(text);
}

TEST(each_keyword_changed_alone)
{
    char *text = malloc(TEXT_MOST);
    for (int d = 0; d < DECKS; d++) {
        write_deck(text, &decks[d], false, NULL);
        struct deck_meaning want = meaning_of(text, PARTS_ALL), state = meaning_of(text, 1u << PART_MEANING);
        for (size_t b = 0; b < decks[d].n; b++)
            for (const struct entry *e = decks[d].blocks[b].entries; e->key != NULL; e++)
                if (e->other != NULL)
                    check_changed(&decks[d], &decks[d].blocks[b], e, &want, &state);
        meaning_free(&want);
        meaning_free(&state);
    }
    free(text);
}

TEST(every_keyword_reads_back)
{
    char *text = malloc(TEXT_MOST);
    for (int d = 0; d < DECKS; d++) {
        write_deck(text, &decks[d], false, NULL);
        struct loaded l = load_text(text, NULL, -1);
        CHECK_EQ_INT(l.status, DM2_OK);
        if (l.status == DM2_OK)
            check_reads_back(&l.config, d == 0 ? "the solids" : "the walls");
        loaded_free(&l);
    }
    free(text);
}

TEST_MAIN(CASE(every_keyword_has_a_part), CASE(a_deck_written_in_another_way),
          CASE(each_keyword_changed_alone), CASE(every_keyword_reads_back))

/* The text of a meaning: the decks of input read back from it, what is no meaning is refused, and what the
 * difference of two texts says. */
#include "check.h"
#include "meaning_help.h"

TEST(a_meaning_reads_back)
{
    static const char *const decks[] = {"brazilian",      "cantilever",    "collision",    "cu-polycrystal",
                                        "granular-shear", "heat-rod",      "hmx-powder",   "lj-lattice",
                                        "notched-plate",  "phase-front",   "plate-impact", "shear-band",
                                        "shear-box",      "sliding-block", "spall",        "timing"};
    enter_source_tree();
    for (size_t k = 0; k < sizeof decks / sizeof decks[0]; k++) {
        char path[60];
        (void)snprintf(path, sizeof path, "input/%s.dm2", decks[k]);
        struct loaded l = load_path(path, NULL, -1);
        CHECK_EQ_INT(l.status, DM2_OK);
        if (l.status == DM2_OK)
            check_reads_back(&l.config, path);
        loaded_free(&l);
    }
}

TEST(no_meaning)
{
    static const char *const texts[] = {"",
                                        "domain",
                                        "domain: size 1 2\n",
                                        "domain: size\n",
                                        ": size 1 2\n",
                                        "body a: include \"x\"\n",
                                        "domain: size 1 2"};
    for (size_t k = 0; k < sizeof texts / sizeof texts[0]; k++) {
        struct config read;
        struct dm2_error err = {0};
        CHECK_EQ_INT(meaning_load(texts[k], strlen(texts[k]), &read, &err), DM2_PROTOCOL);
        CHECK_CONTAINS(err.text, "the text of the state is no meaning of a deck: ");
    }
}

static void check_difference(const char *was, const char *is, const char *want)
{
    char got[MEANING_DIFFERENCE] = "";
    CHECK_EQ_INT(meaning_difference(was, strlen(was), is, strlen(is), got), *want != '\0');
    CHECK_STR(got, want);
}

TEST(what_a_difference_says)
{
    check_difference("body lid: velocity 0 -0.01\n", "body lid: velocity 0 -0.01\n", "");
    check_difference("body lid: velocity 0 -0.01\n", "body lid: velocity 0 -0.02\n",
                     "`velocity` of body lid was 0 -0.01, is 0 -0.02 cm/us");
    check_difference("body lid: jitter 0\n", "body lid: jitter 0\nbody lid: grain_size 0.1\n",
                     "`grain_size` of body lid was not given, is 0.1 cm");
    check_difference("body lid: grain_size 0.1\nbody lid: jitter 0\n", "body lid: jitter 0\n",
                     "`grain_size` of body lid was 0.1 cm, is not given");
    check_difference("body lid: jitter 0\n", "body lid: jitter 0\nbody plug: jitter 0\n",
                     "`body plug` is there, and was not");
    check_difference("body lid: jitter 0\nbody plug: jitter 0\n", "body lid: jitter 0\n",
                     "`body plug` was there, and is not");
    check_difference("body lid: jitter 0\nbody base: jitter 0\n", "body base: jitter 0\nbody lid: jitter 0\n",
                     "blocks `body` were lid, base, are base, lid: their order numbers them");
    check_difference("", "domain: size 1 2\n", "`domain` is there, and was not");
    check_difference("\n\n: :\n", "x", "`` was there, and is not");
    check_difference("body \033lid: jitter 0\n", "", "`body ?lid` was there, and is not");
}

TEST_MAIN(CASE(a_meaning_reads_back), CASE(no_meaning), CASE(what_a_difference_says))

/* Command lines and hosts files. */
#include "check.h"

#include <stdbool.h>
#include <stdint.h>

#include "dm2/cluster/hosts.h"
#include "dm2/cluster/messages.h"
#include "app/options.h"

static bool quiet, verbose;
static const char *output;
static int64_t steps;
static double timeout;
static struct option_list defines, operands;
static struct dm2_error err;

/* Parses a command line of up to 8 words after the program's name. */
static enum dm2_status parse(const char *a, const char *b, const char *c, const char *d)
{
    const struct option table[] = {
        {"quiet", 'q', OPTION_FLAG, &quiet, NULL, "", 0, 0},
        {"verbose", 'v', OPTION_FLAG, &verbose, NULL, "", 0, 0},
        {"output", 'o', OPTION_TEXT, &output, "DIR", "", 0, 0},
        {"steps", 0, OPTION_INTEGER, &steps, "K", "", 0, 100},
        {"timeout", 0, OPTION_SECONDS, &timeout, "S", "", 0, 0},
        {"define", 'D', OPTION_LIST, &defines, "NAME=VALUE", "", 0, 0},
    };
    const char *words[] = {"program", a, b, c, d};
    int argc = 1;
    while (argc < 5 && words[argc] != NULL)
        argc++;
    quiet = verbose = false;
    output = NULL;
    steps = -1;
    timeout = 0;
    option_list_free(&defines);
    option_list_free(&operands);
    err = (struct dm2_error){0};
    return options_parse(table, 6, argc, (char **)(uintptr_t)words, &operands, &err);
}

TEST(every_spelling)
{
    CHECK_EQ_INT(parse("--output", "here", "--steps=7", "deck"), DM2_OK);
    CHECK_STR(output, "here");
    CHECK_EQ_INT(steps, 7);
    CHECK_EQ_INT(operands.n, 1);
    CHECK_STR(operands.items[0], "deck");
    CHECK_EQ_INT(parse("deck", "-qv", "-ohere", "--timeout=0.5"), DM2_OK);
    CHECK(quiet && verbose);
    CHECK_STR(output, "here");
    CHECK_NEAR(timeout, 0.5, 0);
    CHECK_EQ_INT(parse("-qo", "there", "-Dn=1", "--define=m=2"), DM2_OK);
    CHECK(quiet && !verbose);
    CHECK_STR(output, "there");
    CHECK_EQ_INT(defines.n, 2);
    CHECK_STR(defines.items[1], "m=2");
    CHECK_EQ_INT(parse("--", "-q", "-", NULL), DM2_OK);
    CHECK_EQ_INT(operands.n, 2);
    CHECK(!quiet);
}

TEST(mistakes)
{
    CHECK_EQ_INT(parse("--outptu", "x", NULL, NULL), DM2_USAGE);
    CHECK_CONTAINS(err.text, "--outptu is not known");
    CHECK_CONTAINS(err.text, "'output'");
    CHECK_EQ_INT(parse("-x", NULL, NULL, NULL), DM2_USAGE);
    CHECK_CONTAINS(err.text, "-x is not known");
    CHECK_EQ_INT(parse("--steps", NULL, NULL, NULL), DM2_USAGE);
    CHECK_CONTAINS(err.text, "--steps needs a value: K");
    CHECK_EQ_INT(parse("--steps", "7x", NULL, NULL), DM2_USAGE);
    CHECK_CONTAINS(err.text, "from 0 to 100");
    CHECK_EQ_INT(parse("--steps", "-1", NULL, NULL), DM2_USAGE);
    CHECK_EQ_INT(parse("--steps=101", NULL, NULL, NULL), DM2_USAGE);
    CHECK_EQ_INT(parse("--steps=", NULL, NULL, NULL), DM2_USAGE);
    CHECK_EQ_INT(parse("--timeout=0", NULL, NULL, NULL), DM2_USAGE);
    CHECK_EQ_INT(parse("--timeout=nan", NULL, NULL, NULL), DM2_USAGE);
    CHECK_EQ_INT(parse("--quiet=yes", NULL, NULL, NULL), DM2_USAGE);
    CHECK_CONTAINS(err.text, "takes no value");
    CHECK_EQ_INT(parse("-o", NULL, NULL, NULL), DM2_USAGE);
    option_list_free(&defines);
    option_list_free(&operands);
}

TEST(a_hosts_file)
{
    struct endpoints list = {0};
    CHECK_EQ_INT(hosts_parse("h",
                             "# the cluster\n"
                             "alpha\n"
                             "  beta:5000 slots=3 # three\r\n"
                             "\n"
                             "[fe80::1]:6000\n"
                             "::1\n"
                             "10.0.0.7:1",
                             &list, &err),
                 DM2_OK);
    CHECK_EQ_INT(list.n, 7);
    CHECK_STR(list.items[0].host, "alpha");
    CHECK_EQ_INT(list.items[0].port, DEFAULT_PORT);
    CHECK_STR(list.items[3].host, "beta");
    CHECK_EQ_INT(list.items[3].port, 5002);
    CHECK_STR(list.items[4].host, "fe80::1");
    CHECK_EQ_INT(list.items[4].port, 6000);
    CHECK_STR(list.items[5].host, "::1");
    CHECK_EQ_INT(list.items[6].port, 1);
    endpoints_free(&list);
}

static void bad_hosts(const char *text, const char *part)
{
    struct endpoints list = {0};
    CHECK_EQ_INT(hosts_parse("h", text, &list, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, part);
    endpoints_free(&list);
}

TEST(mistakes_in_a_hosts_file)
{
    bad_hosts("alpha\nbeta:x\n", "h:2: 'beta:x': the port");
    bad_hosts("alpha:0\n", "h:1:");
    bad_hosts("alpha:65536\n", "h:1:");
    bad_hosts("alpha:\n", "h:1:");
    bad_hosts(":5000\n", "empty");
    bad_hosts("[::1\n", "not closed");
    bad_hosts("[::1]x\n", "only :port");
    bad_hosts("\n\nalpha slot=3\n", "h:3: 'slot=3' is not known");
    bad_hosts("alpha slots=0\n", "h:1: 'slots=0'");
    bad_hosts("alpha slots=two\n", "slots");
    bad_hosts("alpha:65535 slots=2\n", "65535");
    bad_hosts("# nothing\n", "names no host");
    bad_hosts("", "names no host");
}

TEST(a_server_on_the_command_line)
{
    struct endpoints list = {0};
    CHECK_EQ_INT(hosts_parse_server("localhost", &list, &err), DM2_OK);
    CHECK_EQ_INT(hosts_parse_server("localhost:99", &list, &err), DM2_OK);
    CHECK_EQ_INT(list.n, 2);
    CHECK_EQ_INT(list.items[1].port, 99);
    CHECK_EQ_INT(hosts_parse_server("localhost:99x", &list, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "localhost:99x");
    endpoints_free(&list);
}

TEST_MAIN(CASE(every_spelling), CASE(mistakes), CASE(a_hosts_file), CASE(mistakes_in_a_hosts_file),
          CASE(a_server_on_the_command_line))

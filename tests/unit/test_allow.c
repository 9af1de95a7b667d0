/* --allow: networks to the bit, both address families, and texts that are no network. */
#include "check.h"

#include "dm2/net/allow.h"

static bool admits(const char *network, const char *address)
{
    struct allow_list list = {0};
    CHECK_EQ_INT(allow_add(&list, network, NULL), DM2_OK);
    return allow_address(&list, address);
}

TEST(networks_to_the_bit)
{
    static const struct {
        const char *network, *inside, *outside;
    } cases[] = {
        {"10.0.0.0/8", "10.255.255.255", "11.0.0.0"},
        {"192.168.7.128/25", "192.168.7.128", "192.168.7.127"},
        {"192.168.7.128/25", "192.168.7.255", "192.168.8.128"},
        {"172.16.0.0/12", "172.31.255.255", "172.32.0.0"},
        {"10.1.2.3", "10.1.2.3", "10.1.2.2"},
        {"10.1.2.2/31", "10.1.2.3", "10.1.2.4"},
        {"0.0.0.0/0", "255.1.2.3", "fd00::1"},
        {"10.0.0.0/8", "::ffff:10.1.2.3", "::10.1.2.3"}, /* IPv4 at a socket for both */
        {"fd00::/8", "fdff::1", "fe00::1"},
        {"2001:db8::8000/113", "2001:db8::ffff", "2001:db8::7fff"},
        {"::1", "::1", "::2"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        CHECK_REPORT(admits(cases[k].network, cases[k].inside), "%s does not admit %s", cases[k].network,
                     cases[k].inside);
        CHECK_REPORT(!admits(cases[k].network, cases[k].outside), "%s admits %s", cases[k].network,
                     cases[k].outside);
    }
    CHECK(!admits("::/0", "no address"));
}

TEST(several_networks_and_none)
{
    struct allow_list list = {0};
    CHECK(allow_address(&list, "1.2.3.4")); /* an empty list admits every address */
    CHECK_EQ_INT(allow_add(&list, "10.0.0.0/8", NULL), DM2_OK);
    CHECK_EQ_INT(allow_add(&list, "fd00::/8", NULL), DM2_OK);
    CHECK(allow_address(&list, "10.1.1.1"));
    CHECK(allow_address(&list, "fd12::1"));
    CHECK(!allow_address(&list, "1.2.3.4"));
    while (list.n < ALLOW_MOST)
        CHECK_EQ_INT(allow_add(&list, "10.0.0.0/8", NULL), DM2_OK);
    CHECK_EQ_INT(allow_add(&list, "10.0.0.0/8", NULL), DM2_USAGE);
}

TEST(what_is_no_network)
{
    static const char *const wrong[] = {
        "",
        "ten",
        "10",
        "10.0.0.0/",
        "10.0.0.0/33",
        "10.0.0.0/-1",
        "10.0.0.0/8x",
        "10.0.0.0/ 8",
        "10.0.0.1/8",
        "fd00::/129",
        "fd00::1/8",
        "1.2.3.4.5",
        "/8",
        "host.name/24",
        "10.0.0.0/99999999999999999999",
        "1111:2222:3333:4444:5555:6666:7777:8888:9999:aaaa:bbbb:cccc:dddd:eeee:ffff/8"};
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        struct allow_list list = {0};
        struct dm2_error err = {0};
        CHECK_REPORT(allow_add(&list, wrong[k], &err) == DM2_USAGE, "'%s' is taken", wrong[k]);
        CHECK_CONTAINS(err.text, "--allow");
        CHECK_EQ_INT(list.n, 0);
    }
}

TEST_MAIN(CASE(networks_to_the_bit), CASE(several_networks_and_none), CASE(what_is_no_network))

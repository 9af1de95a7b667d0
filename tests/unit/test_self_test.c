/* The fingerprint of the release: this build's, and renewed where results changed. */
#include "check.h"

#include "dm2/engine/self_test.h"

/* Where the constant is out of date, `make fingerprint` renews it (docs/contributing.md). */
TEST(the_constant_is_that_of_the_sources)
{
    uint64_t found = 0;
    struct dm2_error err = {0};
    CHECK_EQ_INT(self_test_compute(&found, &err), DM2_OK);
    CHECK_STR(err.text, "");
    CHECK_EQ_INT(found, SELF_TEST_FINGERPRINT);
    CHECK_EQ_INT(self_test_check(&err), DM2_OK);
}

TEST_MAIN(CASE(the_constant_is_that_of_the_sources))

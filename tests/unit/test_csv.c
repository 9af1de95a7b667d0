/* Tables: quoting, line ends, strict shapes, columns by name. */
#include "check.h"

#include "dm2/base/csv.h"

static enum dm2_status parse(const char *text, struct csv *csv, struct dm2_error *err)
{
    return csv_parse("t.csv", text, strlen(text), csv, err);
}

TEST(fields)
{
    struct csv csv;
    struct dm2_error err;
    CHECK_EQ_INT(parse("step,time [us],\"a \"\"b\"\", c\"\r\n0,1.5,x\r\n1,,\"two\nlines\"\n2,3,", &csv, &err),
                 DM2_OK);
    CHECK_EQ_INT(csv.n_columns, 3);
    CHECK_EQ_INT(csv.n_rows, 3);
    CHECK_STR(csv_heading(&csv, 1), "time [us]");
    CHECK_STR(csv_heading(&csv, 2), "a \"b\", c");
    CHECK_STR(csv_field(&csv, 0, 2), "x");
    CHECK_STR(csv_field(&csv, 1, 1), "");
    CHECK_STR(csv_field(&csv, 1, 2), "two\nlines");
    CHECK_STR(csv_field(&csv, 2, 2), "");
    CHECK_EQ_INT(csv.lines[2], 5);
    csv_free(&csv);
}

TEST(columns_by_name)
{
    struct csv csv;
    struct dm2_error err;
    size_t column = 9;
    double *values;
    CHECK_EQ_INT(parse("t,time [us],time2\n1,2,a\n3,4.5,b\n", &csv, &err), DM2_OK);
    CHECK_EQ_INT(csv_column(&csv, "time", &column, &err), DM2_OK);
    CHECK_EQ_INT(column, 1);
    CHECK_EQ_INT(csv_numbers(&csv, column, &values, &err), DM2_OK);
    CHECK_SAME_BITS(values[1], 4.5);
    free(values);
    CHECK_EQ_INT(csv_column(&csv, "tim", &column, &err), DM2_USAGE);
    CHECK_CONTAINS(err.text, "has no column 'tim'; it has: t, time [us], time2");
    CHECK_EQ_INT(csv_numbers(&csv, 2, &values, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "t.csv:2: 'a' in column 'time2' is not a number");
    csv_free(&csv);
}

TEST(malformed)
{
    static const char *const cases[][2] = {
        {"", "is empty"},
        {"a,b\n1\n", "t.csv:2: the row has 1 fields, the header has 2"},
        {"a,b\n1,2\n1,2,3\n", "t.csv:3: the row has 3 fields"},
        {"a\n\"x\n", "not closed"},
        {"a,b\n\"x\"y,1\n", "t.csv:2: a comma was expected"},
        {"a,b\n\n1,2\n", "t.csv:2: the row has 1 fields"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct csv csv;
        struct dm2_error err = {0};
        CHECK_EQ_INT(parse(cases[i][0], &csv, &err), DM2_PROTOCOL);
        CHECK_CONTAINS(err.text, cases[i][1]);
        CHECK(csv.fields == NULL && csv.text == NULL);
    }
    struct csv csv;
    struct dm2_error err;
    CHECK_EQ_INT(csv_parse("t.csv", "a\0b\n", 4, &csv, &err), DM2_PROTOCOL);
    CHECK_CONTAINS(err.text, "NUL byte");
    CHECK_EQ_INT(csv_read("no/such/file.csv", &csv, &err), DM2_IO);
    CHECK_CONTAINS(err.text, "no/such/file.csv: cannot open: No such file");
}

TEST(quoting)
{
    char out[32];
    CHECK_EQ_INT(csv_quote("plain [us]", out, sizeof out), 10);
    CHECK_STR(out, "plain [us]");
    CHECK_EQ_INT(csv_quote("a,\"b\"", out, sizeof out), 9);
    CHECK_STR(out, "\"a,\"\"b\"\"\"");
    CHECK_EQ_INT(csv_quote("abcdef", out, 4), 6);
    CHECK_STR(out, "abc");
}

TEST_MAIN(CASE(fields), CASE(columns_by_name), CASE(malformed), CASE(quoting))

/* Expressions as in decks: each test puts expressions into a small deck and compares the loaded value. */
#include "check.h"
#include "deck_help.h"

static const char deck_rest[] = "time { dt = 1; steps = 1 }\nmaterial M { rho0 = 1; c0 = 1; s = 1 }\n"
                                "body b { shape = rectangle 0 0 1 1; spacing = 0.1; material = M }\n";

/* The value of an expression: 1e6 plus the x of `origin`, which is -1e6 plus the expression, in a deck with
 * these lets; NaN where the deck does not load. The domain is so large that the body is inside for every
 * value. */
static double value(const char *lets, const char *expression)
{
    char text[2000];
    (void)snprintf(text, sizeof text,
                   "%s\ndomain { size = 2e6 9; r_c = 1; delta_r = 1; origin = -1e6 + (%s), 0 }\n%s", lets,
                   expression, deck_rest);
    struct loaded l = load_text(text, NULL, -1);
    double x = l.status == DM2_OK ? l.config.origin[0] + 1e6 : (double)NAN;
    if (l.status != DM2_OK)
        printf("%s", l.report.text);
    loaded_free(&l);
    return x;
}

static void check_value(const char *lets, const char *expression, double want)
{
    double got = value(lets, expression);
    /* The added 1e6 costs the last digits. */
    CHECK_REPORT(fabs(got - want) < 1e-9, "'%s' is %.17g, expected %.17g", expression, got, want);
}

TEST(operators_and_precedence)
{
    check_value("", "1 + 2*3", 7);
    check_value("", "(1 + 2)*3", 9);
    check_value("", "7 - 2 - 1", 4);
    check_value("", "16/4/2", 2);
    check_value("", "2^3^2", 512);
    check_value("", "-2^2", -4);
    check_value("", "2^-1", 0.5);
    check_value("", "2 - -3", 5);
    check_value("", "--2", 2);
    check_value("", "6/-3", -2);
    check_value("", "0.5^10 * 1024", 1);
}

TEST(functions)
{
    check_value("", "sqrt(16) + sqrt (9)", 7);
    check_value("", "abs(-3) + abs(3)", 6);
    check_value("", "min(3, 1, 2) + max(1, 5, 4)", 6);
    check_value("", "floor(-1.5)", -2);
    check_value("", "ceil(-1.5)", -1);
    check_value("", "round(2.5) + round(-2.5) + round(1.4)", 1);
    check_value("", "min(\n 4,\n 2\n)", 2);
}

TEST(units_in_expressions)
{
    check_value("", "1/2 cm * (1 cm)", 0.5);
    check_value("", "(2 + 1) m/cm", 300);
    check_value("", "3 m2/cm^2", 30000);
    check_value("", "sqrt(4 m2)/cm", 200);
    check_value("", "10 J/(2 g)*us^2/cm2", 5e-5);
    check_value("let w = 3 cm", "w*m/cm^2", 300);
    check_value("let w = 3 cm\nlet v = 400 m/s", "w/v/us", 75);
    check_value("", "90 deg/(pi/2)", 1);
    check_value("", "max(1 m, 20 cm)/cm", 100);
}

TEST(lets_in_any_order)
{
    check_value("let a = b + c\nlet c = 2*b\nlet b = 3", "a", 9);
    check_value("let a=1; let b = a + 1", "b", 2);
}

/* The division of a list into values, by a keyword that takes two. */
TEST(lists)
{
    static const struct {
        const char *text;
        double x, y;
    } cases[] = {
        {"-5 -2", -5, -2},         {"-5, -0.2", -5, -0.2},       {"-7 - 1 -0.5", -8, -0.5},
        {"-7-1 -0.5", -8, -0.5},   {"(-7) (-0.5)", -7, -0.5},    {"-1 *2 -(0.5)", -2, -0.5},
        {"-1 cm -5 mm", -1, -0.5}, {"-1,\n   -0.25", -1, -0.25}, {"-3cm -.5", -3, -0.5},
    };
    char text[600];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        (void)snprintf(text, sizeof text, "domain { size = 99 99; r_c = 1; delta_r = 1; origin = %s }\n%s",
                       cases[i].text, deck_rest);
        struct loaded l = load_text(text, NULL, -1);
        CHECK_REPORT(l.status == DM2_OK, "'%s': %s", cases[i].text, l.report.text);
        CHECK_SAME_BITS(l.config.origin[0], cases[i].x);
        CHECK_SAME_BITS(l.config.origin[1], cases[i].y);
        loaded_free(&l);
    }
}

TEST(defines_override_lets)
{
    const char *const defines[] = {"a=2*b", "b=10 mm", "a=3*b", NULL};
    char text[600];
    (void)snprintf(text, sizeof text, "let a = 1\nlet b = 7\ndomain { size = 9 9; r_c = a; delta_r = 1 }\n%s",
                   deck_rest);
    struct loaded l = load_text(text, defines, 77);
    CHECK_STR(l.report.text, "");
    CHECK_SAME_BITS(l.config.r_c, 3);
    CHECK_EQ_INT(l.config.steps, 77);
    loaded_free(&l);
}

/* A deck may lack `steps` where --steps is given. */
TEST(steps_replaced)
{
    struct loaded l = load_text("domain { size = 9 9; r_c = 1; delta_r = 1 }\ntime { dt = 1 }\n"
                                "material M { rho0 = 1; c0 = 1; s = 1 }\n"
                                "body b { shape = rectangle 0 0 1 1; spacing = 0.1; material = M }\n",
                                NULL, 50000);
    CHECK_STR(l.report.text, "");
    CHECK_EQ_INT(l.config.steps, 50000);
    CHECK_EQ_INT(l.config.output.history_every, 250);
    loaded_free(&l);
}

TEST_MAIN(CASE(operators_and_precedence), CASE(functions), CASE(units_in_expressions),
          CASE(lets_in_any_order), CASE(lists), CASE(defines_override_lets), CASE(steps_replaced))

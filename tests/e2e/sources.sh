# The sources contain no function that overflows its buffers or runs a shell; in the layers that make results,
# no function whose last bits differ between C libraries; nothing but portable C11. Each file opens with a
# comment on its idea and keeps to the lengths of docs/contributing.md, the top level holds nothing else, and
# each header compiles alone.
# labels: check
. "$DM2_SRC/tests/lib.sh"

# The names, as alternatives of a regular expression, that must not be called.
unsafe='sprintf|vsprintf|strcpy|strcat|stpcpy|gets|scanf|system|popen|alloca|tmpnam|mktemp|strtok|atoi|atol'
unsafe="$unsafe|atof|setjmp|longjmp|rand|srand|random|drand48"
inexact='exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot|sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh'
inexact="$inexact|tgamma|lgamma|erf|erfc|fma"

# check_tree DIR: prints one line per finding.
check_tree()
{
    (
        cd "$1" || exit 1
        find src include -name '*.[ch]' | LC_ALL=C sort |
            xargs awk -v unsafe="$unsafe" -v inexact="$inexact" '
        # The line without comments, strings and characters; `inside` says whether a comment goes on.
        function code(line,    out, end, found) {
            for (;;) {
                if (inside) {
                    end = index(line, "*/")
                    if (!end) return out
                    line = substr(line, end + 2)
                    inside = 0
                }
                if (!match(line, /\/\*|\/\/|"([^"\\]|\\.)*"|\047([^\047\\]|\\.)*\047/)) return out line
                out = out substr(line, 1, RSTART - 1) " "
                found = substr(line, RSTART, 2)
                if (found == "//") return out
                if (found == "/*") { inside = 1; line = substr(line, RSTART + 2) }
                else line = substr(line, RSTART + RLENGTH)
            }
        }
        function finding(why) { print FILENAME ":" FNR ": " why ": " $0 }
        # A header, and a source of more than 60 lines, opens with its idea.
        function close_file() {
            if (file != "" && !opens && (file ~ /\.h$/ || lines > 60))
                print file ":1: does not open with a comment on its idea"
        }
        BEGIN {
            before = "(^|[^A-Za-z0-9_.>])"
            unsafe = before "(" unsafe ")[ \t]*\\("
            inexact = before "(" inexact ")[fl]?[ \t]*\\("
        }
        FNR == 1 { close_file(); file = FILENAME; opens = /^\/\*/; inside = 0;
            numbers = file ~ /\/(base|deck|engine|output)\// }
        {
            lines = FNR
            if (/^[ \t]*#[ \t]*include[ \t]*<(.*intrin|omp|complex|tgmath|pthread|threads|linux\/.*)\.h>/)
                finding("not among what the project builds on")
            line = code($0)
            if (line ~ unsafe) finding("not to be called")
            # The one place where the vector types of gcc and clang are named is base/simd.h.
            if (line ~ /(^|[^A-Za-z0-9_])(__int128|__asm__|asm[ \t]*\()/ ||
                (file != "include/dm2/base/simd.h" &&
                line ~ /__attribute__[ \t]*\(\((vector_size|optimize|target)/))
                finding("not portable C11")
            if (numbers && line ~ inexact) finding("its last bits differ between C libraries")
            if (numbers &&
                line ~ /(^|[^A-Za-z0-9_])(float|long[ \t]+double)[ \t]/) finding("only doubles here")
            if (file !~ /^src\/app\// &&
                line ~ /(^|[^A-Za-z0-9_.>])(exit|_exit|abort|printf|puts|putchar|perror)[ \t]*\(/)
                finding("only src/app exits or prints")
        }
        END { close_file() }'
    )
}

# check_layout DIR: prints one line per file, function or line that is too long, per section whose name is not
# set as `/* --- name --- */`, and per tag of a struct that has a second meaning in the program. clang-format
# sets the brace of a function alone in column 1, which is how its ends are found.
check_layout()
{
    (
        cd "$1" || exit 1
        find src include tests -name '*.[ch]' | LC_ALL=C sort | xargs awk '
        function finding(why) { print FILENAME ":" FNR ": " why }
        function close_file() { if (lines > 600) print file ":" lines ": a file of more than 600 lines" }
        FNR == 1 { close_file(); file = FILENAME; begin = 0; body = 0 }
        { lines = FNR }
        length($0) > 110 { finding("longer than 110 columns") }
        /^\/\* ---/ && !/^\/\* --- .*[^-] --- \*\/$/ { finding("a section is written /* --- name --- */") }
        /^$/ || /^#/ || /^\/\*/ || /^ \*/ { if (!body) begin = 0; next }
        /^(struct|union|enum) [a-z_0-9]+ \{$/ && file !~ /^tests/ {
            if ($2 in home) finding("the tag " $2 " has another meaning in " home[$2])
            home[$2] = file
        }
        !begin { begin = FNR }
        /^\{$/ { body = 1 }
        /^\}/ {
            if (body && FNR - begin + 1 > 60) finding("a function of " (FNR - begin + 1) " lines, 60 at most")
            begin = 0
            body = 0
        }
        END { close_file() }'
        find tests -name '*.sh' | LC_ALL=C sort |
            xargs awk 'length($0) > 110 { print FILENAME ":" FNR ": longer than 110 columns" }'
    )
}

# The check of the layout, on a file that is right and on each mistake.
mkdir -p tree/src/net tree/include tree/tests
lines() # N: N lines of a body
{
    awk -v n="$1" 'BEGIN { for (k = 0; k < n; k++) print "    x++;" }'
}
{
    printf '/* An idea. */\n/* --- a section --- */\n%s\n\nstatic int f(int a,\n             int b)\n{\n' \
        "$(printf '%0110d' 0)"
    lines 56
    echo '}'
} >tree/src/net/right.c
check_layout tree >found
[ ! -s found ] || { cat found; fail "the check of the layout finds fault with a file that is right"; }
rm tree/src/net/right.c
printf '%0111d\n' 0 >tree/src/net/wide.c
printf '%0111d\n' 0 >tree/tests/wide.sh
printf '/* --- a section ------- */\n' >tree/include/section.h
{
    printf 'static int f(int a,\n             int b)\n{\n'
    lines 57
    echo '}'
} >tree/tests/function.c
lines 601 >tree/tests/file.c
printf 'struct x {\n    int a;\n};\n' | tee tree/include/tag.h >tree/src/net/tag.h
check_layout tree | sed -e 's/:.*//' >found
printf '%s\n' include/section.h src/net/tag.h src/net/wide.c tests/file.c tests/function.c tests/wide.sh \
    >expected
LC_ALL=C sort found | diff expected - ||
    fail "the check of the layout does not find exactly the mistakes that were made"
rm -r tree

# The check of the contents, on one mistake at a time.
mkdir -p tree/src/engine tree/src/net tree/src/app tree/include/dm2/engine
check_one() # FILE, EXPECTED NUMBER OF FINDINGS, TEXT
{
    printf '/* An idea. */\n%s\n' "$3" >"tree/$1"
    check_tree tree >found
    [ "$(wc -l <found)" -eq "$2" ] || { cat found; fail "expected $2 findings in '$3' ($1)"; }
    rm "tree/$1"
}
check_one src/net/x.c 1 'x = sprintf(b, "a");'
check_one src/net/x.c 1 'if (system ("ls")) return;'
check_one src/net/x.c 1 'strcpy(a, b);'
check_one src/net/x.c 1 '    printf("%d", 1);'
check_one src/net/x.c 1 'exit(1);'
check_one src/app/x.c 0 'printf("system(1)"); exit(1);'
check_one src/engine/x.c 0 \
    'snprintf(b, 1, "exp(%d)", a); dm2_exp(x); /* exp(x) */ s.log(x); "a\"b pow(1)"; // sin(x)'
check_one src/engine/x.c 0 '/* first
 exp(x)
*/ x = sqrt(x);'
check_one src/engine/x.c 1 '/* x */ y = exp(x);'
check_one src/engine/x.c 1 'return 2*pow (x, 2);'
check_one src/engine/x.c 1 'y = cosf(x);'
check_one src/engine/x.c 1 'float y;'
check_one src/net/x.c 0 'double y = log(x);'
check_one src/engine/x.c 1 'static __int128 t;'
check_one src/engine/x.c 1 '#include <immintrin.h>'
check_one src/net/x.c 1 '# include <pthread.h>'
echo 'int x_count(void);' >tree/include/dm2/engine/x.h
check_tree tree >found
[ "$(wc -l <found)" -eq 1 ] || { cat found; fail "a header without a comment is not noticed"; }
rm tree/include/dm2/engine/x.h

# And now the project.
{
    check_tree "$DM2_SRC"
    check_layout "$DM2_SRC"
} >found
[ ! -s found ] || { cat found; fail "see docs/architecture.md, \"How the code reads\""; }

# The top level, as far as git keeps it.
if [ -d "$DM2_SRC/.git" ] || [ -f "$DM2_SRC/.git" ] && command -v git >/dev/null; then
    git -C "$DM2_SRC" ls-files 2>/dev/null | sed -e 's,/.*,,' | LC_ALL=C sort -u |
        grep -v -x -e '\..*' -e Makefile -e README.md -e src -e include -e input -e tests -e scripts -e docs \
            >stray || :
    [ ! -s stray ] || { cat stray; fail "these do not belong at the top level"; }
fi

# Every header alone, as the first thing of a source file.
cc=${CC:-cc}
command -v "$cc" >/dev/null || cc=cc
command -v "$cc" >/dev/null || skip "there is no compiler to try the headers with"
mkdir alone
{
    (cd "$DM2_SRC/include" && find dm2 -name '*.h')
    (cd "$DM2_SRC/src" && find . -name '*.h' | sed -e 's,^\./,,')
} | LC_ALL=C sort | while IFS= read -r header; do
    printf '#include "%s"\n#include "%s"\nint main(void) { return 0; }\n' "$header" "$header" \
        >"alone/$(printf '%s' "$header" | tr '/' '_').c"
done
"$cc" -std=c11 -D_POSIX_C_SOURCE=200809L -I"$DM2_SRC/include" -I"$DM2_SRC/src" -Wall -Wextra -Wpedantic \
    -Wstrict-prototypes \
    -Wno-unused-function -Werror -fsyntax-only alone/*.c || fail "a header does not compile alone"

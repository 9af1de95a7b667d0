# What the sources must not contain, whatever they compute: functions that overflow their buffers or run a shell;
# in what makes results, functions whose last bits differ between C libraries; anything but portable C11. And that
# each file opens with a comment on its idea, and each public header compiles alone.
# labels: check
. "$DM2_SRC/tests/lib.sh"

# code FILE: its text without comments, strings and characters, line by line.
code()
{
    awk '
    {
        line = $0; out = ""
        for (;;) {
            if (inside) {
                end = index(line, "*/")
                if (!end) break
                line = substr(line, end + 2); inside = 0
            }
            if (!match(line, /\/\*|\/\/|"([^"\\]|\\.)*"|\047([^\047\\]|\\.)*\047/)) { out = out line; break }
            out = out substr(line, 1, RSTART - 1) " "
            found = substr(line, RSTART, 2)
            if (found == "//") break
            if (found == "/*") { inside = 1; line = substr(line, RSTART + 2) }
            else line = substr(line, RSTART + RLENGTH)
        }
        print out
    }' "$1"
}

# The names, as alternatives of a regular expression, that must not be called.
unsafe='sprintf|vsprintf|strcpy|strcat|stpcpy|gets|scanf|system|popen|alloca|tmpnam|mktemp|strtok|atoi|atol|atof'
unsafe="$unsafe|setjmp|longjmp|rand|srand|random|drand48"
inexact='exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot|sin|cos|tan|asin|acos|atan|atan2|sinh|cosh|tanh|tgamma'
inexact="$inexact|lgamma|erf|erfc|fma"

# found_in FILE REGEX WHY: prints the places.
found_in()
{
    code "$1" | grep -n -E -e "(^|[^A-Za-z0-9_.>])($2)" | sed -e "s|^|$1:|" -e "s|\$|    <- $3|"
}

# check_tree DIR: prints one line per finding.
check_tree()
{
    (
        cd "$1" || exit 1
        find src include -name '*.[ch]' | LC_ALL=C sort | while IFS= read -r file; do
            found_in "$file" "($unsafe)[[:space:]]*\\(" "not to be called"
            found_in "$file" '(__int128|__asm__|asm[[:space:]]*\(|__attribute__[[:space:]]*\(\((vector_size|optimize|target))' \
                "not portable C11"
            case $file in
            src/base/* | src/sim/* | include/dm2/base/* | include/dm2/sim/*)
                found_in "$file" "($inexact)f?l?[[:space:]]*\\(" "its last bits differ between C libraries"
                found_in "$file" '(float|long[[:space:]]+double)[[:space:]]' "only doubles here"
                ;;
            esac
            case $file in
            src/app/*) ;;
            *) found_in "$file" '(exit|_exit|abort|printf|puts|putchar|perror)[[:space:]]*\(' "only src/app exits or prints" ;;
            esac
            grep -n -E '^[[:space:]]*#[[:space:]]*include[[:space:]]*<(.*intrin|omp|complex|tgmath|pthread|threads|linux/.*)\.h>' \
                "$file" | sed -e "s|^|$file:|" -e 's|$|    <- not among what the project builds on|'
            grep -n -E '.{121}' "$file" | sed -e 's/:.*//' -e "s|^|$file:|" -e 's|$|: longer than 120 columns|'
            # A short .c file is explained by its header.
            case $file in
            *.c) [ "$(wc -l <"$file")" -gt 60 ] || continue ;;
            esac
            sed -e 1q "$file" | grep -v -q -e '^/\*' && echo "$file:1: does not open with a comment on its idea"
        done
    )
}

# The check itself, on one mistake at a time.
mkdir -p tree/src/sim tree/src/net tree/src/app tree/include/dm2/sim
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
check_one src/sim/x.c 0 'snprintf(b, 1, "exp(%d)", a); dm2_exp(x); /* exp(x) */ s.log(x); "a\"b pow(1)"; // sin(x)'
check_one src/sim/x.c 0 '/* first
 exp(x)
*/ x = sqrt(x);'
check_one src/sim/x.c 1 '/* x */ y = exp(x);'
check_one src/sim/x.c 1 'return 2*pow (x, 2);'
check_one src/sim/x.c 1 'y = cosf(x);'
check_one src/sim/x.c 1 'float y;'
check_one src/net/x.c 0 'double y = log(x);'
check_one src/sim/x.c 1 'static __int128 t;'
check_one src/sim/x.c 1 '#include <immintrin.h>'
check_one src/net/x.c 1 '# include <pthread.h>'
check_one src/net/x.c 1 "$(printf '%0121d' 0)"
echo 'int x_count(void);' >tree/include/dm2/sim/x.h
check_tree tree >found
[ "$(wc -l <found)" -eq 1 ] || { cat found; fail "a header without a comment is not noticed"; }
rm tree/include/dm2/sim/x.h

# And now the project.
check_tree "$DM2_SRC" >found
[ ! -s found ] || { cat found; fail "see docs/architecture.md, \"How the code reads\""; }

# Every header alone, as the first thing of a source file.
cc=${CC:-cc}
command -v "$cc" >/dev/null || cc=cc
command -v "$cc" >/dev/null || skip "there is no compiler to try the headers with"
(cd "$DM2_SRC/include" && find dm2 -name '*.h') | LC_ALL=C sort >headers
while IFS= read -r header; do
    printf '#include "%s"\n#include "%s"\nint main(void) { return 0; }\n' "$header" "$header" >alone.c
    "$cc" -std=c11 -D_POSIX_C_SOURCE=200809L -I"$DM2_SRC/include" -Wall -Wextra -Wpedantic -Wstrict-prototypes \
        -Wno-unused-function -Werror -fsyntax-only alone.c || fail "$header does not compile alone"
done <headers

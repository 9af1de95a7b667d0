# Who may include whom: app -> all; dist -> sim, net, base; sim, net, model, plot -> base. The same for the headers
# below include/dm2, so that an arrow that is forbidden cannot be smuggled in through one.
# labels: check
. "$DM2_SRC/tests/lib.sh"

# may_include LAYER: the layers it may include from, itself among them.
may_include()
{
    case $1 in
    app) echo app dist sim net model plot base ;;
    dist) echo dist sim net base ;;
    sim | net | model | plot) echo "$1" base ;;
    base) echo base ;;
    esac
}

# check_tree DIR: prints one line per include that is not allowed.
check_tree()
{
    (
        cd "$1" || exit 1
        find src include/dm2 -name '*.[ch]' | LC_ALL=C sort | while IFS= read -r file; do
            layer=${file#src/}
            layer=${layer#include/dm2/}
            case $layer in
            */*) layer=${layer%%/*} ;;
            *) layer= ;;
            esac
            allowed=$(may_include "$layer")
            [ -n "$allowed" ] || { echo "$file: is in no layer (base sim net dist model plot app)"; continue; }
            sed -n 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*\([<"].*[>"]\).*/\1/p' "$file" |
                while IFS= read -r include; do
                    target=$(printf '%s\n' "$include" | tr -d '<>"')
                    case $include in
                    '"dm2/'*/*)
                        target=${target#dm2/}
                        target=${target%%/*}
                        case " $allowed " in
                        *" $target "*) ;;
                        *) echo "$file: $layer must not include from $target: $include" ;;
                        esac
                        ;;
                    '"'*/* | '<dm2/'*) echo "$file: include headers of other layers as \"dm2/LAYER/MODULE.h\": $include" ;;
                    '"'*) [ -f "$(dirname "$file")/$target" ] || echo "$file: $include is not beside it" ;;
                    esac
                done
        done
    )
}

# The check itself, on a tree with each kind of mistake and some lines that are right.
for layer in base sim net dist model plot app; do
    mkdir -p "tree/src/$layer" "tree/include/dm2/$layer"
    : >"tree/include/dm2/$layer/x.h"
done
right='app:dist app:plot app:sim dist:sim dist:net dist:base sim:base sim:sim net:base model:base plot:base'
for arrow in $right; do
    printf '#include <stdio.h>\n#include "dm2/%s/x.h"\n' "${arrow#*:}" >>"tree/src/${arrow%:*}/x.c"
    printf '# include "dm2/%s/x.h"\n' "${arrow#*:}" >>"tree/include/dm2/${arrow%:*}/x.h"
done
check_tree tree >found
[ ! -s found ] || { cat found; fail "the check finds fault with allowed includes"; }
wrong='sim:net net:sim base:sim sim:dist net:dist sim:app dist:app plot:model model:sim plot:sim dist:plot base:app'
for arrow in $wrong; do
    for file in "src/${arrow%:*}/${arrow#*:}.c" "include/dm2/${arrow%:*}/${arrow#*:}.h"; do
        printf '  #  include "dm2/%s/x.h"\n' "${arrow#*:}" >"tree/$file"
        echo "$file" >>wrong
    done
done
echo '#include "../net/x.h"' >tree/src/sim/path.c
echo '#include "missing.h"' >tree/src/sim/missing.c
echo '#include <dm2/net/x.h>' >tree/src/sim/angle.c
: >tree/src/stray.c
printf '%s\n' src/sim/path.c src/sim/missing.c src/sim/angle.c src/stray.c >>wrong
LC_ALL=C sort wrong >expected
check_tree tree | sed -e 's/:.*//' | LC_ALL=C sort >found
diff expected found || fail "the check does not find exactly the mistakes that were made"

# And now the project.
check_tree "$DM2_SRC" >found
[ ! -s found ] || { cat found; fail "includes that cross the layers"; }

# Who may include whom: app -> all; dist -> sim, net, base; sim, net, model, plot -> base. The same for the headers
# below include/dm2, so that an arrow that is forbidden cannot be smuggled in through one.
# labels: check
. "$DM2_SRC/tests/lib.sh"

# check_tree DIR: prints one line per include that is not allowed.
check_tree()
{
    (
        cd "$1" || exit 1
        find src include/dm2 -name '*.[ch]' | LC_ALL=C sort >"$TMPDIR/files"
        xargs awk -v list="$TMPDIR/files" '
        function wrong(why) { print FILENAME ": " why ": " $0 }
        function layer_of(path) {
            sub(/^(src|include\/dm2)\//, "", path)
            if (path !~ /\//) return ""
            sub(/\/.*/, "", path)
            return path
        }
        BEGIN {
            may["app"] = " app dist sim net model plot base "
            may["dist"] = " dist sim net base "
            may["sim"] = " sim base "
            may["net"] = " net base "
            may["model"] = " model base "
            may["plot"] = " plot base "
            may["base"] = " base "
            while ((getline path < list) > 0) {
                is_there[path] = 1
                if (!(layer_of(path) in may)) print path ": is in no layer (base sim net dist model plot app)"
            }
        }
        /^[ \t]*#[ \t]*include[ \t]*[<"]/ {
            layer = layer_of(FILENAME)
            if (!(layer in may)) next
            match($0, /[<"][^>"]*/)
            quote = substr($0, RSTART, 1)
            target = substr($0, RSTART + 1, RLENGTH - 1)
            if (quote == "\"" && target ~ /^dm2\/.*\//) {
                target = layer_of("include/" target)
                if (index(may[layer], " " target " ") == 0) wrong(layer " must not include from " target)
            } else if (quote == "<" ? target ~ /^dm2\// : target ~ /\//) {
                wrong("headers of other layers are included as \"dm2/LAYER/MODULE.h\"")
            } else if (quote == "\"") {
                beside = FILENAME
                sub(/[^\/]*$/, "", beside)
                if (!((beside target) in is_there)) wrong("is not beside it")
            }
        }' <"$TMPDIR/files"
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

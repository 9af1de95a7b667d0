# Which layer may include from which: the table `may` below. The same holds for the headers below include/dm2, so that no header
# carries a forbidden arrow.
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
            may["app"] = " app cluster output engine deck net performance plot base "
            may["cluster"] = " cluster output engine deck net base "
            may["output"] = " output engine deck base "
            may["engine"] = " engine deck base "
            may["deck"] = " deck base "
            may["net"] = " net base "
            may["performance"] = " performance base "
            may["plot"] = " plot base "
            may["base"] = " base "
            while ((getline path < list) > 0) {
                is_there[path] = 1
                if (!(layer_of(path) in may)) print path ": is in no layer (base deck engine output net cluster performance plot app)"
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
for layer in base deck engine output net cluster performance plot app; do
    mkdir -p "tree/src/$layer" "tree/include/dm2/$layer"
    : >"tree/include/dm2/$layer/x.h"
done
right='app:cluster app:plot app:engine cluster:output cluster:engine cluster:deck cluster:net output:engine output:deck
engine:deck engine:base engine:engine deck:base net:base performance:base plot:base'
for arrow in $right; do
    printf '#include <stdio.h>\n#include "dm2/%s/x.h"\n' "${arrow#*:}" >>"tree/src/${arrow%:*}/x.c"
    printf '# include "dm2/%s/x.h"\n' "${arrow#*:}" >>"tree/include/dm2/${arrow%:*}/x.h"
done
check_tree tree >found
[ ! -s found ] || { cat found; fail "the check finds fault with allowed includes"; }
wrong='deck:engine engine:output output:cluster output:net engine:net net:engine net:deck base:deck engine:cluster net:cluster
engine:app cluster:app plot:performance performance:engine plot:output cluster:plot base:app'
for arrow in $wrong; do
    for file in "src/${arrow%:*}/${arrow#*:}.c" "include/dm2/${arrow%:*}/${arrow#*:}.h"; do
        printf '  #  include "dm2/%s/x.h"\n' "${arrow#*:}" >"tree/$file"
        echo "$file" >>wrong
    done
done
echo '#include "../net/x.h"' >tree/src/engine/path.c
echo '#include "missing.h"' >tree/src/engine/missing.c
echo '#include <dm2/net/x.h>' >tree/src/engine/angle.c
: >tree/src/stray.c
printf '%s\n' src/engine/path.c src/engine/missing.c src/engine/angle.c src/stray.c >>wrong
LC_ALL=C sort wrong >expected
check_tree tree | sed -e 's/:.*//' | LC_ALL=C sort >found
diff expected found || fail "the check does not find exactly the mistakes that were made"

# And now the project.
check_tree "$DM2_SRC" >found
[ ! -s found ] || { cat found; fail "includes that cross the layers"; }

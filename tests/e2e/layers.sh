# Which layer may include from which: the table `may` below. The same holds for headers, so that no header
# carries a forbidden arrow. A header in include/dm2/LAYER is a door: another layer includes it, or another
# door does. Every other header lies in src/LAYER beside its .c. A base name belongs to one layer, because the
# archive and a debugger know objects by it.
# labels: check
. "$DM2_SRC/tests/lib.sh"

# check_tree DIR: prints one line per finding.
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
        function name_of(path) {
            sub(/.*\//, "", path)
            sub(/\.[ch]$/, "", path)
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
                layer = layer_of(path)
                if (!(layer in may)) print path ": is in no layer"
                else if (!(name_of(path) in home)) home[name_of(path)] = layer
                else if (home[name_of(path)] != layer)
                    print path ": the layer " home[name_of(path)] " has a file of this name too"
            }
        }
        /^[ \t]*#[ \t]*include[ \t]*[<"]/ {
            layer = layer_of(FILENAME)
            if (!(layer in may)) next
            match($0, /[<"][^>"]*/)
            quote = substr($0, RSTART, 1)
            target = substr($0, RSTART + 1, RLENGTH - 1)
            if (quote == "\"" && target ~ /^dm2\/.*\//) {
                door = "include/" target
                target = layer_of(door)
                if (target != layer || FILENAME ~ /^include\//) opened[door] = 1
                if (index(may[layer], " " target " ") == 0) wrong(layer " must not include from " target)
            } else if (quote == "<" ? target ~ /^dm2\// : target ~ /\//) {
                wrong("headers of other layers are included as \"dm2/LAYER/MODULE.h\"")
            } else if (quote == "\"") {
                beside = FILENAME
                sub(/[^\/]*$/, "", beside)
                if (!((beside target) in is_there)) wrong("is not beside it")
            }
        }
        END {
            for (path in is_there)
                if (path ~ /^include\// && layer_of(path) in may && !(path in opened))
                    print path ": is no door, neither another layer nor a door includes it: move it to src/" \
                        layer_of(path)
        }' <"$TMPDIR/files"
    )
}

# The check itself, on a tree with each kind of mistake and some lines that are right. The door of layer L is
# in_L.h; the application, which may include everything, opens each of them.
layers='base deck engine output net cluster performance plot app'
for layer in $layers; do
    mkdir -p "tree/src/$layer"
    [ "$layer" = app ] || mkdir -p "tree/include/dm2/$layer"
done
right='cluster:output cluster:engine cluster:deck cluster:net output:engine output:deck engine:deck
engine:base engine:engine deck:base net:base performance:base plot:base'
for layer in $layers; do
    [ "$layer" = app ] || printf '#include "dm2/%s/in_%s.h"\n' "$layer" "$layer" >>tree/src/app/all.c
    [ "$layer" = app ] || : >"tree/include/dm2/$layer/in_$layer.h"
done
for arrow in $right; do
    from=${arrow%:*} to=${arrow#*:}
    printf '#include <stdio.h>\n#include "dm2/%s/in_%s.h"\n' "$to" "$to" >>"tree/src/$from/of_$from.c"
    printf '# include "dm2/%s/in_%s.h"\n' "$to" "$to" >>"tree/include/dm2/$from/in_$from.h"
done
: >tree/src/engine/inside.h
echo '#include "inside.h"' >tree/src/engine/inside.c
check_tree tree >found
[ ! -s found ] || { cat found; fail "the check finds fault with what is allowed"; }
wrong='deck:engine engine:output output:cluster output:net engine:net net:engine net:deck base:deck
engine:cluster net:cluster cluster:plot plot:performance performance:engine plot:output'
for arrow in $wrong; do
    from=${arrow%:*} to=${arrow#*:}
    printf '  #  include "dm2/%s/in_%s.h"\n' "$to" "$to" >"tree/src/$from/${from}_$to.c"
    printf '  #  include "dm2/%s/in_%s.h"\n' "$to" "$to" >"tree/include/dm2/$from/${from}_$to.h"
    printf '#include "dm2/%s/%s_%s.h"\n' "$from" "$from" "$to" >>tree/src/app/all.c
    printf '%s\n' "src/$from/${from}_$to.c" "include/dm2/$from/${from}_$to.h" >>wrong
done
echo '#include "../net/x.h"' >tree/src/engine/path.c
echo '#include "engine/inside.h"' >tree/src/cluster/inside_of_engine.c
echo '#include "missing.h"' >tree/src/engine/missing.c
echo '#include <dm2/net/in_net.h>' >tree/src/engine/angle.c
: >tree/src/stray.c
echo '#include "dm2/engine/alone.h"' >tree/src/engine/alone.c # its only reader is its own layer
: >tree/include/dm2/engine/alone.h
: >tree/src/deck/twice.c
: >tree/src/plot/twice.c
printf '%s\n' src/engine/path.c src/cluster/inside_of_engine.c src/engine/missing.c src/engine/angle.c \
    src/stray.c \
    include/dm2/engine/alone.h src/plot/twice.c >>wrong
LC_ALL=C sort wrong >expected
check_tree tree | sed -e 's/:.*//' | LC_ALL=C sort >found
diff expected found || fail "the check does not find exactly the mistakes that were made"

# And now the project.
check_tree "$DM2_SRC" >found
[ ! -s found ] || { cat found; fail "see docs/architecture.md, \"Layers\""; }

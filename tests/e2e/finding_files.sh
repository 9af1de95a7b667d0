# Programs behind links find each other; a deck finds the library's materials from any folder; no spelling of
# an include leads out of the deck's folder.
# labels: e2e
. "$DM2_SRC/tests/lib.sh"
here=$PWD
unset DM2_PATH

head='domain { size = 1 cm, 1 cm; r_c = 0.1 cm; delta_r = 0.01 cm }
time { dt = 0.01 us; steps = 1 }'
body='body b { shape = rectangle 0.4 cm, 0.4 cm, 0.6 cm, 0.6 cm; spacing = 0.04 cm; material = M }'
material='material M { rho0 = 8 g/cm3; c0 = 4 km/s; s = 1.5 }'
printf '%s\n%s\n%s\n' "$head" "$body" "$material" >whole.dm2
expect_status 0 "$DM2_BIN/dm2-seq" whole.dm2 -q -o good

# A client behind one link or two, called by its path or found on PATH.
mkdir home away
ln -s "$DM2_BIN/dm2-client" home/dm2-client
ln -s ../home/dm2-client away/dm2-client
expect_status 0 env PATH=/usr/bin:/bin home/dm2-client -n 1 -q -o by-link whole.dm2
same_bytes good/final.dm2 by-link/final.dm2
expect_status 0 env PATH=/usr/bin:/bin away/dm2-client -n 1 -q -o by-links whole.dm2
expect_status 0 env PATH="$here/away:/usr/bin:/bin" dm2-client -n 1 -q -o on-path whole.dm2
same_bytes good/final.dm2 on-path/final.dm2

# Spellings of a way out.
mkdir -p outside x/y
echo "$material" >outside/m.dm2
# refused TEXT PATH: the deck with this include ends with 2 and the message.
refused()
{
    printf '%s\n%s\ninclude "%s"\n' "$head" "$body" "$2" >deck.dm2
    expect_status 2 "$DM2_BIN/dm2-seq" -q --overwrite -o out.run deck.dm2
    expect_text err "$1"
}
outside='neither an absolute path nor'
refused "$outside" "$here/outside/m.dm2"
refused "$outside" "./$here/outside/m.dm2"
refused "$outside" ".//$here/outside/m.dm2"
refused "$outside" ".///$here/outside/m.dm2"
refused "$outside" "././/$here/outside/m.dm2"
refused "$outside" "../${here##*/}/outside/m.dm2"
refused "$outside" "x/../../${here##*/}/outside/m.dm2"
refused 'No such file' "x/.//$here/outside/m.dm2"
# One file by several names is read once.
echo "$material" >x/y/m.dm2
printf '%s\n%s\ninclude "x/y/m.dm2"\ninclude "x//y/m.dm2"\ninclude "./x/./y/m.dm2"\n' "$head" "$body" \
    >deck.dm2
expect_status 0 "$DM2_BIN/dm2-seq" -q -o names deck.dm2
same_bytes good/history.csv names/history.csv

# A link may lead to a file of the deck's folder, never out of it, be it a link of the file or of a folder.
echo "$material" >x/real.dm2
ln -s ../real.dm2 x/y/inside.dm2
ln -s "$here/outside/m.dm2" x/link.dm2
ln -s ../outside x/folder
ln -s link.dm2 x/link-of-link.dm2
ln -s x linked
# included PATH: writes x/deck.dm2 with this include.
included() { printf '%s\n%s\ninclude "%s"\n' "$head" "$body" "$1" >x/deck.dm2; }
for path in link.dm2 folder/m.dm2 link-of-link.dm2; do
    included "$path"
    for deck in x/deck.dm2 linked/deck.dm2 "$here/x/deck.dm2"; do
        expect_status 2 "$DM2_BIN/dm2-seq" --check "$deck"
        expect_text err "$deck:4: ${deck%deck.dm2}$path: symbolic links lead to a file outside the deck's"
    done
    (cd x && expect_status 2 "$DM2_BIN/dm2-client" -n 1 -q -o linked.run deck.dm2)
    # What DM2_PATH names is the user's word.
    expect_status 0 env DM2_PATH="$here/outside" "$DM2_BIN/dm2-seq" --check x/deck.dm2
done
# A folder that is a link, a link within the folder.
included y/inside.dm2
for deck in x/deck.dm2 linked/deck.dm2 "$here/linked/deck.dm2"; do
    expect_status 0 "$DM2_BIN/dm2-seq" --check "$deck"
done
(cd linked && expect_status 0 "$DM2_BIN/dm2-seq" --check deck.dm2)
# A root of links, as some installers lay them out.
mkdir stowed
ln -s ../outside/m.dm2 stowed/m.dm2
mkdir alone
printf '%s\n%s\ninclude "m.dm2"\n' "$head" "$body" >alone/deck.dm2
expect_status 2 env DM2_PATH="$here/stowed" "$DM2_BIN/dm2-seq" --check alone/deck.dm2
expect_status 0 env DM2_PATH="$here/stowed:$here/outside" "$DM2_BIN/dm2-seq" --check alone/deck.dm2

# The library: beside the deck first, then DM2_PATH, then what lies beside the programs.
mkdir -p installed/bin installed/share/dm2/input/materials lib/materials user
cp "$DM2_BIN/dm2-seq" "$DM2_BIN/dm2-client" "$DM2_BIN/dm2-server" installed/bin/
cp "$DM2_SRC/input/materials/cu.dm2" installed/share/dm2/input/materials/
printf '%s\n%s\ninclude "materials/cu.dm2"\n' "$head" "$(echo "$body" | sed 's/= M /= Cu /')" >user/deck.dm2
expect_status 0 installed/bin/dm2-seq -q -o user.run user/deck.dm2
expect_status 0 installed/bin/dm2-client -n 2 -q -o user.2 user/deck.dm2
same_bytes user.run/final.dm2 user.2/final.dm2
# The input of the source tree lies beside the programs of the release flavour.
[ ! -d "$DM2_BIN/../input" ] || expect_status 0 "$DM2_BIN/dm2-seq" -q --overwrite -o user.2 user/deck.dm2
echo 'material Cu { rho0 = 1 g/cm3; c0 = 4 km/s; s = 1.5' >lib/materials/cu.dm2
expect_status 2 env DM2_PATH="/nowhere:$here/lib" installed/bin/dm2-seq --check user/deck.dm2
expect_text err "$here/lib//materials/cu.dm2:1:"
mkdir user/materials
cp installed/share/dm2/input/materials/cu.dm2 user/materials/
expect_status 0 env DM2_PATH="$here/lib" installed/bin/dm2-seq --check user/deck.dm2
# A file that lies nowhere: the message names the places.
sed 's/cu.dm2/gold.dm2/' user/deck.dm2 >user/gold.dm2
expect_status 2 env DM2_PATH=/nowhere installed/bin/dm2-seq --check user/gold.dm2
for text in 'user/gold.dm2:4: user/materials/gold.dm2: cannot open: No such file' /nowhere, \
    installed/bin/../share/dm2, DM2_PATH; do
    expect_text err "$text"
done
# Out of a root no spelling leads, either.
sed 's#materials/cu.dm2#../outside/m.dm2#' user/deck.dm2 >user/out.dm2
expect_status 2 env DM2_PATH="$here/lib" installed/bin/dm2-seq --check user/out.dm2
expect_text err "$outside"
exit 0

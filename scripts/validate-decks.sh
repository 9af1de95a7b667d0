#!/bin/sh
# Nine decks of input/ at their full size and with all of their steps: how far the energy book closes, and whether 1, 2,
# 4 and 7 servers leave the bytes of dm2-seq. Writes the second part of docs/validation.md to standard output; takes some
# minutes. Exit status 1 where a book is off by more than 1 %, or a byte differs.
set -eu
bin=${DM2_BIN:-bin}
[ -x "$bin/dm2-seq" ] || { echo "validate-decks.sh: no $bin/dm2-seq: run make first, in the source directory" >&2; exit 1; }
work=$(mktemp -d "${TMPDIR:-/tmp}/dm2-validate.XXXXXX")
trap 'rm -rf "$work"' EXIT

cat <<'END'
## Energy books of the decks

Whole runs at full size. *Off by* is the largest difference of `total` from its first value in any row of
`history.csv`; *share* is this difference over the largest kinetic energy or work of the whole run, in g cm2/us2. (The
last line of a run divides by the most that had moved by then, so its worst drift may be an early row with little
moved.) 1, 2, 4 and 7 servers left the same `final.dm2` and `history.csv` as `dm2-seq`, byte for byte.

| deck | elements | steps | rows | kinetic or work | off by | share |
|---|---|---|---|---|---|---|
END
for deck in collision hmx-powder shear-band granular-shear cu-polycrystal plate-impact spall phase-front sliding-block; do
    "$bin/dm2-seq" "${DM2_SRC:-.}/input/$deck.dm2" -q -o "$work/one" --overwrite
    awk -F, -v deck=$deck 'NR == 1 { for (i = 1; i <= NF; i++) { sub(/ .*/, "", $i); at[$i] = i }; next }
        NR == 2 { first = $at["total"] }
        { d = $at["total"] - first; if (d < 0) d = -d; if (d > off) off = d
          if ($at["kinetic"] > most) most = $at["kinetic"]; if ($at["work"] > most) most = $at["work"]
          steps = $at["step"]; elements = $at["elements"] }
        END { printf "| %s | %d | %d | %d | %.3g | %.2g | %.3f %% |\n", deck, elements, steps, NR - 1, most, off,
                  100 * off / most
              exit !(most > 0 && off <= 0.01 * most) }' "$work/one/history.csv" ||
        { echo "validate-decks.sh: $deck: the energy book does not close" >&2; exit 1; }
    for n in 1 2 4 7; do
        "$bin/dm2-client" "${DM2_SRC:-.}/input/$deck.dm2" -n $n -q -o "$work/many" --overwrite
        for file in final.dm2 history.csv; do
            cmp "$work/one/$file" "$work/many/$file" >&2 || exit 1
        done
    done
done

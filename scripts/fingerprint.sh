#!/bin/sh
# Usage: fingerprint.sh, in the source tree; `make fingerprint` calls it. Writes the fingerprint of the present sources
# into include/dm2/engine/self_test.h, once gcc and clang, as far as they are here, agree on it without optimization.
set -eu
header=include/dm2/engine/self_test.h
found=
for cc in ${CC:-gcc} clang; do
    command -v "$cc" >/dev/null || continue
    dir=build/fingerprint-$cc
    MAKEFLAGS= make -s -j2 CC="$cc" CFLAGS=-O0 BUILD="$dir" BIN="$dir/bin" "$dir/tools/fingerprint" >/dev/null
    this=$("$dir/tools/fingerprint")
    echo "$cc: $this"
    if [ -n "$found" ] && [ "$this" != "$found" ]; then
        echo "fingerprint.sh: the compilers differ: $found, $this; $header stays as it is" >&2
        exit 1
    fi
    found=$this
done
[ -n "$found" ] || { echo "fingerprint.sh: there is no compiler" >&2; exit 1; }
sed "s/^#define SELF_TEST_FINGERPRINT .*/#define SELF_TEST_FINGERPRINT $found/" "$header" >"$header.new"
cmp -s "$header" "$header.new" && rm "$header.new" || mv "$header.new" "$header"

# docs/protocol.md has the version and the types of messages of messages.h, and the frame that its text shows.
# labels: check
. "$DM2_SRC/tests/lib.sh"

page=$DM2_SRC/docs/protocol.md
header=$DM2_SRC/include/dm2/cluster/messages.h
version=$(sed -n 's/.*PROTOCOL_VERSION = \([0-9]*\).*/\1/p' "$header")
[ -n "$version" ] || fail "$header has no PROTOCOL_VERSION"
grep -q "^Version $version\. " "$page" || fail \
    "$page says '$(grep '^Version' "$page")', PROTOCOL_VERSION is $version"
sed -n 's/^ *MESSAGE_\([A-Z]*\) = \([0-9]*\).*/\2 \1/p' "$header" | sort -n >types
sed -n 's/^| \([0-9]*\) | \([A-Z]*\) | \(client\|server\|either\) | .*/\1 \2/p' "$page" | sort -n >rows
[ -s types ] || fail "$header has no types"
diff types rows || fail "the types of $header (<) and the table of $page (>) differ"

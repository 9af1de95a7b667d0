# dm2-model measures: netbench, calibrate, compare, on local servers, on named ones, and on finished runs. No
# check here depends on how long a time is.
# labels: e2e model
. "$DM2_SRC/tests/lib.sh"
model=$DM2_BIN/dm2-model
cp "$DM2_SRC/input/timing.dm2" timing.dm2

# netbench: a row per size and number of servers, all positive, and the lines for people.
expect_status 0 "$model" netbench -n 2,1 --turns 4 --csv
[ "$(sed -n 1p out)" = servers,bytes,seconds,fit ] || fail "the header is wrong"
[ "$(cut -d , -f 1 out | sed 1d | uniq -c | awk '{ print $1 "x" $2 }' | tr '\n' ' ')" = '7x1 7x2 ' ] ||
    { cat out; fail "seven sizes for one and two servers were expected"; }
awk -F , 'NR > 1 && !($3 > 0 && $4 >= 0) { exit 1 }' out || fail "a time that is not positive"
expect_status 0 "$model" netbench -n 1 --turns 4
expect_text out 'm_1 = '

# A running server is measured and goes on serving.
start_server
expect_status 0 "$model" netbench --server "$SERVER_ADDR" --turns 4 --csv
expect_status 0 "$model" netbench --server "$SERVER_ADDR" --turns 4 --csv
grep -q 'done: network measured, 28 round trips' "$SERVER_LOG" ||
    { cat "$SERVER_LOG"; fail "no such line in the log"; }
stop_server "$SERVER_PID"
expect_status 3 "$model" netbench --server "$SERVER_ADDR" --turns 4
expect_text err "$SERVER_ADDR"
[ ! -s out ] || fail "netbench printed something before it failed"

# Servers with a key: all three commands measure with the key, by --server and by a hosts file, and get
# nothing without it or with another. A server that does not admit this address refuses all.
expect_status 0 "$DM2_BIN/dm2-server" --new-key key
expect_status 0 "$DM2_BIN/dm2-server" --new-key other
start_server --key key --allow 127.0.0.0/8
echo "$SERVER_ADDR" >hosts
locked=$SERVER_LOG
start_server --key key
echo "$SERVER_ADDR" >>hosts
one=$SERVER_ADDR
expect_status 0 "$model" netbench --hosts hosts --key key -n 1,2 --turns 4 --csv
[ "$(cut -d , -f 1 out | sed 1d | sort -u | tr '\n' ' ')" = '1 2 ' ] ||
    { cat out; fail "one and two keyed servers were expected"; }
expect_status 0 "$model" calibrate --server "$one" --key key -n 1 --n 400 --runs 1 --steps 3 --turns 4 \
    --deck timing.dm2 \
    -f keyed.csv -o runs
expect_text keyed.csv 'networks,,1,'
expect_status 0 "$model" compare --hosts hosts --key key -n 1,2 --n 400 --runs 1 --steps 3 --deck timing.dm2 \
    -o keyed \
    --calibration keyed.csv --csv
[ "$(sed 1d out | cut -d , -f 1,3 | tr '\n' ' ')" = 'dm2-seq,1 dm2-client,1 dm2-client,2 ' ] ||
    { cat out; fail "keyed runs"; }
grep -q "$one" keyed/n400-servers2-1/timing.csv || fail "the run was not on the servers that were named"
expect_status 3 "$model" netbench --hosts hosts -n 1 --turns 4
expect_text err 'refuses the connection: it wants a key (--key FILE), or does not admit this machine'
expect_text "$locked" 'the client sent HELLO where KNOCK is due'
expect_status 3 "$model" calibrate --hosts hosts --key other -n 1 --n 400 --runs 1 --steps 3 --turns 4 \
    --deck timing.dm2 -f none.csv
expect_text err 'it has another key'
[ ! -e none.csv ] || fail "a calibration file of a refusal"
expect_status 3 "$model" compare --hosts hosts -n 1 --n 400 --runs 1 --steps 3 --deck timing.dm2 -o none \
    --calibration keyed.csv
expect_text err 'refuses the connection'
[ ! -s out ] || fail "compare printed something before it failed"
expect_status 2 "$model" netbench --key key -n 1
expect_text err '--key is for servers of --hosts or --server'
start_server --allow 10.0.0.0/8
expect_status 3 "$model" netbench --server "$SERVER_ADDR" --turns 4
expect_text "$SERVER_LOG" 'not among those of --allow'

# calibrate: predict reads the file, and the file has the measured constants.
expect_status 0 "$model" calibrate --n 400,800 --runs 2 --steps 3 --turns 4 -n 1,2 --deck timing.dm2 -f \
    here.csv -o runs
expect_text out 'written to here.csv'
[ -s runs/n400-seq-2/run.log ] && [ ! -e runs/n400-seq-2/final.dm2 ] ||
    fail "the runs are not as they should be"
expect_status 0 "$model" predict --preset ./here.csv --n 1000 --servers 2 --csv
expect_text here.csv 'networks,,2,'
expect_text here.csv 'sizes,,2,'

# compare: the sweep, and the same runs read back, which give the same numbers.
expect_status 2 "$model" compare --n 400 --deck timing.dm2
expect_text err 'dm2-model calibrate measures them'
expect_status 0 "$model" compare --n 400,800 --runs 2 --steps 4 -n 1,2 --deck timing.dm2 -o sweep \
    --calibration here.csv --csv
[ "$(sed 1d out | cut -d , -f 1,3,4 | tr '\n' ' ')" = \
    'dm2-seq,1,2 dm2-client,1,2 dm2-client,2,2 dm2-seq,1,2 dm2-client,1,2 dm2-client,2,2 ' ] ||
    { cat out; fail "these are not the cases"; }
awk -F , 'NR > 1 && !($5 > 0 && $6 > 0 && $9 > 0 && $11 > 0) { exit 1 }' out ||
    fail "a number that is not positive"
LC_ALL=C sort out >swept
expect_status 0 "$model" compare sweep/*-1 sweep/*-2 --calibration here.csv --csv
LC_ALL=C sort out >read
cmp swept read || { diff swept read; fail "finished runs give other numbers"; }
expect_status 0 env DM2_CALIBRATION=here.csv "$model" compare sweep/n400-seq-1 sweep/n400-servers2-1
expect_text out 'error %'

# Mistakes.
expect_status 1 "$model" compare nowhere --calibration here.csv
expect_text err nowhere/run.log
mkdir empty
echo 'program: dm2-client' >empty/run.log
expect_status 2 "$model" compare empty --calibration here.csv
expect_text err 'is not the log of a finished run'
expect_status 2 "$model" calibrate --n 0 --deck timing.dm2
expect_text err "--n '0'"
expect_status 2 "$model" netbench -n 0
expect_text err "--servers '0'"
expect_status 2 "$model" netbench -n 2 --server 127.0.0.1:1
expect_text err 'only 1 are named'
expect_status 2 "$model" calibrate --n 400 --runs 1 --deck missing.dm2 -f none.csv
expect_text err 'missing.dm2'
[ ! -e none.csv ] || fail "a calibration file of nothing"

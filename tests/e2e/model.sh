# dm2-model predict and what-if: the CSV that scripts rely on, the paper's numbers, and refused command lines.
. "$DM2_SRC/tests/lib.sh"

model=$DM2_BIN/dm2-model

# field FILE ROW COLUMN: one field of a CSV file, row 1 below the header.
field()
{
    sed -n -e "$(($2 + 1))p" "$1" | cut -d , -f "$3"
}

# near A B TOLERANCE WHAT
near()
{
    awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a - b; exit !(a != "" && d <= t && d >= -t) }' ||
        fail "$4 is '$1', expected $2"
}

# refused TEXT ARGUMENT...: exit status 2, nothing on standard output, the text in the message.
refused()
{
    text=$1
    shift
    expect_status 2 "$model" "$@"
    expect_text err "$text"
    [ ! -s out ] || fail "dm2-model $* printed something before it failed"
}

# --- the paper's numbers
expect_status 0 "$model" predict --preset paper --n 100000 --aspect 1.3571 --csv
[ "$(sed -n 1p out)" = 'n,s,servers,p_x,p_y,t_seq,t_comm,t_dist,speedup,efficiency' ] ||
    fail "the header is wrong"
[ "$(wc -l <out)" -eq 4 ] || fail "a header and three rows were expected"
cp out paper.csv
for row in 1 2 3; do
    near "$(field paper.csv $row 1)" 100000 0 n
    near "$(field paper.csv $row 2)" 1.3571 0 s
    near "$(field paper.csv $row 4)" 1197.49 0.01 p_x
    near "$(field paper.csv $row 5)" 882.39 0.01 p_y
    near "$(field paper.csv $row 6)" 33.16 1e-9 t_seq
done
near "$(field paper.csv 1 3)" 2 0 servers
near "$(field paper.csv 2 3)" 4 0 servers
near "$(field paper.csv 3 3)" 8 0 servers
near "$(field paper.csv 1 9)" 1.966 0.0005 "the speedup of 2 servers"
near "$(field paper.csv 2 9)" 3.698 0.0005 "the speedup of 4 servers"
near "$(field paper.csv 3 9)" 6.105 0.0005 "the speedup of 8 servers"
near "$(field paper.csv 3 10)" 0.76314 0.00001 "the efficiency of 8 servers"
near "$(field paper.csv 3 8)" 5.43151 0.00001 "t_dist of 8 servers"
near "$(field paper.csv 3 7)" 1.28651 0.00001 "t_comm of 8 servers"

# --- lists, other numbers of servers, the table for people
expect_status 0 "$model" predict --n 1689,1e4 --n 50000 --servers 1,3,16 --csv
[ "$(wc -l <out)" -eq 10 ] || fail "a header and nine rows were expected"
near "$(field out 1 9)" 1 0 "the speedup of one server"
expect_status 0 "$model" predict --n 1689 --servers 2,3
expect_text out 'T_seq 560.07 ms'
expect_text out 'g*'
expect_text out 'general form'

# --- options change what they say
expect_status 0 "$model" predict --n 100000 --servers 8 --transport peer --csv
near "$(field out 1 7)" 0.643252 0.000001 "t_comm of 8 peers"
expect_status 0 "$model" predict --n 100000 --servers 4 --m 4=1e-6 --b 0 --csv
near "$(field out 1 7)" 0.0915148 0.0000001 "t_comm with another m and b"
expect_status 0 "$model" predict --n 100000 --servers 4 --overlap 1 --csv
near "$(field out 1 8)" 8.29 1e-9 "t_dist with hidden communication"

# --- what-if
expect_status 0 "$model" what-if --csv --n 100000
[ "$(sed -n 1p out)" = 'case,n,s,servers,t_seq,t_comm,t_dist,speedup,efficiency' ] ||
    fail "the header is wrong"
[ "$(cut -d , -f 1 out | tr '\n' ' ')" = 'case as-is processors-x10 peer-to-peer network-x10 network-x100 ' \
    ] ||
    fail "the cases are wrong"
near "$(field out 1 8)" 6.105 0.0005 "the speedup as it is"
near "$(field out 2 8)" 1.949 0.0005 "the speedup with faster processors"
near "$(field out 3 8)" 6.925 0.0005 "the speedup of peers"
near "$(field out 4 8)" 7.759 0.0005 "the speedup with Fast Ethernet"
near "$(field out 5 8)" 7.975 0.0005 "the speedup with Gigabit Ethernet"
expect_status 0 "$model" what-if --csv --table break-even --servers 2 --network 3
near "$(field out 1 4)" 91 0 "the break-even of 2 servers"
expect_text out 'network-x3,'
expect_status 0 "$model" what-if --csv --table best --n 1689 --most 8
near "$(field out 1 4)" 4 0 "the best number of servers"
expect_status 0 "$model" what-if
expect_text out 'Best number of servers'

# --- calibration files
host=$(uname -n)
version=$("$model" --version | cut -d ' ' -f 2)
calibration()
{
    printf '%s\n' quantity,servers,value,unit format,,2, "host,,$1," "version,,$2," d_x,,0.04,cm \
        d_y,,0.03464,cm \
        L_x,,0.121,cm L_y,,0.121,cm g,,88,byte k,,1e-06,s k_spread,,0,s sizes,,0, networks,,1, \
            m,2,1e-09,s/byte \
        b,2,1e-05,s residual,2,0,s
}
calibration "$host" "$version" >dm2-calibration.csv
calibration elsewhere "$version" >other-host.csv
calibration "$host" 0.0.1 >other-version.csv
expect_status 0 "$model" predict --preset here --n 100000 --servers 2 --csv
near "$(field out 1 6)" 1.05666 0.00001 "t_seq by the calibration"
mv dm2-calibration.csv moved.csv
refused 'no calibration file dm2-calibration.csv' predict --preset here --n 1000
expect_status 0 env DM2_CALIBRATION=moved.csv "$model" predict --preset here --n 1000 --servers 2
expect_status 0 "$model" predict --preset ./moved.csv --n 1000 --servers 2
refused "on the host 'elsewhere', this is" predict --preset other-host.csv --n 1000
refused 'with dm2 0.0.1, this is' predict --preset other-version.csv --n 1000
printf 'quantity,servers\n' >bad.csv
refused 'bad.csv:1:' predict --preset bad.csv --n 1000

# --- bad input
refused 'a command is missing'
refused "the command 'predicts' is not known" predicts
refused 'needs a number of elements' predict
refused "'1000' is not an option" predict 1000
for n in 0 -5 1.5 abc '' nan inf 1e16 '1000,' 0x10; do
    refused "--n '" predict --n "$n"
done
for aspect in 0 -1 x nan inf 1e9 ''; do
    refused aspect predict --n 1000 --aspect "$aspect"
done
refused '8 servers for a grid of 4 cells' predict --n 45
refused '500 servers for a grid of 160 cells (16 x 10)' predict --n 1689 --servers 500 --aspect 1.7
refused "--servers '0'" predict --n 1000 --servers 0
refused "--servers '70000'" predict --n 1000 --servers 70000
refused "--preset 'papr'" predict --preset papr --n 1000
refused "--dx '4x'" predict --n 1000 --dx 4x
refused 'd_x = 0' predict --n 1000 --dx 0
refused 'd_y = -1' predict --n 1000 --dy -1
refused 'L_x = 1e+40' predict --n 1000 --lx 1e40
refused "--ly 'inf'" predict --n 1000 --ly inf
refused 'k = 0' predict --n 1000 --k 0
refused 'g = 0' predict --n 1000 --g 0
refused 'm = -1' predict --n 1000 --m -1
refused "--b 'x'" predict --n 1000 --b 2=x
refused 'has m but no b' predict --n 1000 --m 16=1e-5
refused "--transport 'pigeon'" predict --n 1000 --transport pigeon
refused "--count 'sheep'" predict --n 1000 --count sheep
refused "--overlap 'some'" predict --n 1000 --overlap some
refused 'overlapping share' predict --n 1000 --overlap 1.5
refused "--periodic 'z'" predict --n 1000 --periodic z
refused 'has to say how many' predict --n 1000 --migrant-bytes 100
refused 'does not go with --transport peer' predict --n 1000 --client-rate 1e6 --transport peer
refused '--client-rate' predict --n 1000 --client-rate 0
refused "--table 'all'" what-if --table all
refused "--processors 'fast'" what-if --processors fast
refused "--network '0'" what-if --network 0
refused "--most '0'" what-if --most 0
refused 'compares 2 and more' what-if --servers 1
refused '8 servers for a grid' what-if --n 40
expect_status 1 sh -c '"$1" predict --n 1000 >/dev/full' sh "$model"
expect_text err 'standard output'

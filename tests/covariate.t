#!/bin/sh
# --covariate of aopf and rwl: a column that scales the wear rate
. "$(dirname "$0")/tap.sh"

# wears SEED POWER: wear as the power of a load that is 1, but 2 in every third block of
# eight rows and from row 80 on, up to the threshold of 1; noise of 1 %.  It ends at 120.
wears() {
	awk -v seed="$1" -v p="$2" 'BEGIN { srand(seed); print "t\ty\tload"; for (t = 0; d < 1; t++) {
		x = t >= 80 || int(t / 8) % 3 == 2 ? 2 : 1
		if (t > 0) d += x ^ p / (56 + 64 * 2 ^ p)
		z = 0
		for (k = 0; k < 12; k++) z += rand()
		printf "%d\t%.6f\t%g\n", t, d + 0.01 * (z - 6), x } }'
}
lives() { aopf --threshold 1 --direction up --lives-only "$@"; }
# of all paths at row 84, the life ahead of which is 36: mean absolute error of the median,
# mean width of the interval, and the number of intervals that contain the life
judge() {
	awk -F '\t' '$1 == 84 { e = $4 - 36; error += e < 0 ? -e : e; width += $5 - $3
		hit += $3 <= 36 && 36 <= $5; n++ }
		END { print error / n, width / n, hit, n }' "$@"
}
for p in 0 3; do
	for s in 1 2 3 4 5 6 7 8; do
		wears $s $p >path
		lives path >plain.$p.$s
		lives --covariate load:2 path >known.$p.$s
		lives --covariate load:last path >last.$p.$s
	done
	for how in plain known last; do judge $how.$p.? >$how.$p; done
done
# Where the load scales the wear by 8, the record without it is a mixture of two rates.
at_most "the error with a covariate" "$(cut -d ' ' -f 1 known.3)" 6
at_most "four times that error, against the one without" "$(cut -d ' ' -f 1 known.3 | awk '{ print 4 * $1 }')" \
	"$(cut -d ' ' -f 1 plain.3)"
at_most "twice the width with a covariate, against that without" \
	"$(cut -d ' ' -f 2 known.3 | awk '{ print 2 * $1 }')" "$(cut -d ' ' -f 2 plain.3)"
at_most "intervals with a covariate that miss the life" "$(cut -d ' ' -f 3,4 known.3 | awk '{ print $2 - $1 }')" 1
at_most "the error if the last load is to stay" "$(cut -d ' ' -f 1 last.3)" 6
# A load without influence must not harm: 4 % of the life and a tenth of the width at most.
for how in known last; do
	near "the error with a load of no influence, $how" "$(cut -d ' ' -f 1 $how.0)" "$(cut -d ' ' -f 1 plain.0)" 4
	near "the width with a load of no influence over that without, $how" \
		"$(cat $how.0 plain.0 | awk '{ w[NR] = $2 } END { print w[1] / w[2] }')" 1 0.25
	at_most "intervals with a load of no influence that miss the life, $how" \
		"$(cut -d ' ' -f 3,4 $how.0 | awk '{ print $2 - $1 }')" 1
done
# The factor: at 96 the mean of x^3 over the record is (56 + 40 * 8) / 96.
column factor_load known.3.1 >f
near "the factor of the load" "$(sed -n 97p f)" 2.04 0.3
wears 1 3 >path
near "the factor of a load in tons instead of kilograms" \
	"$(awk 'NR > 1 { $3 = 1e-3 * $3 - 7 } { print $1 "\t" $2 "\t" $3 }' path | lives --covariate load:last | column factor_load /dev/stdin | sed -n 97p)" \
	"$(sed -n 97p f)" 0.02
near "a load of 1 from now on gives eight times the life" \
	"$(lives --covariate load:1 path | awk -F '\t' '$1 == 96 { print $4 }')" 150 50
is "a load that never changes does not change a life" \
	"$(awk -F '\t' -v OFS='\t' 'NR > 1 { $3 = 5 } { print }' path | lives --covariate load | grep '^[0-9]' | cut -f 1-6 | cksum)" \
	"$(lives path | grep '^[0-9]' | cksum)"
awk -F '\t' -v OFS='\t' 'NR > 1 { $3 = 5 } { print }' path >constant.tsv
lives --covariate load:9 constant.tsv >uncertain 2>err
near "a load that is never the one assumed: the width over that without" \
	"$(cat uncertain plain.3.1 | awk -F '\t' '$1 == 96 { w[++n] = $5 - $3 } END { print w[1] / w[2] }')" 2 1
is "a warning of a load far from those of the series" "$(cat err)" \
	"aopf: --covariate load: 9 is far from the values in the series, 5 to 5"
lives --covariate load:9 path >out 2>err
is "lives under such a load are doubtful" "$? $(grep -c '^# doubtful: the future value' out)" "3 1"
is "no warning of a load near those of the series" "$(lives --covariate load:2.9 path 2>&1 >/dev/null)" ""
# Units of the covariate do not matter, even extreme ones.
for scale in 1e300 -1e-300; do
	awk -F '\t' -v OFS='\t' -v s=$scale 'NR > 1 { $3 = sprintf("%.17g", s * $3) } { print }' path |
		lives --covariate load:last | grep '^[0-9]' >scaled
	grep '^[0-9]' last.3.1 >unscaled
	same "a load times $scale" scaled unscaled
done

# goes SEED HOW: linear wear up to 60 of 100 rows; the rate is exponential in a load that
# wanders (autoregressive, .95 a row), or alternates, or constant beside one that rises.
goes() {
	awk -v seed="$1" -v how="$2" '
		function normal(k, z) { z = -6; for (k = 0; k < 12; k++) z += rand(); return z }
		BEGIN { srand(seed); print "t\ty\tload"
			for (t = 1; t <= 100; t++) {
				x = how == "wanders" ? 0.95 * x + 0.31 * normal() : how == "alternates" ? (t % 4 < 2 ? 1 : -1) : t
				load[t] = x
				sum += rate[t] = how == "rises" ? 1 : exp(0.7 * x) }
			for (t = 1; t <= 60; t++) {
				d += rate[t] / sum
				printf "%d\t%.6f\t%g\n", t, d + 0.01 * normal(), load[t] } }'
}
# Error, width and intervals as by judge, at row 60 with a life of 40 ahead; lives end at the
# horizon, ten times the age.
for how in wanders alternates rises; do
	for s in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16; do
		goes $s $how >path.$how
		lives path.$how >plain.$s
		lives --covariate load path.$how >past.$s
		lives --covariate load:mean path.$how >mean.$s
	done
	for future in plain past mean; do
		cat $future.[1-9] $future.1[0-6] | awk -F '\t' '$1 == 60 { e = $4 - 40; error += e < 0 ? -e : e
			width += ($5 == "inf" ? 600 : $5) - $3; miss += $3 > 40 || $5 < 40 } END { print error / 16, width / 16, miss + 0 }' >$future.$how
	done
done
# Of 16 intervals of 90 % four miss with a chance of 7 %.
at_most "intervals that miss the life where the load wanders" "$(cut -d ' ' -f 3 past.wanders)" 3
at_most "the width with the mean of a load that wanders, against that with what its past tells" \
	"$(cut -d ' ' -f 2 mean.wanders)" "$(cut -d ' ' -f 2 past.wanders)"
# A load that alternates every second row has its mean: the 40 rows ahead leave 1 / 40 of it open.
near "the error where the load alternates, against that with its mean" \
	"$(cut -d ' ' -f 1 past.alternates)" "$(cut -d ' ' -f 1 mean.alternates)" 1
near "the width where the load alternates, over that with its mean" \
	"$(cat past.alternates mean.alternates | awk '{ w[NR] = $2 } END { print w[1] / w[2] }')" 1 0.1
# The time itself explains the wear as well as its own course does.
at_most "the error with the time as a covariate" "$(cut -d ' ' -f 1 past.rises)" 4
for s in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16; do
	goes $s rises >path.rises
	lives path.rises | awk -F '\t' '$1 == 60 { print $5 - $3 }' >plain.width
	lives --covariate load path.rises | awk -F '\t' '$1 == 60 { print $5 - $3 }' >past.width
	paste past.width plain.width
done >widths
# A drift and an effect of the load are nearly alike: a few of the paths leave both open.
at_most "paths of 16 where the time as a covariate doubles the width" \
	"$(awk '!($1 < 2 * $2) { n++ } END { print n + 0 }' widths)" 3
lives --covariate load path.wanders | grep '^[0-9]' | cut -f 4 >hours
awk -F '\t' -v OFS='\t' 'NR > 1 { $1 *= 4096; $3 = 1e-200 * $3 } { print }' path.wanders |
	lives --covariate load | awk -F '\t' '/^[0-9]/ { print $4 / 4096 }' >seconds
near "the units of time and of a load that wanders do not matter: the largest difference" \
	"$(paste hours seconds | awk '{ d = $1 - $2; d = d < 0 ? -d : d; if (d < 1e9 && d > most) most = d } END { print most + 0 }')" 0 0.01

# Two covariates, of which one counts.
awk -F '\t' 'NR == 1 { print $0 "\ttemperature"; next } { print $0 "\t" 20 + (NR * 7) % 11 }' path >two.tsv
lives --covariate load:2 --covariate temperature two.tsv >two
near "the life with a second covariate" "$(awk -F '\t' '$1 == 96 { print $4 }' two)" 24 5
near "the factor of a second covariate" "$(awk -F '\t' '$1 == 96 { print $8 }' two)" 1 0.25
is "a factor for each covariate" "$(grep -v '^#' two | head -1 | cut -f 7- | tr '\t' ' ')" "factor_load factor_temperature"
is "every column has a unit" "$(sed -n 's/^# units: //p' two | wc -w | tr -d ' ')" 8

# A load-weighted clock says what the covariate learns: the lives in its time, over the rate
# at the load assumed.
awk -F '\t' 'NR == 1 { print $0 "\th"; next } { if (NR > 2) h += $3 ^ 3; print $0 "\t" h + 0 }' path >clock.tsv
near "the life by a clock of the known law" "$(lives --clock h clock.tsv | awk -F '\t' '$1 == 96 { print $4 / 8 }')" \
	"$(awk -F '\t' '$1 == 96 { print $4 }' known.3.1)" 4
near "a covariate of a clock that has it already" \
	"$(lives --clock h --covariate load clock.tsv | awk -F '\t' '$1 == 96 { print $7 }')" 1 0.15

# A monitor: resumed, several units, threads, JSON.
for u in 1 2 3; do wears $u 3 | awk -v u="u$u" 'NR > 1 && NR < 102 { print u "\t" $0 }'; done | sort -s -n -k 2 >rows
{ printf 'unit\tt\ty\tload\n'; cat rows; } >fleet.tsv
run() { lives --unit unit --covariate load:last "$@"; }
run fleet.tsv >whole
head -140 fleet.tsv | run --save state >first
{ head -1 fleet.tsv; tail -n +141 fleet.tsv; } | run --resume state --save state >second
{ grep '^u[0-9]' first; grep '^u[0-9]' second; } >parts
grep '^u[0-9]' whole >rows
same "stopping and resuming does not change the output" parts rows
run --threads 2 fleet.tsv >side
same "threads do not change the output" side whole
wears 2 3 | head -101 >alone.tsv
lives --covariate load:last alone.tsv | grep '^[0-9]' >alone
grep '^u2' whole | cut -f 2- >second
same "a unit among others has the lives it has alone" second alone
fails "a state of another covariate" 1 "state: saved with other options" \
	lives --unit unit --covariate load --resume state fleet.tsv
is "a factor in a line of JSON" "$(run --json fleet.tsv | tail -1 | sed 's/.*"factor_load":\([0-9]*\)\..*/\1/')" \
	"$(tail -1 rows | cut -f 8 | cut -d . -f 1)"
{ printf 'unit\tt\ty\n'; wears 9 3 | awk 'NR > 1 { print "old\t" $1 "\t" $2 }'; } >old.tsv
near "a covariate beside a fleet" \
	"$(lives --covariate load:2 --fleet old.tsv alone.tsv | awk -F '\t' '$1 == 96 { print $4 }')" 24 8

fails "a covariate that is missing" 1 "hole.tsv: line 31: load is missing or not finite" sh -c \
	"awk -F '\t' -v OFS='\t' 'NR == 31 { \$3 = \"nan\" } { print }' path >hole.tsv
	aopf --threshold 1 --covariate load hole.tsv"
fails "a column that does not exist" 1 "no column 'heat'" lives --covariate heat path
fails "a future that is no number" 2 "covariate load:high: want mean, last or a number after the colon" \
	lives --covariate load:high path
fails "the same covariate twice" 2 "covariate load: given twice" lives --covariate load --covariate load:last path
fails "more covariates than four" 2 "covariate: 5 columns, want at most 4" \
	lives --covariate a --covariate b --covariate c --covariate d --covariate e path
fails "a covariate for the grey model" 2 "covariate is not for --model grey" \
	aopf --threshold 1 --model grey --covariate load path
fails "a covariate without a threshold" 2 "covariate requires --threshold" aopf --covariate load path
# rwl: the same wear as a leakage
for s in 1 2 3 4; do
	wears $s 3 | awk -F '\t' 'NR == 1 { print "t\tleakage\tload"; next } { print $1 "\t" 1.5 + 1.3 * $2 "\t" $3 }' >leakage.$s
done
leak() { rwl --wear-rate filter --time-unit h --state-unit L/min --threshold-leakage 2.8L/min "$@" 2>/dev/null; }
for how in '' '--covariate load:last'; do
	for s in 1 2 3 4; do
		# shellcheck disable=SC2086 # words
		leak $how leakage.$s | awk -F '\t' '$1 == 84 * 3600 { e = $4 / 3600 - 36; print e < 0 ? -e : e, ($5 - $3) / 3600 }'
	done | awk '{ error += $1; width += $2 } END { print error / NR, width / NR, NR }' >"rwl$how"
done
is "lives of four leakages" "$(cut -d ' ' -f 3 rwl) $(cut -d ' ' -f 3 "rwl--covariate load:last")" "4 4"
at_most "the error of rwl with a covariate" "$(cut -d ' ' -f 1 "rwl--covariate load:last")" 8
at_most "twice that error, against the one without" \
	"$(awk '{ print 2 * $1 }' "rwl--covariate load:last")" "$(cut -d ' ' -f 1 rwl)"
at_most "twice the width with a covariate, against that without" \
	"$(awk '{ print 2 * $2 }' "rwl--covariate load:last")" "$(cut -d ' ' -f 2 rwl)"
awk -F '\t' 'NR % 4 == 3 { $2 = "nan" } { print $1 "\t" $2 "\t" $3 }' leakage.1 >holes
near "the life of a leakage with missing values" \
	"$(leak --covariate load:last holes | awk -F '\t' '$1 == 84 * 3600 { print $4 / 3600 }')" 36 15
fails "a covariate for a mean rate" 2 "covariate requires --wear-rate filter" \
	rwl --covariate load --time-unit h --state-unit L/min leakage.1
fails "a column that rwl does not find" 1 "no column 'heat'" \
	rwl --wear-rate filter --covariate heat --time-unit h --state-unit L/min leakage.1

done_testing

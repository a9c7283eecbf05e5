#!/bin/sh
# aopf: contracts of the stream, the filter on known series, refusals
. "$(dirname "$0")/tap.sh"

# Noisy linear rise of 1.5 to 2.8 at t = 1186 (noise 0.06), n rows from seed s.
rise() {
	awk -v n="$1" -v s="$2" 'BEGIN { srand(s); print "t\ty"
		for (t = 0; t < n; t++) {
			z = 0
			for (k = 0; k < 12; k++) z += rand()
			printf "%d\t%.6f\n", t, 1.5 + 1.3 * t / 1186 + 0.06 * (z - 6)
		} }'
}

rise 300 1 >rise.tsv
aopf --threshold 2.8 --time-unit h rise.tsv >out.tsv
is "the table has the documented columns" "$(grep -v '^#' out.tsv | head -1 | tr '\t' ' ')" \
	"t y grey prediction state order ess rul_q05 rul_q50 rul_q95 p_no_crossing"
is "every input row has an output row" "$(column t out.tsv | wc -l | tr -d ' ')" 300
aopf --threshold 2.8 --time-unit h <rise.tsv >again.tsv
column state out.tsv >a
column state again.tsv >b
same "input from a pipe gives the same states" a b
aopf --threshold 2.8 --seed 2 rise.tsv >seed2.tsv
column state seed2.tsv >b
ok "another seed gives other states" sh -c '! cmp -s a b'
is "no life is predicted without a threshold" \
	"$(aopf rise.tsv | grep -v '^#' | head -1 | tr '\t' ' ')" "t y grey prediction state order ess"
aopf rise.tsv >bare.tsv
column state bare.tsv >b
same "predicting the life does not change the states" a b

# The filter must be better than the observations: their noise is 0.06.
aopf --order 4 rise.tsv >four.tsv
column state four.tsv | awk 'NR > 60 { e = $1 - (1.5 + 1.3 * (NR - 1) / 1186); s += e * e; n++ }
	END { print sqrt(s / n) }' >rms
at_most "the error of states at order 4 is below the noise" "$(cat rms)" 0.052
column state out.tsv | awk 'NR > 60 { e = $1 - (1.5 + 1.3 * (NR - 1) / 1186); s += e * e; n++ }
	END { print sqrt(s / n) }' >rms
near "states are closer to the truth than observations" "$(cat rms)" 0.03 0.02
column ess out.tsv | awk '$1 !~ /^[0-9]/ || $1 + 0 < 1 - 1e-9 || $1 + 0 > 300 + 1e-9 { bad = 1 } END { print (NR ? bad + 0 : "no rows") }' >bad
is "the effective sample size is between 1 and N" "$(cat bad)" 0
printf 't\ty\n' | aopf >out 2>err
is "a table without rows is told" "$? $(grep -vc '^#' out) $(cat err)" '0 1 aopf: standard input: no rows'

printf '# units: h L/min\nt\ty\n0\t1\n' >unit.tsv
is "every column has a unit" "$(aopf -y 2 unit.tsv | sed -n 's/^# units: //p')" \
	"h L/min L/min L/min L/min 1 1 h h h 1"
is "a lone y column is found beside a column of machines" "$(printf '# units: 1 h L/min\nunit\tt\ty\nA\t0\t1\n' | aopf --unit unit --threshold 2 | sed -n 's/^# units: //p')" \
	"1 h L/min L/min L/min L/min 1 1 h h h 1"
is "the units of the output follow the options where the input states none" "$(grep -v '^#' unit.tsv | aopf --threshold 2 --time-unit h | sed -n 's/^# units: //p')" \
	"h 1 1 1 1 1 1 h h h 1"
# Times of options are those of the table, whether it states its unit or --time-unit does.
awk 'BEGIN { print "t\ty"; for (t = 0; t < 60; t++) print t "\t" 1 + t / 100 + (t % 3) / 300 }' >bare.tsv
{ echo '# units: h L/min'; cat bare.tsv; } >told.tsv
decide='--threshold 1.8 --mission 18h --alarm 60h,20h --skip 5h --horizon 200h'
# rows FILE: a table without its comments
rows() { grep -v '^#' "$1"; }
# shellcheck disable=SC2086 # options
{
	aopf $decide told.tsv >told.out
	aopf $decide --time-unit h bare.tsv >bare.out
}
is "options convert to the unit of the table" "$(rows told.out | cksum)" "$(rows bare.out | cksum)"
# Seconds of a series that may count hours would be a mission without a failure.
for o in '--skip 5h' '--horizon 200h' '--after 1s' '--mission 18h' '--alarm 60h,20'; do
	# shellcheck disable=SC2086 # options
	fails "$o of a series without a unit of time" 2 "${o% *} has a unit, but the series names none of its times" \
		aopf --threshold 1.8 $o bare.tsv
done
aopf --threshold 1.8 --mission 18 --alarm 60,20 bare.tsv | grep -v '^#' >a
aopf --threshold 1.8 --mission 18h --alarm 60h,20h --time-unit h bare.tsv | grep -v '^#' >b
same "without a unit, the times of options are in that of the series" a b
is "a mission may fail" "$(column p_failure told.out | awk '$1 > 0 && $1 < 1' | wc -l | awk '{ print ($1 > 0) }')" 1
fails "a time unit that contradicts the table" 2 "time-unit min contradicts '# units:' of told.tsv, h" aopf --threshold 2 --time-unit min told.tsv
printf '# units: cycle Ah\nt\ty\n0\t1\n' >cycles.tsv
is "times may be cycles" "$(aopf cycles.tsv | sed -n 's/^# units: //p')" "cycle Ah Ah Ah Ah 1 1"
fails "hours of cycles" 1 "column 't' is in 'cycle', want s, min, h or d" aopf --threshold 2 --mission 1h cycles.tsv
awk 'BEGIN { print "# units: 1 min mL/min\nunit\tt\ty"; for (t = 0; t < 101; t++) print "A\t" t * 60 "\t" 1000 + t * 11 }' >fleet.tsv
awk 'BEGIN { print "# units: 1 h L/min\nunit\tt\ty"; for (t = 0; t < 101; t++) print "A\t" t "\t" (1000 + t * 11) / 1000 }' >same.tsv
for f in fleet same; do
	aopf --threshold 2 --direction up --fleet $f.tsv told.tsv >$f.out
done
is "a fleet in other units is converted" "$(rows fleet.out | awk 'END { printf "%.5g", $9 }')" "$(rows same.out | awk 'END { printf "%.5g", $9 }')"
sed 's/mL/um/' fleet.tsv >wrong.tsv
fails "a fleet of another quantity" 1 "wrong.tsv: column 'y' is in 'um/min', want 'L/min'" \
	aopf --threshold 2 --direction up --fleet wrong.tsv told.tsv
printf 't\tevent\n20\trepair\n' >hours.tsv
printf '# units: min 1\nt\tevent\n1200\trepair\n' >minutes.tsv
for f in hours minutes; do
	aopf --threshold 2 --events $f.tsv told.tsv >$f.out
done
is "events in other units are converted" "$(rows minutes.out | cksum)" "$(rows hours.out | cksum)"
aopf --threshold 2 --save saved told.tsv >out
fails "a saved state of another unit" 1 'saved: saved with other options' aopf --threshold 2 --resume saved bare.tsv

# A first or second gap that is far smaller than the others, as of a logger that starts twice
for at in 1 2; do
	awk -v at=$at 'BEGIN { print "t\ty"; for (k = 0; k < 12; k++)
		printf "%.16g\t%.6f\n", k < at ? k : k == at ? k - 1 + 1e-12 : k - 1, 0.1 + (k - (k >= at)) / 50 }' >twice.tsv
	near "the life after four rows, gap $at being 1e-12" \
		"$(aopf --threshold 1.1 --direction up --lives-only twice.tsv | column rul_q50 /dev/stdin | sed -n 4p)" 9 2
done

# Rows come out as rows go in.
rise 40 2 >short.tsv
ok "each row is written as soon as it is read" sh -c '
	mkfifo in
	aopf in >live.tsv & p=$!
	exec 3>in
	head -21 short.tsv >&3
	for k in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
		[ "$(grep -c "^[0-9]" live.tsv)" = 20 ] && break
		sleep 0.1
	done
	n=$(grep -c "^[0-9]" live.tsv)
	exec 3>&-
	wait $p
	[ "$n" = 20 ]'

# Missing values: predicted, not weighed.
awk 'NR > 30 && NR % 5 == 0 { print $1 "\tnan"; next } { print }' rise.tsv >gaps.tsv
aopf --threshold 2.8 gaps.tsv >gaps.out
is "a missing observation is nan in the output" "$(column y gaps.out | grep -c nan)" 54
is "rows with an observation have no nan" "$(awk -F '\t' '/^[0-9]/ && $1 > 5 && $5 == "nan"' gaps.out | wc -l | tr -d ' ')" 0
awk -F '\t' '/^[0-9]/ && $2 == "nan" && $4 != $5' gaps.out >bad
is "the state of a missing row is its prediction" "$(wc -l <bad | tr -d ' ')" 0

# Units in one stream: as if each came alone, but for the random stream.
awk 'NR == 1 { print "unit\t" $0; next } { print "a\t" $0; print "b\t" $0 }' short.tsv >two.tsv
aopf --unit unit two.tsv >two.out
aopf short.tsv >one.out
awk -F '\t' '$1 == "a"' two.out | cut -f 2- >a
grep '^[0-9]' one.out >b
same "the first of two units is filtered as if it were alone" a b
awk -F '\t' '$1 == "b"' two.out | cut -f 4 >a
column grey one.out >b
same "the grey forecasts of the second unit are those of a single unit" a b
sed 's/^b/a/' two.tsv >twice.tsv
fails "a time that repeats" 1 "twice.tsv: line 3: a: time 0 comes twice" \
	aopf --unit unit twice.tsv

# Time unit and scale
awk 'NR == 1 { print; next } { print $1 * 3600 "\t" $2 }' short.tsv >seconds.tsv
aopf -y 2.8 seconds.tsv | grep -v '^#' >a
aopf -y 2.8 --time-unit h short.tsv | grep -v '^#' >b
paste a b | awk -F '\t' 'NR > 10 { d = $9 == $20 ? 0 : $9 / 3600 - $20; if (d < 0) d = -d; if (d > m || d ~ /nan/) m = d }
	END { exit !(NR > 20 && m !~ /nan/ && m < 1e-6) }'
is "times in hours and in seconds give the same life" $? 0
awk 'NR == 1 { print; next } { printf "%s\t%.17g\n", $1, $2 * 1048576 }' short.tsv >big.tsv
aopf big.tsv | grep '^[0-9]' | awk -F '\t' '{ printf "%.9g\n", $5 / 1048576 }' >a
aopf short.tsv | grep '^[0-9]' | awk -F '\t' '{ printf "%.9g\n", $5 }' >b
same "the filter does not depend on the unit of y" a b

# Levels are named by per cent, each by its own name.
is "there is a column for each level" "$(aopf -y 2.8 --levels 0,0.05,0.1,0.5,0.975,1 short.tsv | grep -v '^#' | head -1 | cut -f 8-13 | tr '\t' ' ')" \
	"rul_q00 rul_q05 rul_q10 rul_q50 rul_q97.5 rul_q100"

# With process noise far below the floor a filter of order 60 would not come back from
# values that are beyond its particles, were it not started anew from them.
"$top/scripts/synthetic-pump" 1 600 | awk '$1 >= 300 && $1 < 350 { $2 += 6 } { print $1 "\t" $2 }' |
	aopf --time-unit h --order 60 --sigma-u 0.005 --stats stray.stats >stray.tsv
awk -F '\t' '/^[0-9]/ && $1 >= 100 && ($1 < 300 || $1 >= 420) { d = $5 - (1.5 + 1.3 * $1 / 1186)
	if (d < 0) d = -d
	if (d > m || d ~ /nan/) m = d } END { print m }' stray.tsv >worst
near "a filter that diverges is corrected" "$(cat worst)" 0 0.3
ok "the correction is a restart" test "$(column restarts stray.stats)" -ge 1

# Faults of the record at 80 % of the life of made-up pumps: 5 % of the values missing, one of
# 50 off by 10 standard deviations, steps of time that vary by 30 %.  The predicted end moves by
# less than 2 % of the life, for each of 12 pumps.
for seed in $(seq 12); do
	for fault in none missing outliers jitter; do
		"$top/scripts/synthetic-pump" "$seed" 949 | awk -v fault=$fault -v seed="$seed" '
		/^#/ { next }
		/^t/ { srand(seed); print; next }
		fault == "missing" && rand() < 0.05 { $2 = "nan" }
		fault == "outliers" && $1 % 50 == 0 { at = $1 + int(50 * rand()) }
		fault == "outliers" && $1 == at { $2 += rand() < 0.5 ? -0.62 : 0.62 }
		fault == "jitter" && $1 < 948 { d = 0.3 * (2 * rand() - 1); $1 += d; $2 += d * 1.3 / 1186 }
		{ printf "%.9g\t%s\n", $1, $2 }' | aopf --time-unit h -y 2.8 --direction up --after 948h | grep -v '^#' | tail -1 | cut -f 1,9
	done | tr '\n' '\t'
	echo
done >faults
# columns: time and life left of each; three differences in per cent, the largest first
for k in 4:missing 6:outliers 8:jitter; do
	awk -v k=${k%:*} '{ d = ($k - $2) / 11.86; print d < 0 ? -d : d }' faults | sort -g | tail -1 >worst
	near "${k#*:} does not change the predicted end of life" "$(cat worst)" 0 2
	echo "# ${k#*:}: $(cat worst) % at most"
done
is "all simulated pumps are compared" "$(grep -c '^948	[0-9.]*	948	[0-9.]*	948	[0-9.]*	948	[0-9.]*	$' faults)" 12

# Order rules
aopf --order 7 rise.tsv | column order /dev/stdin | tail -1 >o
is "a fixed order is kept" "$(cat o)" 7
ok "--order insample is accepted" aopf --order insample rise.tsv

# A bad first value has the threshold approached from above.
seq 0 60 | awk '{ print $1 "\t" 5 + ($1 < 1 ? 10 : $1 / 60) }' >start.tsv
fails "a bad first value" 3 'fails after value 1 if .* from above.*--direction up' \
	aopf -y 7 --lives-only start.tsv
ok "the direction is given" aopf -y 7 --direction up --lives-only start.tsv

# A peak at 8 and a step at 12: life is over from the K-th value in a row beyond the threshold
# on, and is predicted for the other rows.
awk 'BEGIN { print "t\ty"; for (t = 0; t < 20; t++) print t "\t" (t == 8 || t >= 12 ? 3 : 1) }' >step.tsv
for k in 1 2 3 4; do
	aopf -y 2 --direction up --persist $k --stats step.stats step.tsv >/dev/null
	column lives step.stats
done >lives
is "lives are predicted unless 1, 2, 3, 4 values persist beyond the threshold" "$(tr '\n' ' ' <lives)" "11 13 14 15 "
# The end is 60 rows away, whatever a burst of five rows said of it.
awk 'BEGIN { srand(8); print "t\ty"
	for (t = 0; t < 90; t++) print t "\t" t / 150 + 0.01 * (rand() - 0.5) + (t > 40 && t < 46 ? 0.9 : 0) }' |
	aopf -y 1 --lives-only >out
is "a burst of bad values beyond the threshold is a failure while it lasts" \
	"$(awk -F '\t' '$5 == 0 { printf "%s ", $1 }' out)" "43 44 45 "
# at .6 of the life of straight wear a median is 4 % of it off, see the page
near "and is none afterwards" "$(column rul_q50 out | tail -1)" 60 15

# Ten times the 20 steps so far: an end 199 ahead is predicted, one at 201 is not.
# One family alone has no changes of regime.
awk 'BEGIN { print "t\ty"; for (t = 0; t <= 20; t++) print t "\t" t / 100 }' >line.tsv
near "the end of life within the horizon is predicted" "$(aopf --threshold 2.19 --direction up --model linear line.tsv | column rul_q50 /dev/stdin | tail -1)" 199 0.5
is "a life beyond the horizon is infinite" "$(aopf --threshold 2.21 --direction up --model linear line.tsv | column rul_q50 /dev/stdin | tail -1)" inf

# Life: noise-free exponential 1.5 exp(0.01 t) reaches 2.8 at ln(2.8 / 1.5) / 0.01
awk 'BEGIN { print "t\ty"; for (t = 0; t < 40; t++) printf "%d\t%.15g\n", t, 1.5 * exp(0.01 * t) }' >exp.tsv
# (the median is a little early: the regime may change before)
aopf --threshold 2.8 exp.tsv | column rul_q50 /dev/stdin | tail -1 >r
near "the life of an exponential series is exact" "$(cat r)" "$(awk 'BEGIN { print log(2.8 / 1.5) / 0.01 - 39 }')" 4.5
aopf -y 1.6 exp.tsv | column rul_q95 /dev/stdin | tail -1 >r
is "the life is 0 once the threshold is passed" "$(cat r)" 0
aopf -y 1 --direction down exp.tsv | column p_no_crossing /dev/stdin | tail -1 >r
near "the probability of no crossing is reported" "$(cat r)" 1 1e-9

ok "the recursion of the thesis runs" aopf -y 2.8 --model literal --particles 1000 exp.tsv
column rul_q50 out | tail -1 >r
near "the recursion continues an exponential" "$(cat r)" "$(awk 'BEGIN { print log(2.8 / 1.5) / 0.01 - 39 }')" 2

# Each model on the series it is made for, without noise: the end is at t = 100.
for shape in 'linear t / 100' 'exponential 0.12 * (exp(log(1 + 1 / 0.12) * t / 100) - 1)' \
	'power 0.3 * ((1 - (1 - (1 + 1 / 0.3) ^ -0.5) * t / 100) ^ -2 - 1)' \
	'rate -log(1 - (1 - exp(-3)) * t / 100) / 3' \
	'saturating (1 - 0.2 ^ (t / 100)) / 0.8' 'average t / 100'; do
	model=${shape%% *}
	awk "BEGIN { print \"t\\ty\"; for (t = 0; t < 51; t++) printf \"%d\\t%.15g\\n\", t, ${shape#* } }" >one.tsv
	aopf -y 1 --direction up --model "$model" one.tsv | column rul_q50 /dev/stdin | tail -1 >r
	near "the life of a $model series is predicted by the $model model" "$(cat r)" 50 0.6
	aopf -y -1 --direction down --model "$model" one.tsv >/dev/null
	awk -F '\t' 'NR == 1 { print; next } { printf "%s\t%.15g\n", $1, -$2 }' one.tsv |
		aopf -y -1 --direction down --model "$model" | column rul_q50 /dev/stdin | tail -1 >down
	is "the $model model gives the same life for a decreasing series" "$(cat down)" "$(cat r)"
done

# Work left out
aopf -y 2.8 --time-unit h --after 250h -S after.stats rise.tsv | grep '^[0-9]' >after.tsv
grep '^[0-9]' out.tsv | tail -50 >a
tail -50 after.tsv >b
same "--after gives the same lives from its time on" a b
is "--after gives no lives before its time" "$(head -250 after.tsv | cut -f 8 | sort -u)" nan
is "lives that are not predicted are counted" \
	"$(column lives after.stats) $(column lives_left_out after.stats)" "50 250"

# Run-in: a bump of a third of the way that dies out by t = 60
awk 'BEGIN { print "t\ty"; for (t = 0; t < 400; t++)
	printf "%d\t%.9g\n", t, t / 1000 + 0.3 * exp(-(t - 20) ^ 2 / 200) + 0.01 * sin(t * t) }' >bump.tsv
aopf --threshold 1 --direction up --model linear --skip 60 -S skip.stats bump.tsv >skip.tsv
is "a specified run-in is skipped" "$(column rows_skipped skip.stats)" 60
near "a specified run-in gives the same end of life" "$(column rul_q50 skip.tsv | tail -1)" 601 30
aopf --threshold 1 --direction up --model average --lives-only bump.tsv >all.tsv
near "without being told, the bank forgets a run-in" "$(column rul_q50 all.tsv | tail -1)" 601 60

# Fleet: units of one shape and different speed, with noise of 0.5 % of the way.
wear() {
	awk -v life="$1" -v rows="$2" -v seed="$3" 'BEGIN { srand(seed); for (t = 0; t < rows; t++) {
		z = 0
		for (k = 0; k < 12; k++) z += rand()
		printf "%d\t%.6f\n", t, (t / life) ^ 3 + 0.005 * (z - 6) } }'
}
{ printf 't\ty\n'; wear 100 61 1; } >unit.tsv
fleet_of() {
	printf 'unit\tt\ty\n'
	for u in $1; do wear $((70 + 20 * u)) $((75 + 20 * u)) "$u" | sed "s/^/u$u	/"; done
}
fleet_of 1 >one.tsv
fleet_of '1 2 3' >three.tsv
aopf --threshold 1 --direction up unit.tsv | column rul_q50 /dev/stdin | tail -1 >alone
aopf --threshold 1 --direction up --fleet one.tsv unit.tsv >one.out
aopf --threshold 1 --direction up --fleet three.tsv unit.tsv >three.out
near "the life is predicted with one earlier unit" "$(column rul_q50 one.out | tail -1)" 40 6
near "the life is predicted with three earlier units" "$(column rul_q50 three.out | tail -1)" 40 6
rising "three earlier units give smaller errors than none" 1 "$(column rul_q50 one.out | tail -1 | awk '{ print $1 < 40 ? 40 - $1 : $1 - 40 }')" \
	"$(awk '{ print $1 < 40 ? 40 - $1 : $1 - 40 }' alone)"
awk -F '\t' 'NR == 1 || $2 < 55' one.tsv >half.tsv
aopf --threshold 1 --direction up --fleet half.tsv --stats half.stats unit.tsv >half.out
is "a unit that has not failed is used" "$(column fleet_units_carried_on half.stats)" 1
ok "a unit that has not failed gives a prediction" test "$(column rul_q50 half.out | tail -1 | cut -d. -f1)" -ge 10
# Straight wear that accelerates at half of its life of 100: earlier units that were stopped
# before that do not tell it, and a unit that begins beyond it has not seen the way there.
knee() {
	awk -v life="$1" -v rows="$2" -v seed="$3" 'BEGIN { srand(seed); for (t = 0; t < rows; t++) {
		u = t / life
		printf "%d\t%.6f\n", t, (u < 0.5 ? u / 4 : 0.125 + 1.75 * (u - 0.5)) + 0.01 * (rand() - 0.5) } }'
}
weight_of() {
	aopf --threshold 1 --direction up --lives-only --weights --fleet "$1" bent.tsv | column weight_fleet /dev/stdin | tail -1
}
{ printf 't\ty\n'; knee 100 45 1; } >bent.tsv
{ printf 'unit\tt\ty\n'; for u in 2 3 4; do knee 80 30 $u | sed "s/^/u$u	/"; done; } >stopped.tsv
{ printf 'unit\tt\ty\n'; knee 80 85 5 | awk '$2 > 0.5 { print "late\t" $0 }'; } >late.tsv
{ printf 'unit\tt\ty\n'; knee 80 85 6 | sed 's/^/whole	/'; } >whole.tsv
rising "a unit weighs less if it was stopped early" "$(weight_of stopped.tsv)" 0.1 "$(weight_of whole.tsv)"
rising "a unit weighs less if it was first seen late" "$(weight_of late.tsv)" 0.1 "$(weight_of whole.tsv)"
# Units of one law that differ in speed alone: more of them tell no less.
many() {
	awk -v units="$1" 'BEGIN { srand(5); print "unit\tt\ty"; for (u = 1; u <= units; u++) {
		speed = exp(0.3 * (rand() - 0.5))
		for (t = 0; t <= 1200; t += 100)
			printf "u%d\t%d\t%.6g\n", u, t, (t * speed / 1000) ^ 1.7 * (1 + 0.02 * (rand() - 0.5)) } }'
}
awk 'BEGIN { srand(9); print "t\ty"; for (t = 0; t <= 600; t += 100)
	printf "%d\t%.6g\n", t, (t * 1.1 / 1000) ^ 1.7 * (1 + 0.02 * (rand() - 0.5)) }' >bent.tsv
many 200 >some.tsv
many 300 >many.tsv
rising "the weight of a fleet does not fall with its size" \
	"$(weight_of some.tsv | awk '{ print $1 - 1e-4 }')" "$(weight_of many.tsv)" 1
printf 'unit\tt\ty\na\t0\t0.1\na\t1\t0.1\n' >idle.tsv
fails "a fleet that shows no wear" 1 "idle.tsv: none of 1 units shows any wear" \
	aopf --threshold 1 --direction up --fleet idle.tsv unit.tsv
fails "a fleet without a direction" 2 "fleet requires" aopf --threshold 1 --fleet one.tsv unit.tsv

# Refusals
printf 't\ty\n0\t1\n2\t1\n1\t1\n' >fall.tsv
fails "a time that falls" 1 "fall.tsv: line 4: time 1 comes after 2" aopf fall.tsv
printf 't\tx\n0\t1\n' >noy.tsv
fails "no y" 1 "no column 'y'" aopf noy.tsv
printf 't\ty\n0\tinf\n' >inf.tsv
fails "an infinite y" 1 "line 2: y is infinite" aopf inf.tsv
printf 't\ty\nnan\t1\n' >nant.tsv
fails "a missing time" 1 "line 2: time is missing" aopf nant.tsv
fails "order below four" 2 "order" aopf --order 3 exp.tsv
fails "levels that fall" 2 "levels" aopf --levels 0.5,0.1 exp.tsv
fails "a column of units that is missing" 1 "no column 'unit'" aopf --unit unit exp.tsv

awk 'BEGIN { print "t\ty"; for (i = 0; i < 30; i++) print i "\t" (i % 2 ? "" : "-") "1.7e308" }' >enormous.tsv
ok 'values that overflow are accepted' aopf -y 5 --lives-only enormous.tsv
aopf -y 5 --lives-only enormous.tsv >out 2>err
awk '$1 == 28' out >last
awk 'NR == 1 || $2 < 0' enormous.tsv | aopf -y 5 --lives-only | awk '$1 == 28' >want
ok 'values that overflow are outliers: the others alone give the same life' cmp last want
# A sensor at its ceiling says nothing: the wear goes on.
awk 'BEGIN { srand(7); print "t\ty"
	for (t = 0; t < 80; t++) { y = t / 100 + 0.01 * (rand() - 0.5); print t "\t" (y > 0.6 ? 0.6 : y) } }' >ceiling.tsv
fails "a sensor at its ceiling" 3 "the last values are equal: the sensor sticks" aopf -y 1 --lives-only ceiling.tsv
aopf -y 1 --lives-only ceiling.tsv >out 2>err
near "the life goes on below the ceiling of a sensor" "$(column rul_q50 out | tail -1)" 20 8
awk 'BEGIN { srand(8) } { print (NR == 1 || $1 < 60 ? $0 : $1 "\t" 0.6 + 0.01 * (rand() - 0.5)) }' ceiling.tsv >dither.tsv
aopf -y 1 --lives-only dither.tsv >out 2>err
ok "but not where readings that vary show no more wear" awk '!/^#/ && $1 == 79 { exit !($4 > 60) }' out
fails "a sensor at its ceiling with noise behind it" 3 "the values have ceased to approach the threshold" aopf -y 1 --lives-only dither.tsv
awk '{ print $1 "\t" (NR == 1 ? $2 : 1 - $2) }' dither.tsv >floor.tsv
fails "a sensor at its floor" 3 "the values have ceased to approach the threshold" aopf -y 0 --lives-only floor.tsv
# lost HOW: readings of straight wear that are lost at row 40, or shifted by a repair
lost() {
	awk -v how="$1" 'BEGIN { srand(8); print "t\ty"; for (t = 0; t < 90; t++) {
		y = t / 100
		if (t >= 40) y = how == "dead" ? 0 : how == "fading" ? 0.4 * exp((40 - t) / 10) : y - 0.2
		print t "\t" y + 0.01 * (rand() - 0.5) } }'
}
for how in dead fading; do
	lost $how >lost.tsv
	fails "a $how sensor with noise behind it" 3 "the values have ceased to approach the threshold" \
		aopf -y 1 --direction up --lives-only lost.tsv
done
is "wear that goes on after a repair" "$(lost repaired | aopf -y 1 --direction up --lives-only 2>&1 >out)" ""
is "nor does a burst of outliers look like a fall" "$(awk 'BEGIN { srand(8); print "t\ty"; for (t = 0; t < 60; t++)
	print t "\t" t / 100 + 0.01 * (rand() - 0.5) + (t > 27 && t < 36 ? 0.8 : 0) }' | aopf -y 1 --direction up --lives-only 2>&1 >out)" ""
# slower RATE: the readings of a unit whose rate is RATE from row 60 on
slower() {
	awk -v rate="$1" 'BEGIN { srand(8); print "t\ty"; for (t = 0; t < 90; t++)
		print t "\t" (t < 60 ? t / 100 : 0.6 + rate * (t - 60) / 100) + 0.01 * (rand() - 0.5) }'
}
is "wear at a third of its rate goes on" "$(slower 0.33 | aopf -y 1 --lives-only 2>&1 >out)" ""
is "a unit without wear has not stopped" "$(awk 'BEGIN { srand(9); print "t\ty"; for (t = 0; t < 400; t++) print t "\t" rand() / 50 }' |
	aopf -y 1 --direction up --lives-only 2>&1 >out)" ""
# burst BY: straight wear with 20 values that are BY too large
burst() {
	awk -v by="$1" 'BEGIN { srand(3); print "t\ty"; for (t = 0; t < 80; t++)
		print t "\t" t / 100 + 0.01 * (rand() - 0.5) + (t >= 55 && t < 75 ? by : 0) }'
}
for by in -0.8 0.3 2; do
	burst $by | aopf -y 1 --lives-only >out 2>err
	near "20 values $by off are forgotten" "$(column rul_q50 out | tail -1)" 20 3
done
# A rate that trebles in quiet data is followed, and not taken for outliers or jumps.
awk 'BEGIN { srand(5); print "t\ty"
	for (t = 0; t < 97; t++) print t "\t" (t < 76 ? t / 200 : 0.38 + (t - 76) / 40) + 0.002 * (rand() - 0.5) }' |
	aopf -y 1 --lives-only >out
ok "a knee in quiet data is followed" awk '!/^#/ && $1 == 96 { exit !($4 < 20) }' out
ok "while rows are held back the end may be near" awk '!/^#/ && $1 == 82 { exit !($3 < 20) }' out
# Rounded readings repeat too, and count.
awk 'BEGIN { print "t\ty"; for (t = 0; t < 80; t++) print t "\t" int(t / 16) / 6 }' | aopf -y 1 --lives-only >out
ok "coarse readings of an end at 96 hold it" awk '!/^#/ && $1 == 79 { exit !(3 < $3 && $3 < 17 && 17 < $5) }' out

# steps LAST: readings that move every 30 rows, but not after row LAST
steps() {
	awk -v last="$1" 'BEGIN { print "t\ty"; for (t = 0; t < 141; t++)
		print t "\t" int((t < last ? t : last) / 30) / 8 }'
}
steps 200 >steps.tsv
is "readings that are equal as often as before do not stick" "$(aopf -y 1 --lives-only steps.tsv 2>&1 >out)" ""
steps 30 >stuck.tsv
fails "those that are equal much longer do" 3 "the sensor sticks" aopf -y 1 --lives-only stuck.tsv

# mixed MANY: the readings of MANY machines in turn, as one series
mixed() {
	awk -v many="$1" 'BEGIN { srand(4); print "t\ty"; for (t = 0; t < 100; t++)
		print t "\t" t / 200 * (1 + t % many) + 0.02 * (rand() - 0.5) }'
}
mixed 2 >mixed.tsv
# and of two in random order
awk 'BEGIN { srand(4); print "t\ty"; for (t = 0; t < 100; t++)
	print t "\t" t / 200 * (1 + (rand() < 0.4)) + 0.02 * (rand() - 0.5) }' >random.tsv
fails "two machines in one series" 3 "the values alternate between two courses: those of two machines" \
	aopf -y 1 --lives-only mixed.tsv
fails "two machines in random order" 3 "alternate between two courses" aopf -y 1 --lives-only random.tsv
ok "one machine" sh -c "aopf -y 1 --lives-only 2>err >out <<-END && ! grep . err
$(mixed 1)
END"
printf 'unit\tt\ty\na\t0\t1\na\t1\t1\nb\t2\t1\n' >units.tsv
fails "two units that no option tells apart" 1 "units.tsv: line 4: unit 'b' after 'a': want rows of one unit" aopf units.tsv
ok "a single one needs no option" sh -c 'head -3 units.tsv | aopf'

# rescale FACTOR: a series whose unit changes at row 60
rescale() {
	awk -v f="$1" 'BEGIN { srand(9); print "t\ty"
		for (t = 0; t < 100; t++) print t "\t" (1 + t / 100 + 0.02 * (rand() - 0.5)) * (t < 60 ? 1 : f) }'
}
rescale 0.0393701 >inch.tsv
fails "a change of unit" 3 "at time 67 are 0.04.* times those before, and so are their steps" aopf -y 3 --lives-only inch.tsv
is "lives end three rows after a change of unit" "$(aopf -y 3 --lives-only inch.tsv 2>err | awk '$3 == "nan" { print $1 }' | sed -n '4p')" 62
# Until then the values may be outliers: the unit has not become as good as worn out.
awk 'BEGIN { print "t\ty"; for (t = 0; t < 64; t++)
	printf "%d\t%.6f\n", t, (0.4 + t / 150 + 0.01 * (t * 7 % 13 / 12 - 0.5)) * (t < 60 ? 1 : 10) }' >decuple.tsv
for seed in 1 2 3 4 5 6; do
	aopf -s $seed -y 6 --direction up --lives-only decuple.tsv 2>err
done | awk '$1 >= 59 && $1 < 62 { sum[$1] += $3 } END { for (t = 59; t < 62; t++) print sum[t] / 6 }' >early
at_most "half the early quantile before a change of unit, against the next two rows" \
	"$(awk 'NR == 1 { print $1 / 2 }' early)" "$(sed 1d early | sort -g | head -1)"
printf 't\tevent\n60\trepair\n' >changed.tsv
ok "a repair at that time explains it" aopf -y 3 --lives-only --events changed.tsv inch.tsv
rescale 1000 | aopf -y 3 --lives-only >out 2>err
is "a jump of the unit is no failure" "$(column rul_q50 out | tail -1)" nan
is "not even while it is uncertain, not in one life of twenty" "$(column rul_q05 out | grep -c '^0$')" 0
rescale 1000 | head -64 >begun.tsv
fails "a series that ends then" 3 "their unit or the gain may have changed" aopf -y 3 --lives-only begun.tsv
rescale 1 | awk 'NR > 60 { $2 += $1 < 60 ? 0 : 3 } { print $1 "\t" $2 }' >jump.tsv
fails "a jump beyond the threshold" 3 "the last 40 values are beyond the threshold, but the trend may not be" aopf -y 3 --lives-only jump.tsv
is "a jump beyond the threshold is a failure" "$(aopf -y 3 --lives-only jump.tsv 2>err | column rul_q95 /dev/stdin | grep -c '^0$')" 38
# Three readings beyond the threshold by their noise: the trend is at 0.95.
noisy() {
	awk -v last="$1" 'BEGIN { srand(1); print "t\ty"; for (t = 0; t < last; t++)
		print t "\t" t / 100 + (t > 92 && t < 96 ? 0.12 : 0.3 * (rand() - 0.5)) }'
}
noisy 96 >noisy.tsv
fails "noise beyond the threshold" 3 "the last 3 values are beyond the threshold, but the trend may not be" \
	aopf -y 1 --lives-only noisy.tsv
is "a trend beyond the threshold" "$(noisy 130 | aopf -y 1 --lives-only 2>&1 >out)" ""
rescale 1 | awk 'NR > 60 { $2 -= 1.4 } { print $1 "\t" $2 }' | aopf -y 3 --lives-only >out 2>err
is "a repair changes no unit" "$(column rul_q50 out | tail -1 | grep -c nan; cat err)" 0
# Rows at decades of the age: each forecast reaches nine times as far as all rows before it,
# and no exponential is worth more than the last value, which is 0.1 below the next.  The
# particles add their spread; a model of order 4 would be off by more than 2.
awk 'BEGIN { srand(3); print "t\ty"
	for (i = 0; i < 20; i++) print 10 ^ i "\t" 1 + 0.1 * i + 0.02 * (rand() - 0.5) }' >decades.tsv
aopf decades.tsv >out
at_most "the error of a forecast a decade ahead" \
	"$(awk '!/^#/ && $1 >= 10 { d = $4 - $2; print d < 0 ? -d : d }' out | sort -g | tail -1)" 0.5
at_most "the error of the state then" \
	"$(awk '!/^#/ && $1 >= 1 { d = $5 - $2; print d < 0 ? -d : d }' out | sort -g | tail -1)" 0.05
is "the order is 1 then" "$(column order out | tail -1)" 1
# Wear that began beyond its threshold would never end with the direction of the first value.
awk 'BEGIN { print "t\ty"; for (t = 0; t < 12; t++) print t "\t" 5 + t / 10 }' >passed.tsv
fails "a threshold that had been passed before" 3 "recede from the threshold, and no life ends: --direction up" \
	aopf -y 3 --lives-only passed.tsv
awk '{ $2 = $2 == "y" ? "y" : 8 - $2 } 1' OFS="\t" passed.tsv >receding.tsv
fails "values that recede with the direction given" 3 "recede from the threshold, and no life ends" \
	aopf -y 5 --direction up --lives-only receding.tsv
ok "a direction that is given is right" aopf -y 3 --direction up --lives-only passed.tsv
# counter WIDTH LEAST SPREAD: a counter of this width, which advances by LEAST to LEAST + SPREAD
counter() {
	awk -v width="$1" -v least="$2" -v spread="$3" 'BEGIN { srand(2); print "t\ty"
		for (t = 0; t < 260; t++) { n += least + int(spread * rand()); print t "\t" n % width } }'
}
# 330 a row: 65536 is passed at row 198, and three rows later no life is predicted.
counter 65536 300 60 >binary.tsv
aopf -y 90000 --lives-only binary.tsv >out 2>err
is "a counter of 16 bits that wraps: status" "$?" 3
is "it is named" "$(grep -c 'where those before would have reached 65536: .* a counter seems to have wrapped' err)" 1
is "lives end three rows after it has wrapped" \
	"$(awk -F '\t' '$2 + 0 < last { from = NR } { last = $2 + 0 } /nan/ && from { print NR - from; exit }' out)" 2
awk -F '\t' '{ print } $2 + 0 < last { n = 1 } n && n++ == 4 { exit } { last = $2 + 0 }' binary.tsv >begun.tsv
fails "a series that ends then" 3 "or a counter has wrapped" aopf -y 90000 --lives-only begun.tsv
counter 1000 30 6 >decimal.tsv
fails "a decimal counter that wraps" 3 "would have reached 1000:" aopf -y 20000 --lives-only decimal.tsv
awk -F '\t' '$1 > 5 && $2 < last { print "t\tevent"; print $1 "\trepair"; exit } { last = $2 }' binary.tsv >reset.tsv
ok "a repair at that time explains a counter that starts again" \
	aopf -y 90000 --lives-only --events reset.tsv binary.tsv
ok "nor is a unit that is replaced close to its end a counter" aopf -y 65536 --lives-only binary.tsv
awk -F '\t' 'NR < 150 { print; last = $2 } NR >= 150 && NR < 190 { print $1 "\t" $2 - last - 300 }' binary.tsv >replaced.tsv
ok "nor is one that is replaced elsewhere" aopf -y 90000 --lives-only replaced.tsv
# A series that starts at a known moment.
{
	printf '# start: 2026-01-02T03:04:05Z\nt\ty\n'
	i=0
	for y in 0.1 0.11 0.12 0.13 0.14 0.15; do
		printf '%s\t%s\n' "$i" "$y"
		i=$((i + 3600))
	done
} >started.tsv
is "the start of a series is carried to the lives" "$(aopf --threshold 0.3 started.tsv 2>err | grep '^# start')" "# start: 2026-01-02T03:04:05Z"

# Scores of series: one that the program fails on is named, and the status tells.
mkdir series failing
for name in a_1 a_2; do
	{
		printf '# failure threshold: 2.8 up\n# eol_interpolated: 1186\n# units: t: hours; y: flow\n'
		rise 1000 "${name#a_}" | awk 'NR == 1 || NR % 20 == 0'
	} >series/$name.tsv
done
# shellcheck disable=SC2016 # of the program that is made
printf '#!/bin/sh\ncase $* in *a_2.tsv*) kill -9 $$ ;; esac\nexec "%s" "$@"\n' "$(command -v aopf)" >failing/aopf
chmod +x failing/aopf
BIN=$(dirname "$(command -v aopf)") "$top/scripts/validate-life" series >out
is "every series is scored" "$? $(awk '$2 == "all" { print $4 }' out | tr '\n' ' ')" "0 2 2 2 6 "
fails "a program that is killed" 1 "series/a_2.tsv: average: left out: aopf failed with status 137" \
	env BIN="$PWD/failing" "$top/scripts/validate-life" series
awk 'NR < 4 || $1 > 600' series/a_2.tsv >series/a_1.tsv
fails "a series without rows at 40 % of its life" 1 "series/a_1.tsv: average: left out: no prediction at one of 40,60,80 %" \
	env BIN="$(dirname "$(command -v aopf)")" "$top/scripts/validate-life" series
done_testing

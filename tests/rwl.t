#!/bin/sh
# rwl - remaining wear life: closed forms, criteria, rates, streams, refusals
. "$(dirname "$0")/tap.sh"

rows() { grep -v '^#' "$1" | sed 1d; }
# calc EXPRESSION: its value by awk, all digits
calc() { awk "BEGIN { printf \"%.15g\", $1 }"; }
# cell FILE ROW COLUMN: a cell by the name of its column
cell() { column "$3" "$1" | sed -n "$2p"; }

# One class of fragments that are equal but for 1e-11: 1e-15 m3 per step on 1e-8 m2 is 1e-7 m
# of gap per step.
awk 'BEGIN { print "realisation\tstep\tvolume"; for (r = 0; r < 20; r++) for (k = 1; k <= 2; k++)
	printf "%d\t%d\t%.12fe-15\n", r, k, 1 + (r % 2 - 0.5) * 1e-11 }' >even.tsv
printf 't\tgap\n0\t10e-6\n3600\t11e-6\n7200\tnan\n10800\t13e-6\n14400\t20e-6\n' >gap.tsv

ok "equal fragments give the exact life" rwl --wear even.tsv --step-time 1h --threshold-gap 15um gap.tsv
cp out even.out
# (15 - 10) um at 0.1 um per hour
near "the life is the remaining volume over the rate" "$(cell even.out 1 mean)" 180000 1e-5
near "all quantiles of equal fragments are equal" "$(cell even.out 1 q05)" "$(cell even.out 1 q95)" 1e-5
near "without an observation the last prediction is continued" "$(cell even.out 3 mean)" \
	"$(calc "39 * 3600")" 1e-5
is "beyond the threshold the life is 0" "$(cell even.out 5 mean) $(cell even.out 5 p_no_failure)" "0 0"
ok "a volume threshold is converted to a gap" rwl --wear even.tsv --step-time 1h --threshold-volume 2.3463e-9m3 gap.tsv
near "a volume is one um over the whole area" "$(cell out 1 mean)" 36000 1e-5

# Without fragments: (4-29) over all, (4-28) over the last interval.
ok "--wear-rate mean uses the mean rate of the observations" rwl --threshold-gap 15um gap.tsv
near "2 um at 1 um/h give 2 h" "$(cell out 4 mean)" 7200 1e-6
head -n 1 gap.tsv | rwl --threshold-gap 15um >norows 2>err
like "a state without rows is told" "$? $(cat err)" '^0 rwl: standard input: no rows'
is "one observation gives no prediction" "$(cell out 1 mean)" nan
ok "--wear-rate last uses the last rate of the observations" rwl --wear-rate last --threshold-gap 21um gap.tsv
near "1 um at 7 um/h gives 1/7 h" "$(cell out 5 mean)" "$(calc 3600/7)" 1e-6

# The scale of the steps from the state: the mean wears what was observed.
ok "steps are scaled by the state" rwl --wear even.tsv --threshold-gap 15um gap.tsv
near "2 um at 1 um/h give 2 h again" "$(cell out 4 mean)" 7200 1e-6
# twin FILE: the same unit at a rate that differs by 1e-9, since one does not tell how units differ
twin() { awk '/^[0-9]/ { printf "%.17g\t%s\n", $1 * (1 + 1e-9), $2; next } { print }' "$1" >"twin.$1"; }
twin gap.tsv
ok "steps are scaled by earlier units" rwl --new --wear even.tsv --threshold-gap 15um --calibrate gap.tsv --calibrate twin.gap.tsv
# least-squares slope of 10 11 13 20 um at 0 1 3 4 h: 2.2 um/h, new at 1.5 L/min
near "the earlier unit is used over its whole life" "$(cell out 1 mean)" "$(calc "(15 - 16.7899943 * (1.5 / 2.8)^(1/3)) / 2.2 * 3600")" 0.1

# Leakage: 2.8 L/min is the default threshold, 16.79 um.
printf 't\tstate\n0\t1.5\n100\t2.0\n200\t2.9\n' >flow.tsv
ok "leakage in L/min and times in hours are accepted" rwl --wear even.tsv --step-time 1h --state-unit L/min --time-unit h flow.tsv
near "the gap is the cube root of the leakage" "$(cell out 2 mean)" \
	"$(calc "16.7899943 * (1 - (2 / 2.8)^(1/3)) / 0.1 * 3600")" 0.05
is "times are written in seconds" "$(cell out 2 t)" 360000
is "the pair fails beyond 2.8 L/min" "$(cell out 3 mean)" 0
sed 's/state/leakage/' flow.tsv >flow2.tsv
rwl --wear even.tsv --step-time 1h --state-unit L/min --time-unit h flow2.tsv | grep -v '^#' >a
grep -v '^#' out >b
same "a state is leakage unless stated otherwise" a b

# Units: the table's own, or the option's; neither may be of another quantity.
printf '# units: h L/min\nt\tleakage\n0\t1.5\n100\t2.0\n200\t2.9\n' >units.tsv
rwl --wear even.tsv --step-time 1h units.tsv 2>err | grep -v '^#' >b
same "the units of the table are read" a b
fails "micrometres of a leakage" 2 '--state-unit um: is not a unit of leakage, want m3/s' \
	rwl --wear even.tsv --step-time 1h --state-unit um --time-unit h flow2.tsv
fails "litres per minute of a gap" 2 '--state-unit L/min: is not a unit of gap, want m' rwl --state-unit L/min gap.tsv
fails "a unit that contradicts the table" 2 "--state-unit L/h contradicts '# units:' of units.tsv" \
	rwl --state-unit L/h units.tsv
fails "a time unit that contradicts the table" 2 "--time-unit contradicts '# units:' of units.tsv" rwl --time-unit d units.tsv
fails "a table in volts" 1 "volts.tsv: column 'gap' is in 'V', want m" sh -c \
	"(echo '# units: s V'; cat gap.tsv) >volts.tsv; rwl volts.tsv"

# Debris caught: spheres add up.
printf 'time1\tdiameter\n1\t1e-3\n1\t1e-3\n2\t2e-3\n' >debris.tsv
ok "particles are accepted as state" rwl --threshold-volume 1e-8m3 debris.tsv
# 10 spheres of 1 mm, 0.5236e-9 m3 each, in two seconds (4-29)
near "the life follows from the detected particles" "$(cell out 3 mean)" \
	"$(calc "(1e-8 - 10 * 0.523598775598e-9) / (5 * 0.523598775598e-9)")" 1e-9
ok "the last row follows from the last particles" rwl --threshold-volume 1e-8m3 --wear-rate last debris.tsv
near "the rate is that of 8 particles in one second (4-28)" "$(cell out 3 mean)" \
	"$(calc "(1e-8 - 10 * 0.523598775598e-9) / (8 * 0.523598775598e-9)")" 1e-9

# A row that duet calls unresolved is as many spheres as it has sources, one without a
# diameter is none; sources of other rows tell of their section.  The volumes are those of
# wear-volume.
{
	printf 'time1\tdiameter\tsources\tverdict\n'
	printf '%s\n' '0.5 1e-3 1 alone' '1.5 1e-3 2 overlap' '2.5 2e-3 5 unresolved' '3.5 nan 3 unresolved' \
		'4.5 1e-3 0 unresolved' '4.5 1e-3 1 alone' '5 9e-3 1 misfit' '5.5 1e-3 1 alone' | tr ' ' '\t'
} >crowd.tsv
# 44 spheres of 1 mm in the 5.5 s since nothing was worn
ok "unresolved particles are counted as their sources" rwl --threshold-volume 1e-7m3 --stats crowd.stats crowd.tsv
near "the life follows from all particles" "$(cell out 8 mean)" \
	"$(calc "(1e-7 - 44 * 0.523598775598e-9) / (44 * 0.523598775598e-9 / 5.5)")" 1e-7
is "a doubtful particle is left out and reported" "$(column rows_doubtful crowd.stats): $(grep -c "1 rows are doubtful" err)" "1: 1"
is "a particle without diameter is reported" "$(column particles_without_diameter crowd.stats): $(grep ignored err)" \
	"1: rwl: crowd.tsv: rows ignored because they have no diameter: 1"
{ cat crowd.tsv && echo '# doubtful: pulses differ'; } >self.tsv
rwl --threshold-volume 1e-7m3 self.tsv >out 2>err
is "a table that calls itself doubtful is marked by status 3" "$? $(grep -c 'self.tsv: doubtful by its own account: pulses differ' err) $(grep -c '^# doubtful' out)" "3 1 1"

# Large particles: 1 of 4 in step 1, 3 of 5 in step 2.
{
	printf 'realisation\tstep\tparticle\tvolume\tdiameter\n'
	printf '%s\n' "0 1 1 1e-16 1e-6" "0 1 2 1e-16 9e-6" "1 1 1 1e-16 1e-6" "1 1 2 1e-16 1e-6" \
		"0 2 1 1e-16 9e-6" "0 2 2 1e-16 9e-6" "1 2 1 1e-16 9e-6" "1 2 2 1e-16 1e-6" "1 2 3 1e-16 1e-6" | tr ' ' '\t'
} >size.tsv
ok "large particles end the life" rwl --wear size.tsv --step-time 1h --critical-size 5um --critical-probability 40% --rates rates.tsv -c 2000 --levels 0.5 gap.tsv
# all: 4 of 9 at the end of step 2
near "the critical share is reached at the end of step 2" "$(cell out 1 q50)" 7200 1e-9
near "the elapsed time is subtracted" "$(cell out 2 q50)" 3600 1e-9
# 1 of 2 in step 1; 4 of 9 after step 2; 1 of 5 at last; by 1/4, 1/2, 1/4 of replicates
is "surface 0 twice fails in step 1, both in step 2, surface 1 twice never" \
	"$(column large_step rates.tsv | sort -u | tr '\n' ' ')" "0 1 2 "
near "one path in four never fails" "$(cell out 1 p_no_failure)" 0.25 0.04
ok "--sizes step uses the share in one step" rwl --wear size.tsv --step-time 1h --critical-size 5um --critical-probability 60% --sizes step --levels 0.5 gap.tsv
near "the share is 3 of 5 in step 2" "$(cell out 1 q50)" 7200 1e-9
ok "the earlier of both criteria ends the life" rwl --wear size.tsv --step-time 1h --critical-size 5um --critical-probability 40% --threshold-gap 10.02um --levels 0.5 gap.tsv
rising "the gap criterion is reached first" 1 "$(cell out 1 q50)" 7199

# Monte-Carlo: the mean of 16 fragments by Student's t in its logarithm.
awk 'BEGIN { print "volume"; for (i = 0; i < 16; i++) print (1 + i / 10) "e-15" }' >spread.tsv
ok "the scatter of an ensemble gives the scatter of the life" rwl --new --wear spread.tsv --step-time 1h --threshold-gap 15um \
	--initial-gap 10um --count 4000 --wear-rate mean --rates rates.tsv
cp out spread.out
# relative standard error sqrt((16^2 - 1) / 12 * 16 / 15) / 10 / 1.75 / 4; t of 15 degrees at 95 %: 1.75305
error=$(calc "sqrt(255 / 12 * 16 / 15) / 70")
mean=$(calc "1.75e-15 * 2346.3e-6 / 1e-8")
near "5 % of the paths wear less than the limit of Student" \
	"$(column mean rates.tsv | sort -g | sed -n 200p)" "$(calc "$mean * exp(-1.75305 * $error)")" \
	"$(calc "0.01 * $mean")"
near "5 % of the paths wear more than the limit with the second-order term" "$(column mean rates.tsv | sort -g | sed -n 3800p)" \
	"$(calc "$mean * exp(1.75305 * $error + 1.2 * (1.75305 * $error)^2)")" "$(calc "0.01 * $mean")"
ok "with --parts 1 a class wears like one fragment" rwl --new --wear spread.tsv --step-time 1h --threshold-gap 15um --initial-gap 10um -c 4000 --parts 1
rising "with --parts 1 the scatter is larger" "$(calc "1.3 * $(cell spread.out 1 q95)")" "$(cell out 1 q95)"
ok "--wear-rate last samples a rate in every step" rwl --new --wear spread.tsv --step-time 1h --threshold-gap 15um --initial-gap 10um -c 4000 --parts 1 --wear-rate last
near "--wear-rate last has the same mean life" "$(cell out 1 mean)" "$(cell spread.out 1 mean)" 3000

# One realisation, and wear that was never seen.
printf 'realisation\tstep\tvolume\n0\t1\t1e-15\n0\t2\t2e-15\n' >single.tsv
# The same particles, by their own diameters and by those of ferrous ones with their pulse.
printf 'time1\tdiameter\tclass\n1\t1e-4\tnon-ferrous\n2\t1e-4\tferrous\n3\t1e-4\tnon-ferrous\n' >bronze.tsv
printf 'time1\tdiameter\tclass\n0.5\t1e-4\tnon-ferrous\n1.5\t0\tferrous\n' |
	wear-volume --non-ferrous bronze --excitation 200kHz >one.tsv
awk -v v="$(column y one.tsv)" 'BEGIN { d = sprintf("%.17g", exp(log(v * 6 / 3.14159265358979324) / 3))
	print "time1\tdiameter\n1\t" d "\n2\t1e-4\n3\t" d }' >own.tsv
rwl --threshold-volume 1e-9m3 --wear-rate last own.tsv >own.life 2>own.err
rwl --threshold-volume 1e-9m3 --wear-rate last --non-ferrous bronze --excitation 200kHz bronze.tsv >bronze.life 2>bronze.err
is "particles of a named material wear like those of their own diameter" "$? $(column mean bronze.life |
	awk '{ printf "%.9g ", $1 }')$(wc -l <bronze.err)" "0 $(column mean own.life | awk '{ printf "%.9g ", $1 }')$(wc -l <own.err)"
rwl --threshold-volume 1e-9m3 --wear-rate last bronze.tsv >bronze.life 2>bronze.err
is "without the material the life is doubtful" "$? $(grep -c '2 rows are non-ferrous' bronze.err) $(grep -c '^# doubtful: the diameters' bronze.life)" "3 1 1"
printf 'time1\tdiameter\tverdict\n1\t1e-4\talone\n2\t1e-4\tmisfit\n3\t1e-4\talone\n4\t1e-4\tmisfit\n' >doubts.tsv
head -n 4 doubts.tsv >doubt.tsv
fails "a material where no particles are read" 2 '--non-ferrous requires a state of --quantity debris' \
	rwl --new --wear even.tsv --step-time 1h --non-ferrous bronze
fails "doubtful rows of a gap" 2 '--doubtful requires a state of --quantity debris' \
	rwl --threshold-gap 15um --doubtful gap.tsv
printf 'volume\n1.1e-15\n1.4e-15\n' >frag.tsv
rwl --threshold-volume 1e-10m3 --wear frag.tsv --fragment-area 1e-8m2 --calibrate doubts.tsv --quantity debris \
	--stats s doubt.tsv >out 2>err
is "doubtful rows of the unit for calibration are reported apart" \
	"$(sed -n 's/^rwl: \(.*\) rows are doubtful.*/\1/p' err | tr '\n' ' ')$(column rows_doubtful s)" "2 1 3"
fails "one realisation is doubtful" 3 'single.tsv: a single realisation' \
	rwl --new --wear single.tsv --step-time 1h --threshold-gap 15um --initial-gap 10um \
	--area 2346.3mm2 --fragment-area 1e-8m2
awk 'BEGIN { srand(4); print "t\tgap"; for (t = 0; t < 40; t++) print t * 3600 "\t" (10 + t / 10 + 0.02 * rand()) * 1e-6 }' >steady.tsv
printf 'volume\n1e-15\n1e-15\n1e-15\n' >equal.tsv
fails "equal realisations are doubtful" 3 'equal.tsv: 3 realisations of equal volume' \
	rwl --new --wear equal.tsv --step-time 1h --threshold-gap 15um --initial-gap 10um \
	--fragment-area 1e-8m2 --area 2346.3e-6m2
# What debrisgen doubts of a realisation
{ cat frag.tsv && echo '# doubtful: realisation 1: particles are cut off'; } >cut.tsv
fails "a table of fragments that calls itself doubtful" 3 'cut.tsv: doubtful by its own account: realisation 1: particles' \
	rwl --new --wear cut.tsv --step-time 1h --threshold-gap 15um --initial-gap 10um \
	--fragment-area 1e-8m2 --area 2346.3e-6m2
is "the lives say so too" "$(sed -n 's/^# doubtful: //p' out)" "realisation 1: particles are cut off"
rwl --new --wear frag.tsv --step-time 1h --threshold-gap 15um --initial-gap 10um \
	--fragment-area 1e-8m2 --area 2346.3e-6m2 >sound.tsv
is "and are the same" "$(grep '^[0-9]' out)" "$(grep '^[0-9]' sound.tsv)"
# Realisations 1, 2 and 5 of 0 to 7, of which no particle tells
printf '# realisation: 0\nrealisation\tstep\tparticle\tvolume\n# realisation: 1\n1\t1\t1\t2e-15\n2\t1\t1\t3e-15\n5\t2\t1\t1e-15\n' >some.tsv
printf '# realisation: 7\n# last_step: 4\n' | cat some.tsv - >ends.tsv
awk 'BEGIN { print "realisation\tstep\tvolume"; for (r = 0; r < 8; r++) for (k = 1; k < 5; k++)
	print r "\t" k "\t" (r == 1 && k == 1 ? 2 : r == 2 && k == 1 ? 3 : r == 5 && k == 2 ? 1 : 0) "e-15" }' >listed.tsv
for f in ends listed; do
	rwl --new --wear $f.tsv --step-time 1h 2>&1 | awk '/^0/ { for (k = 2; k < 7; k++) printf "%.9g ", $k }' >$f.life
done
same "realisations and steps without particles at the ends of a table count" ends.life listed.life
for wear in '' '--wear single.tsv --step-time 1h'; do
	# shellcheck disable=SC2086 # options
	rwl --threshold-gap 15um --wear-rate filter $wear steady.tsv 2>err | grep -v '^#' >"filter$(echo "$wear" | wc -w | tr -d ' ')"
done
same "filters take no rate from one realisation" filter0 filter4
awk 'BEGIN { srand(8); print "t\tgap"
	for (t = 0; t < 60; t++) print t * 3600 "\t" (10 + t / 10 + 0.4 * (rand() - 0.5) + (t == 30 ? 3 : 0)) * 1e-6 }' >noisy.tsv
ok "a noisy gap is filtered" rwl --threshold-gap 15um --wear-rate filter noisy.tsv
cp out noisy.out
is "one reading beyond the threshold is no failure" "$(calc "($(cell noisy.out 31 q50) > 36000)")" 1
is "but a gap that stays beyond it is" "$(cell noisy.out 60 q95)" 0
awk 'NR > 20 { $2 /= 25.4 } { print $1 "\t" $2 }' steady.tsv >inch.tsv
fails "a change of unit" 1 'inch.tsv: line 28: the last 8 values are 0.04.* times those before, and so are their steps' \
	rwl --threshold-gap 15um inch.tsv
rwl --threshold-gap 15um steady.tsv 2>err >out
is "a rate without uncertainty is named" "$(grep -c 'the rate is taken as exact' err)" 1
seq 0 60 | awk 'BEGIN { print "t\tgap" } { printf "%d\t%.8g\n", $1, 1e-5 + 5e-7 * sqrt($1) }' >falls.tsv
rwl --threshold-gap 15um falls.tsv 2>err >out
is "a falling rate that (4-29) takes as constant is named" "$(grep -c 'the rate of the gap falls' err)" 1
rwl --threshold-gap 15um --wear-rate filter falls.tsv 2>err >out
is "filters follow it" "$(grep -c 'the rate of the gap' err)" 0
rwl --threshold-gap 15um steady.tsv 2>err >out
is "a steady rate is not doubted" "$(grep -c 'the rate of the gap' err)" 0
printf 'volume\n0\n0\n0\n' >nothing.tsv
fails "a table without wear gives a doubtful life" 3 'nothing.tsv: none of 3 realisations wore' \
	rwl --new --wear nothing.tsv --step-time 1h --threshold-gap 15um --initial-gap 10um \
	--area 2346.3mm2 --fragment-area 1e-8m2

# Any split of an ensemble is the same bytes.
rwl --new --wear spread.tsv --step-time 1h --threshold-gap 15um --samples -c 20 --parts 1 --wear-rate last | grep -v '^#' >whole
rwl --new --wear spread.tsv --step-time 1h --threshold-gap 15um --samples -c 12 --parts 1 --wear-rate last | grep -v '^#' >part.tsv
rwl --new --wear spread.tsv --step-time 1h --threshold-gap 15um --samples -f 12 -c 8 --parts 1 --wear-rate last | rows /dev/stdin >>part.tsv
same "paths 0-19 are those of 0-11 and 12-19" whole part.tsv

# Classes: the zone of linear pressure is in by default, between the extremes.
sed 's/e-15/e-18/' even.tsv >low.tsv
ok "two classes are accepted" rwl --new --wear even.tsv:21MPa --wear low.tsv:0.15MPa --step-time 1h --rates rates.tsv
zone=$(awk 'BEGIN { p = log(1e3) / log(140) + 1; r = log(140)
	m = 1e-18 * 0.15 * (exp(p * r) - 1) / p / 20.85
	printf "%.15g", 2346.3e-6 / 1e-8 * (0.45 * 1e-15 + 0.45 * 1e-18 + 0.1 * m) }')
near "the wear of the valve plate is integrated over its classes" "$(cell rates.tsv 1 mean)" "$zone" 1e-20
ok "classes may have areas" rwl --new --wear even.tsv:21MPa:1173.15mm2 --wear low.tsv:0.15MPa:1173.15mm2 --step-time 1h --rates rates.tsv
near "the halves of the thesis are the default" "$(cell rates.tsv 1 mean)" \
	"$(calc "117315 * 1.001e-15")" 1e-20
# What debrisgen writes: the particles and their summary tell the same, and under what
# pressure, on what area and over what distance they came off.
roughgen --points 32 --length 25um --sq 0.8um --corr 5um --count 4 |
	bemcontact --pressure 21MPa --young 210GPa >contact.nrrd
debrisgen --yield 355MPa --friction 0.3 --steps 3 --young 210GPa --summary steps.tsv contact.nrrd >particles.tsv 2>err
is "the tables state areas, pressures and distances" "$(sed -n '/^# stream/d; s/^# \([nfs][a-z_]*: .*\)/\1/p' steps.tsv | tr '\n' ' ')" \
	"nominal_area: 6.25e-10 m2 nominal_pressure: 21000000 Pa friction: 0.3 step_distance: 2.5e-05 m "
new="--new --threshold-gap 15um --initial-gap 10um --count 50"
for f in particles.tsv steps.tsv; do
	rwl $new --wear $f --step-time 1h 2>err | grep -v '^#' >$f.life
done
rwl $new --wear steps.tsv:21MPa --fragment-area 625um2 --step-time 1h 2>err | grep -v '^#' >told.life
same "the area of a fragment is read from the table" steps.tsv.life told.life
# 25 um at 0.01 m/s: 2.5 ms
rwl $new --wear steps.tsv --speed 10mm/s >speed.out 2>err
near "the sliding speed determines the step time" "$(cell speed.out 1 q50)" \
	"$(sed 1d steps.tsv.life | cut -f 4 | awk '{ printf "%.15g", $1 / 3600 * 2.5e-3 }')" 1e-6
fails "a state for a new pair" 2 'new reads no state, not even steps.tsv' rwl $new --wear steps.tsv --step-time 1h steps.tsv
fails "two states" 2 'state even.tsv: the state is also the operand steps.tsv' \
	rwl --wear steps.tsv --state even.tsv steps.tsv
grep -v "^#" particles.tsv >once.tsv
cat once.tsv once.tsv >doubled.tsv
fails "two ensembles of the same numbers" 1 'the numbers of joined ensembles must differ' \
	rwl $new --wear doubled.tsv --step-time 1h
rwl $new --threshold-volume 0.2 --area 2346 --wear even.tsv --step-time 1h 2>&1 >out | sed 's/^rwl: //' >err
is "a volume and an area without their units are doubted" "$(grep meant err | tr '\n' ' ')" \
	"--threshold-volume 0.2 m3: is 0.2mm3 meant? --area 2346 m2: is 2346mm2 meant? "
# 1.5 L/min without its unit
printf 't\tleakage\n0\t1.5\n10\t1.6\n' >bare.state
rwl --wear steps.tsv --step-time 1h --area 1mm2 bare.state 2>&1 >bare.life | grep 'unit' >err
is "a leakage beyond that of any pump is doubted once" "$(cat err)" \
	"rwl: bare.state: line 2: a leakage of 1.5 m3/s: is another unit meant? --state-unit names it"
fails "a pressure that contradicts the table" 2 'steps.tsv:21Pa: the nominal pressure of the fragments is 2.1e+07 Pa' \
	rwl $new --wear steps.tsv:21Pa --step-time 1h
fails "an area that contradicts the table" 2 'fragments of 6.25e-10 m2, not of 1e-08 m2' \
	rwl $new --wear steps.tsv --fragment-area 1e-8m2 --step-time 1h
fails "a speed without a distance" 2 'do not state .# step_distance' rwl $new --wear even.tsv --speed 1m/s
fails "two step times" 2 'exclude one another' rwl $new --wear steps.tsv --speed 1m/s --step-time 1h
fails "several pressures in one table" 1 'nominal pressures of 2.1e+07 and of 1e+06 Pa in one table' sh -c \
	"bemcontact --pressure 1MPa --young 210GPa contact.nrrd | debrisgen --yield 355MPa --friction 0.3 --steps 3 \
	--young 210GPa 2>/dev/null | sed -e '/^# stream/d' -e '/^# end/d' -e 's/^[0-9]/1&/' | cat particles.tsv - | rwl $new --wear - --step-time 1h"
sed -e '/^# stream/d' -e '/^# end/d' -e 's/^# nominal_area: .*/# nominal_area: 5 Pa/' steps.tsv >wrong.tsv
fails "an area in Pa" 1 "wrong.tsv: nominal_area: '5 Pa' has the wrong unit, want m2" rwl $new --wear wrong.tsv --step-time 1h
rwl --new --wear even.tsv --step-time 1h >out 2>err
is "parameters that are assumed are reported" "$(cat err)" \
	"rwl: $(sed -n 's/^# assumed: /assumed: /p' out)"
is "all assumed parameters are reported" "$(grep -o -e '--[a-z-]*' err | tr '\n' ' ')" \
	"--fragment-area --area --threshold-leakage --radii --ports --viscosity "
rwl --new --wear even.tsv --step-time 1000h --threshold-gap 11um --initial-gap 10.95um >out 2>err
is "a life below one simulated step gives a warning" "$(grep -c 'a life of .* s is below one simulated step' err)" 1
# Volumes are summed up in another order.
for f in particles.tsv steps.tsv; do
	sed 1d $f.life | awk '{ for (i = 1; i <= NF; i++) printf "%.12g ", $i }' >$f.digits
done
same "a particle table and its summary give the same life" particles.tsv.digits steps.tsv.digits
rwl --new --wear steps.tsv --step-time 1h -c 2 >out
is "the output records how the fragments were made" "$(sed -n 's/^# wear: steps.tsv made by //p' out)" \
	"$(sed -n '/^# cmd: /{s///;s/--first 0 --count 1/--first 0 --count 4/;p;q;}' steps.tsv)"
(eval "$(sed -n 's/^# wear: steps.tsv made by //p' out)") >again.tsv
for f in steps.tsv again.tsv; do
	grep -v '^#' $f >$f.rows
done
same "the output records all tables of fragments" steps.tsv.rows again.tsv.rows

# Comparators and scores on an exponential leakage, which a grey model predicts.
awk 'BEGIN { print "t\tleakage"; for (t = 0; t <= 600; t += 50) printf "%d\t%.12g\n", t, 1.5 * exp(t / 1186 * log(2.8 / 1.5)) }' >exp.tsv
rwl --wear even.tsv --state-unit L/min --time-unit h --grey --eol 1186h exp.tsv >out 2>err || echo "status $?" >>err
is "the rate of the gap of an exponential leakage grows" "$(grep -c 'status 3\|the rate of the gap grows' err)" 2
# the model's a of an exponential of ratio q per step is -2 (q - 1) / (q + 1): 1e-4 here
near "the grey model predicts the life of an exponential" "$(cell out 13 grey | awk '{ print $1 / 3600 }')" 586 0.2
near "the truth is the true remaining life" "$(cell out 13 truth)" 2109600 0
is "the summary of the scores is written" "$(sed -n 's/^# \([a-z_]*\):.*/\1/p' out | tr '\n' ' ')" \
	"stream cmd units assumed doubtful predictions infinite_medians bias mean_absolute_error root_mean_square_error relative_accuracy alpha_lambda prognostic_horizon coverage crps end "
near "the error is median minus truth" "$(cell out 5 error)" \
	"$(calc "$(cell out 5 q50) - $(cell out 5 truth)")" 1e-6

# Filters.
ok "the filters run" rwl --wear-rate filter --state-unit L/min --time-unit h exp.tsv
is "the first prediction is at the fourth observation" "$(cell out 3 mean) $(cell out 4 mean | sed 's/[0-9.e+]*/number/')" "nan number"
ok "the rate of the fragments is used as a prior" rwl --wear spread.tsv --step-time 1h --wear-rate filter --state-unit L/min --time-unit h exp.tsv

# A state of standard error 0.5 um: normal with 0.5 um over the rate of 0.1 um/h.
ok "an uncertain state is accepted" rwl --wear even.tsv --step-time 1h --threshold-gap 15um --state-error 0.5e-6 -c 20000 gap.tsv
near "the standard deviation of the life is 5 h" "$(calc "($(cell out 1 q95) - $(cell out 1 q05)) / 2 / 1.644854")" 18000 400
near "the median does not change" "$(cell out 1 q50)" 180000 600
near "ten paths are beyond the threshold" "$(cell out 5 q95)" 0 0
# Without fragments the rate is that of two such readings: 2 um are left after 3 um in 3 h, and the life has the
# relative errors e2 / 2 + (e2 - e1) / 3.
ok "an uncertain state is accepted without fragments" rwl --threshold-gap 15um --state-error 0.05e-6 -c 20000 gap.tsv
near "the rate is as uncertain as the state" "$(calc "($(cell out 4 q95) - $(cell out 4 q05)) / 2 / 1.644854")" \
	"$(calc "7200 * 0.05 * sqrt((1 / 2 + 1 / 3)^2 + (1 / 3)^2)")" 8

# Fragments that wear 0.1 um/h, and pairs that do and do not.
for rate in 1 3; do
	awk -v rate=$rate 'BEGIN { print "t\tgap"
		for (k = 0; k < 12; k++) printf "%d\t%.6g\n", 3600 * k, 1e-5 + 1e-7 * rate * (k + 0.1 * (k % 3)) }' >rate$rate.tsv
done
for how in mean last; do
	ok "fragments of the pair, $how" rwl --wear even.tsv --step-time 1h --threshold-gap 15um --wear-rate $how rate1.tsv
	rwl --wear even.tsv --step-time 1h --threshold-gap 15um --wear-rate $how rate3.tsv >life.tsv 2>err
	is "of another, $how" "$? $(grep -c '^rwl: the gap does not grow at the rate of the fragments' err) $(grep -c '^# doubtful' life.tsv)" "3 1 1"
done
ok "filters follow the gap" rwl --wear even.tsv --step-time 1h --threshold-gap 15um --wear-rate filter rate3.tsv
ok "so does a step time by the state" rwl --wear even.tsv --threshold-gap 15um rate3.tsv

# Run-in: the rates start after it, the state is known all the time.
printf 't\tgap\n0\t9e-6\n3600\t10e-6\n7200\t10.5e-6\n10800\t11e-6\n' >run-in.tsv
ok "the run-in is skipped" rwl --threshold-gap 15um --skip 1h run-in.tsv
near "4 um at 0.5 um/h give 8 h" "$(cell out 4 mean)" 28800 1e-6
is "there is no rate before the end of the run-in" "$(cell out 2 mean)" nan
twin run-in.tsv
ok "the run-in is skipped in the calibration" rwl --new --wear even.tsv --threshold-gap 15um --initial-gap 10um --skip 1h \
	--calibrate run-in.tsv --calibrate twin.run-in.tsv
near "5 um at 0.5 um/h give 10 h" "$(cell out 1 mean)" 36000 1e-3

# A repair of ten rows of wear is no wear: the mean over all time would be late by a third.
awk 'BEGIN { srand(5); print "t\tgap"
	for (k = 0; k < 100; k++)
		printf "%d\t%.6g\n", 3600 * k, 13e-6 + 3e-8 * (k < 50 ? k : k - 10) + 1e-8 * (rand() - 0.5) }' >repaired.tsv
awk '/^[0-9]/ && $1 >= 180000 { $2 += 3e-7 } { print $1 "\t" $2 }' repaired.tsv >steady.tsv
awk '/^[0-9]/ && $1 == 180000 { $2 -= 3e-7 } { print $1 "\t" $2 }' steady.tsv >outlier.tsv
awk '/^[0-9]/ && $1 % 14400 == 0 { print } /^t/' repaired.tsv >short.tsv
fails "a repair in 26 rows" 3 'the gap falls behind its rate' rwl --wear-rate mean --state-error 1e-9 --threshold-gap 17um short.tsv
ok "filters follow it" rwl --wear-rate filter --threshold-gap 17um short.tsv
awk '/^[0-9]/ && $1 >= 180000 { $2 += 3e-7; $1 += 36000 } { print $1 "\t" $2 }' short.tsv >halt.tsv
ok "a gap in time is no repair" rwl --wear-rate mean --threshold-gap 17um halt.tsv
rwl --wear-rate mean --threshold-gap 17um repaired.tsv >life.tsv 2>err
is "a repair in a mean rate: status" "$?" 3
is "it is named" "$(grep -c 'the gap falls behind its rate, as after a repair or a halt' err)" 1
is "in the table too" "$(grep -c '^# doubtful: the gap falls' life.tsv)" 1
ok "filters follow a repair" rwl --wear-rate filter --threshold-gap 17um repaired.tsv
ok "without a repair there is no doubt" rwl --wear-rate mean --threshold-gap 17um steady.tsv
ok "a single low reading is no repair" rwl --wear-rate mean --threshold-gap 17um outlier.tsv
fails "a calibration by a unit that was repaired" 1 'repaired.tsv: the gap falls behind its rate' \
	rwl --new --wear even.tsv --threshold-gap 17um --calibrate repaired.tsv
twin steady.tsv
ok "a calibration by two that were not" rwl --new --wear even.tsv --threshold-gap 17um --calibrate steady.tsv --calibrate twin.steady.tsv
fails "a calibration by one unit" 3 'steady.tsv: a single earlier unit: how units differ is unknown' \
	rwl --new --wear even.tsv --threshold-gap 17um --initial-gap 10um --fragment-area 1e-8m2 --area 2346.3e-6m2 --calibrate steady.tsv
# Units of rates 1, 1.2 and 1.6 um/h: the logarithm of another has the mean of theirs and, by
# Student's t of 2 degrees, which is below 2.92 in 95 %, the standard error s sqrt(1 + 1/3).
for rate in 1 1.2 1.6; do
	awk -v r=$rate 'BEGIN { print "t\tgap"; for (k = 0; k < 5; k++) printf "%d\t%.17g\n", 3600 * k, (10 + r * k) * 1e-6 }' >unit$rate.tsv
done
rwl --new --wear even.tsv --threshold-gap 15um --initial-gap 10um -c 20000 --calibrate unit1.tsv --calibrate unit1.2.tsv \
	--calibrate unit1.6.tsv >out 2>err
for end in q50:0 q05:-1 q95:1; do
	near "the ${end%:*} of units that differ, in the logarithm" "$(cell out 1 ${end%:*} | awk '{ print log($1) }')" \
		"$(awk -v z=${end#*:} 'BEGIN { a = log(1.2); b = log(1.6); m = (a + b) / 3
			s = sqrt((m * m + (a - m) ^ 2 + (b - m) ^ 2) / 2)
			print log(5 * 3600) - m + z * 2.92 * s * sqrt(4 / 3) }')" 0.03
done

# Provenance: the command line rebuilds the bytes.
rwl --wear even.tsv --step-time 1h --threshold-gap 15um --state gap.tsv >a
eval "$(sed -n 's/^# cmd: //p' a)" >b
same "the recorded command reproduces the table" a b
{ echo "# cmd: cat gap.tsv"; cat gap.tsv; } >upstream.tsv
rwl --wear even.tsv --step-time 1h --threshold-gap 15um upstream.tsv >a
eval "$(sed -n 's/^# cmd: //p' a)" >b 2>err
is "the recorded command reproduces a table from a pipe" "$(rows a)" "$(rows b)"

# Work left out.
rwl --wear even.tsv --step-time 1h --threshold-gap 15um --stats stats.tsv gap.tsv >/dev/null
is "sizes are counted only on request" "$(column sizes_skipped stats.tsv)" 1000
is "no path is computed once the threshold is passed" "$(column paths_skipped stats.tsv)" 1000

# Refusals.
printf 't\tgap\n0\t1e-5\n0\t2e-5\n' >twice.tsv
printf 't\tgap\n0\t-1e-5\n' >minus.tsv
printf 't\tgap\n0\tx\n' >text.tsv
printf 't\tvolume\n0\t-1e-10\n1\t1e-10\n' >known.tsv
printf 't\tfoo\n0\t1\n' >column.tsv
printf 'realisation\tstep\tvolume\n0\t1\t1\n0\t1\t1\n' >again.tsv
printf 'realisation\tstep\tvolume\n' >none.tsv
printf 'realisation\tstep\tvolume\n0\t1\t-1\n' >negative.tsv
printf 'realisation\tstep\tvolume\n0\t1.5\t1\n' >half.tsv
fails "times that stand still" 1 'twice.tsv: line 3: time 0 s is not ascending' rwl twice.tsv
fails "a negative gap" 1 'minus.tsv: line 2: -1e-05 is not a gap' rwl minus.tsv
# A weighed volume has noise of either sign; one with the wrong sign falls ever farther.
awk 'BEGIN { srand(5); print "t\tvolume"
	for (k = 0; k < 40; k++)
		printf "%d\t%.6g\n", 1000 * k, 1e-9 * (k / 60 + 0.04 * (rand() - 0.5)) }' >weighed.tsv
awk '/^[0-9]/ { $2 = -$2 } { print $1 "\t" $2 }' weighed.tsv >lost.tsv
ok "volumes below 0 at the start" test "$(awk '$2 < 0' weighed.tsv | wc -l)" -ge 2
rwl --wear-rate filter --threshold-volume 1mm3 weighed.tsv >life.tsv
# The noise of .012 leaves the rate uncertain by 1.2 %, the end by 1.1 % of 60 000 s, and
# changes of the rate to come move the median by less than a tenth.
near "noise below 0 is no fault of a volume" "$(cell life.tsv 40 q50)" 21000 2500
fails "volumes of the wrong sign" 1 'lost.tsv: line [0-9]*: a volume of -.* is farther below 0 than noise' \
	rwl --threshold-volume 1mm3 lost.tsv
fails "a negative volume of which the error is known" 1 'line 2: a volume of -1e-10' \
	rwl --threshold-volume 1mm3 --state-error 1e-11 known.tsv
fails "text for a number" 1 'text.tsv' rwl text.tsv
fails "no column of the state" 1 'column.tsv.*leakage' rwl column.tsv
fails "a step that occurs twice" 1 'again.tsv: realisation 0 has a step twice' rwl --new --wear again.tsv --step-time 1h
fails "no fragment" 1 'none.tsv: no fragment' rwl --new --wear none.tsv --step-time 1h
fails "negative wear" 1 'negative.tsv: line 2: volume' rwl --new --wear negative.tsv --step-time 1h
fails "a step that is not an integer" 1 'half.tsv: line 2: step' rwl --new --wear half.tsv --step-time 1h
fails "no step time" 2 '--new requires --step-time' rwl --new --wear even.tsv
fails "classes without pressures" 2 'each of several tables requires a pressure' rwl --new --wear even.tsv --wear low.tsv --step-time 1h
fails "a pressure in metres" 2 '--wear even.tsv:21um: the pressure has the wrong unit' rwl --new --wear even.tsv:21um --step-time 1h
fails "a pressure of zero" 2 'even.tsv:0Pa: want a pressure above 0' rwl --new --wear even.tsv:0Pa --step-time 1h
fails "a negative pressure" 2 'even.tsv:-1MPa: want a pressure above 0' rwl --new --wear even.tsv:-1MPa --step-time 1h
fails "an area of zero" 2 ':0: want an area above 0' rwl --new --wear even.tsv:21MPa:0 --step-time 1h
fails "a negative area" 2 'mm2: want an area above 0' rwl --new --wear even.tsv:21MPa:-1mm2 --step-time 1h
fails "a class with four parts" 2 'want FILE' rwl --new --wear even.tsv:21MPa:1mm2:3 --step-time 1h
fails "too much area" 2 'more than --area' rwl --new --wear even.tsv:21MPa:9e3mm2 --step-time 1h
fails "size without diameters" 1 'even.tsv.*diameter' rwl --new --wear even.tsv --step-time 1h --critical-size 5um
fails "a unit that does not suit" 2 '--state-unit foo' rwl --state-unit foo gap.tsv
fails "levels that fall" 2 '--levels: levels must be ascending' rwl --levels 0.9,0.1 gap.tsv
printf 't\tvolume\n-1\t1e-9\n' >before.tsv
fails "volume before the beginning" 1 'before.tsv: line 2: time -1 s is before' rwl before.tsv
fails "one stream for two inputs" 2 'standard input cannot be both' rwl --wear -:21MPa
fails "scores of samples" 2 '--eol scores the summary' rwl --samples --eol 10h gap.tsv
fails "outlet below inlet" 2 'outlet pressure' rwl --ports 21MPa:1MPa gap.tsv
fails "a unit that does not wear" 1 'minus2.tsv.*does not wear' sh -c \
	'printf "t\tgap\n0\t2e-5\n1\t1e-5\n" >minus2.tsv; rwl --new --wear even.tsv --calibrate minus2.tsv'
# Options that nothing would heed
for o in '--step-time 1h' '--parts 3' '--first-step 4' '--fragment-area 1mm2' '--speed 1m/s' '--critical-size 5um'; do
	# shellcheck disable=SC2086 # words
	fails "$o without fragments" 2 "${o%% *} requires --wear" rwl $o gap.tsv
done
fails "a share of large particles without their size" 2 '--sizes requires --critical-size' \
	rwl --sizes step --wear even.tsv --step-time 1h gap.tsv
for o in '--skip 1h' '--state-error 1' '--grey' '--state-unit um'; do
	# shellcheck disable=SC2086 # words
	fails "$o of a new pair" 2 "${o%% *} requires a state" rwl --new --wear even.tsv --step-time 1h $o
done
# A series that starts at a known moment.
{
	printf '# start: 2026-01-02T03:04:05Z\nt\tleakage\n'
	i=0
	for y in 1.1e-5 1.2e-5 1.3e-5 1.4e-5 1.5e-5 1.6e-5; do
		printf '%s\t%s\n' "$i" "$y"
		i=$((i + 3600))
	done
} >started.tsv
is "the start of a series is carried to the lives" "$(rwl started.tsv 2>err | grep '^# start')" "# start: 2026-01-02T03:04:05Z"
# two SECOND TOP: gaps of one pair, of another in every other row, no higher than TOP
two() {
	awk -v second="$1" -v top="$2" 'BEGIN { srand(6); print "t\tgap"; for (k = 0; k < 60; k++) {
		y = 1e-5 * (1 + k / 90 * (k % 2 ? second : 1)) + 1e-7 * rand(); print 3600 * k "\t" (y > top ? top : y) } }'
}
two 0.3 1 >two.tsv
two 1 1.5e-5 >ceiling.tsv
two 1 1.3e-5 | awk 'BEGIN { srand(7) } /^[0-9]/ && $2 == 1.3e-5 { $2 += 1e-8 * (rand() - 0.5) } 1' OFS="\t" >dither.tsv
two 1 1 >one.tsv
awk '/^[0-9]/ { $2 = 3e-5 - $2 } 1' OFS="\t" one.tsv >closing.tsv
fails "a ceiling with noise behind it" 3 "the gap has ceased to grow" rwl --threshold-gap 25um --state-error 1e-7 dither.tsv
awk 'BEGIN { srand(7) } NR > 31 { $2 = 1e-5 + 1e-7 * rand() } 1' OFS="\t" one.tsv >dead.tsv
fails "a sensor that dies with noise behind it" 3 "the gap has ceased to grow" rwl --threshold-gap 25um --state-error 1e-7 --wear-rate filter dead.tsv
for how in mean filter; do
	fails "a gap that closes, $how" 3 "the gap closes: no life ends" rwl --threshold-gap 25um --state-error 1e-7 --wear-rate $how closing.tsv
	fails "two pairs in one state, $how" 3 "the values alternate between two courses" rwl --threshold-gap 25um --state-error 1e-7 --wear-rate $how two.tsv
	fails "a sensor at its ceiling, $how" 3 "the last values are equal: the sensor sticks" rwl --threshold-gap 25um --state-error 1e-7 --wear-rate $how ceiling.tsv
	ok "neither, $how" rwl --threshold-gap 25um --state-error 1e-7 --wear-rate $how one.tsv
done
printf 'unit\tt\tleakage\na\t0\t3e-5\nb\t1\t3e-5\n' >units.tsv
printf 't\tleakage\n0\t1.5\n200\t1.73\n400\t1.94\n600\t2.15\n' >litres.tsv
rwl --wear-rate filter litres.tsv >out 2>err
is "a state that seems to be in another unit is doubtful" \
	"$? $(grep -c '1.5 m3/s: is another unit meant' err) $(grep '^# doubtful' out)" "3 1 # doubtful: the unit of the state"
printf '# units: s m3\nt\tvolume\n0\t0\n1\t1e-12\n2\t2e-12\n3\t3e-12\n# doubtful: pulses differ\n' >own.tsv
fails "the volume of doubtful particles" 3 'own.tsv: doubtful by its own account: pulses differ' \
	rwl --wear-rate filter --threshold-volume 1e-9m3 own.tsv
fails "the state of two units" 1 "units.tsv: line 3: unit 'b' after 'a': want rows of one unit" rwl units.tsv
done_testing

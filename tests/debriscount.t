#!/bin/sh
# debriscount: classes, intervals, verdicts, codes, trend, alarm, streaming, refusals
. "$(dirname "$0")/tap.sh"

# cell COLUMN FILE [ROW]: in six digits
cell() {
	column "$1" "$2" | awk -v r="${3:-1}" 'NR == r { print $1 ~ /^[-0-9.]/ ? sprintf("%.6g", $1) : $1 }'
}

# Five particles of 50 um and one of 120 um in half an hour, some of them doubtful.
printf 'time1\tdiameter\tverdict\tsources\n100\t50e-6\talone\t1\n200\t50e-6\toverlap\t2\n300\t50e-6\talone\t1
400\t50e-6\tmisfit\t1\n500\t50e-6\talone\t1\n600\t50e-6\talone\t1\n700\t120e-6\talone\t1\n' >six.tsv
printf 'time1\ttime2\tdiameter\n-0.001\t0.01\t50e-6\n100\t100.01\t50e-6\n' >before.tsv
is "a particle that reaches sensor 2 after the record began counts" "$(debriscount before.tsv | column rows /dev/stdin)" 2
printf 'time1\ttime2\tdiameter\n-2\t-1\t50e-6\n' >earlier.tsv
fails "a particle that passed both sensors before it" 1 'line 2: time1 is -2, want a time of 0 or later' debriscount earlier.tsv
debriscount --duration 30min --density 7.8g/cm3 --flow 2L/min --stats st six.tsv >all.tsv 2>err
is "doubtful rows are left out, counted and reported" \
	"$(cell rows all.tsv) $(cell doubtful all.tsv) $(cell rows_doubtful st) $(grep -c 'left out' err)" "6 1 1 1"
is "particles per hour are number over duration" "$(cell per_hour all.tsv)" 12
is "particles per millilitre are number over volume" "$(cell per_ml all.tsv)" 0.0001
# 5 (50 um)^3 + (120 um)^3 = 2.353e-12 m3
near "the mass per hour is that of spheres" "$(cell kg_per_hour all.tsv | awk '{ print $1 * 1e8 }')" 1.92194 1e-4
is "the interval is that of Garwood for 6 below and for 7 with the doubtful row above" \
	"$(cell number_low all.tsv) $(cell number_high all.tsv)" "2.20189 14.4227"
debriscount --duration 30min --doubtful six.tsv >all.tsv 2>err
is "doubtful rows are counted with --doubtful" "$(cell rows all.tsv) $(cell doubtful all.tsv)" "7 0"
debriscount --duration 30min --classes 40um,100um,200um six.tsv >classes.tsv 2>err
is "particles are counted in their classes" "$(column rows classes.tsv | tr '\n' ' ')" "5 1 0 "
is "a particle at a limit is in the class above it" \
	"$(debriscount --duration 30min --classes 50um,120um six.tsv 2>err | column rows /dev/stdin | tr '\n' ' ')" "5 1 "
is "the last class is open and its upper limit is -ln 0.025" "$(cell high classes.tsv 3) $(cell number_high classes.tsv 3)" "inf 3.68888"
is "without a density there is no mass" "$(cell kg_per_hour classes.tsv)" nan
debriscount --duration 30min six.tsv >all.tsv 2>err
debriscount --duration 30min --confidence 0.9 six.tsv >ninety.tsv 2>err
rising "a lower confidence gives a narrower interval" "$(cell number_low all.tsv)" "$(cell number_low ninety.tsv)" \
	"$(cell number_high ninety.tsv)" "$(cell number_high all.tsv)"

debriscount six.tsv >open.tsv 2>err
is "without --duration the record ends with its last particle, and a warning is printed" \
	"$(cell end open.tsv) $(grep -c 'last particle' err)" "700 1"
debriscount --period 250s --stats st six.tsv >periods.tsv 2>err
is "each complete period has its rows" \
	"$(column rows periods.tsv | tr '\n' ' ')$(cell periods_left_out st)" "2 1 1"
# Three of four at random in the last 400 of 2000 s: 0.2^3; in those of some 1e9 s: 1e-20.
for begin in 1600 1764489600; do
	awk -v t="$begin" 'BEGIN { print "diameter\ttime1"; for (i = 0; i < 4; i++) print "1e-4\t" t + 100 * i }' >late.tsv
	debriscount late.tsv >late.out 2>err
	status=$?
	if [ "$begin" = 1600 ]; then
		is "times that begin late by chance are counted from 0" "$status $(grep -c "# doubtful" late.out)" "0 0"
	else
		is "times that do not begin at 0 are marked" "$status $(grep "# doubtful" late.out)" \
			"3 # doubtful: times do not begin at 0"
		like "a warning says so" "$(cat err)" 'no particle in the first 1.76449e.09 s of 1.76449e.09 s: times that do not begin at 0'
	fi
done
# A steady rate of one in 100 s that is counted from 3000 s: 0.4^19 = 3e-8.
awk 'BEGIN { print "diameter\ttime1"; for (i = 0; i < 20; i++) print "1e-4\t" 3000 + 100 * i }' >onset.tsv
debriscount --output trend --period 500s onset.tsv >late.out 2>err
is "periods without particles before the first one are marked, since they make a trend" \
	"$? $(grep -c 'empty periods and a trend' err) $(grep '# doubtful' late.out)" "3 1 # doubtful: times do not begin at 0"
debriscount --output trend --period 500s --duration 5000s onset.tsv >late.out 2>err
is "unless the duration is stated" "$? $(wc -l <err)" "0 0"
printf 'diameter\ttime1\tverdict\nnan\t5\tshock\nnan\t9\tshock\n' >shocks.tsv
fails "a record of events alone, whose length is unknown" 1 'no particle after 0 s: specify the length' debriscount shocks.tsv
debriscount --duration 10s shocks.tsv >late.out 2>err
is "a record without particles has no late ones" "$? $(grep -c '# doubtful' late.out) $(grep -c 'do not begin' err)" "0 0 0"
debriscount --duration 1764490000s late.tsv >late.out 2>err
is "with --duration they are those of the record" "$? $(cat err)" "0 "
debriscount --period 250s --duration 900s six.tsv >periods.tsv 2>err
is "with --duration the last period is written too" "$(column rows periods.tsv | tr '\n' ' ')$(cell end periods.tsv 4)" "2 1 3 0 900"

# A stretch of 40 equal particles of 100 um.
printf 'time1\tdiameter\tverdict\tsources\n1\t60e-6\talone\t1\n5\t100e-6\tunresolved\t40\n' >dense.tsv
debriscount --duration 10s --classes 50um,90um,125um dense.tsv >dense.out 2>err
is "an unresolved section counts as equal particles in their class" "$(column unresolved dense.out | tr '\n' ' ')" "0 40 0 "
# 3.69 + 2, as 40 (100/125)^12 is 2.7
near "an unresolved section bounds the number of larger particles" "$(cell number_high dense.out 3)" 5.68888 1e-4
is "unresolved sections are reported" "$(grep -c 'not resolved' err)" 1
printf 'time1\tdiameter\tverdict\tsources\n5\tnan\tunresolved\t40\n' >dense.tsv
debriscount --duration 10s dense.tsv >dense.out 2>err
is "an unresolved section without diameter has no upper limit" "$(cell number_high dense.out)" inf
# (150/90)^6 is 21.4 and (150/125)^6 is 2.99; 60 um are at most those of 1 + 3 3 10/60 times
# the amplitude, 81.4 um: 21.4 (81.4/90)^6 is 11.7 and 2.99 (81.4/125)^6 is 0.23
for row in 'nan nan' '60e-6 10e-6'; do
	printf 'time1\tdiameter\tdiameter_se\tverdict\tsources\tdiameter_most\n5\t%s\tunresolved\t1\t150e-6\n' \
		"$(echo "$row" | tr ' ' '\t')" >most.tsv
	debriscount --duration 10s --classes 90um,125um,200um --density 7.8g/cm3 most.tsv >most.out 2>err
	column number_high most.out | awk '{ printf "%.0f ", $1 + log(0.025) }'
done >most
is "the energy of a section bounds the number of particles of unknown size" "$(cat most)" "21 2 0 11 0 0 "
# 11 with the energy of one of 150 um are no heavier than 11 equal ones; and 3.69 of 125 um
near "the energy of a section bounds the mass of its particles" "$(cell kg_per_hour_high most.out 1)" \
	"$(awk 'BEGIN { print atan2(0, -1) / 6 * (sqrt(11) * 150e-6 ^ 3 - log(0.025) * 125e-6 ^ 3) * 7800 * 360 }')" 1e-9

printf 'time1\tdiameter\tmaterial\n1\t60e-6\tsteel\n2\t60e-6\tbronze\n3\t80e-6\tsteel\n' >two.tsv
debriscount --by material --duration 10s two.tsv >by.tsv
is "ferrous and non-ferrous particles are counted separately" "$(awk -F '\t' '/^[0-9]/ { print $3, $6 }' by.tsv | tr '\n' ' ')" "steel 2 bronze 1 "

# One ferrous, one unclear and a section of unknown class, 2 particles of 60 um.
printf 'time1\tdiameter\tverdict\tsources\tclass\n1\t60e-6\talone\t1\tferrous\n2\t60e-6\talone\t1\tunclear
3\t60e-6\tunresolved\t2\tunclear\n4\t60e-6\talone\t1\tnan\n' >unclear.tsv
debriscount --by class --classes 60um --duration 10s unclear.tsv >by.tsv 2>err
is "particles of unclear class count towards the upper limit of each class" \
	"$(cell rows by.tsv) $(cell doubtful by.tsv) $(cell number by.tsv) $(cell number_low by.tsv) $(cell number_high by.tsv)" \
	"1 2 1 0.0253178 10.7673"
sed 's/unclear/NA/; s/nan$//' unclear.tsv | debriscount --by class --classes 60um --duration 10s >missing.tsv
is "so do those without a class, in any spelling of a missing value" \
	"$(cell number_high missing.tsv 1) $(column class missing.tsv | sort -u | tr '\n' ' ')" \
	"$(cell number_high by.tsv 1) ferrous nan "
is "unclear particles have rows of their own" "$(cell class by.tsv 2) $(cell number by.tsv 2) $(cell number_high by.tsv 2)" \
	"unclear 3 7.57164"

# Below the skin depth a sphere of bronze with the pulse of 20 um of iron has the diameter
# (60 (20 um)^3 / (pi f mu0 sigma))^(1/5) = 150 um, at 200 kHz and 8e6 S/m.
awk 'BEGIN { pi = 3.14159265358979; d = (60 * 8e-15 / (pi * 2e5 * 4e-7 * pi * 8e6)) ^ 0.2
	printf "%.9g\n", 8800 * pi / 6 * d ^ 3 }' >bronze
printf 'time1\tdiameter\tclass\n1\t20e-6\tferrous\n2\t20e-6\tnon-ferrous\n' >kinds.tsv
debriscount --by class --non-ferrous bronze --excitation 200kHz --density 8800kg/m3 --duration 1h \
	--classes 10um,100um,160um kinds.tsv >kinds.out 2>err
is "non-ferrous particles are in the class of their own size, without a warning" \
	"$? $(column rows kinds.out | tr '\n' ' ')$(wc -l <err | tr -d ' ')" "0 1 0 0 0 1 0 0"
near "non-ferrous particles have the mass of their own size" "$(column kg_per_hour kinds.out | awk -v m="$(cat bronze)" 'NR == 5 { print $1 / m }')" 1 1e-3
# Garwood's limit for two particles, 7.2247, of the upper end of the class for the third
debriscount --by class --non-ferrous bronze --excitation 200kHz --duration 1h --classes 10um,100um,160um >unclear.out \
	2>err <<-END
	$(cat kinds.tsv)
	3	20e-6	unclear
END
is "an unclear particle may be either, with the size that it then has" \
	"$(column doubtful unclear.out | tr '\n' ' ')$(column number_high unclear.out | awk '{ printf "%.4f ", $1 }')" \
	"1 0 0 0 1 0 0 0 0 7.2247 3.6889 3.6889 3.6889 7.2247 3.6889 5.5716 3.6889 3.6889 "
debriscount --by class --density 8800kg/m3 --duration 1h kinds.tsv >kinds.out 2>err
is "the mass of non-ferrous particles of unknown material is marked" "$? $(grep -c '1 rows are non-ferrous' err)" "3 1"
debriscount --by class --duration 1h kinds.tsv >kinds.out 2>err
is "the number of non-ferrous particles of unknown material is not marked" "$? $(wc -l <err | tr -d ' ')" "0 0"
# 20 um is half detected, and so is what it is equivalent to.
debriscount --by class --non-ferrous bronze --excitation 200kHz --duration 1h --d50 20um --detection-threshold 5 \
	kinds.tsv >kinds.out
is "the same pulse is detected with the same probability" "$(column number kinds.out | tr '\n' ' ')" "2 2 "
debriscount --output codes --by class --non-ferrous bronze --excitation 200kHz --volume 1mL --d50 5um \
	--detection-threshold 5 kinds.tsv >kinds.out
is "sizes of bronze that the sensor misses have no code" "$(column iso4406 kinds.out | tr '\n' ' ')" "-/>=7/>=7 -/-/- "
fails "a material of all particles" 2 'requires --by class' debriscount --non-ferrous bronze --duration 1h kinds.tsv
fails "an unknown material" 2 "no 'unobtainium'; there are ferrous" debriscount --by class --non-ferrous unobtainium kinds.tsv

# Missed particles: half of those of d50.
printf 'time1\tdiameter\n1\t50e-6\n2\t50e-6\n' >half.tsv
debriscount --duration 10s --d50 50um --detection-threshold 5 half.tsv >half.out
is "each particle of size d50 counts as two" "$(cell number half.out)" 4

# Cleanliness codes of a bottle: 250 > 4 um, 60 > 6 um, 8 > 14 um in 1 ml.
awk 'BEGIN { print "diameter"; for (i = 0; i < 190; i++) print 5e-6; for (i = 0; i < 52; i++) print 10e-6
	for (i = 0; i < 8; i++) print 30e-6 }' >bottle.tsv
debriscount --output codes --volume 1mL bottle.tsv >codes.tsv
is "250, 60 and 8 particles per ml have their ISO 4406 code, the last marked as of few" "$(column iso4406 codes.tsv)" "15/13/>=10"
is "the code has an interval" "$(column iso4406_low codes.tsv) $(column iso4406_high codes.tsv)" "15/13/9 15/13/11"
# 25000 6000 800 800 0 0 per 100 ml
is "the AS4059 classes are cumulative" "$(column as4059 codes.tsv)" 5A/5B/4C/7D/000E/000F
debriscount --output codes --volume 1mL --d50 8um --detection-threshold 5 bottle.tsv >codes.tsv
is "sizes that are not detected have no code" "$(column iso4406 codes.tsv)" "-/-/>=10"
debriscount --output codes --flow 1mL/min --duration 60s bottle.tsv >codes.tsv 2>err
is "flow times time gives the same result as the volume" "$(column iso4406 codes.tsv) $(column volume codes.tsv)" "15/13/>=10 1e-06"

# Trend: 2, 4, 6, ... particles in each hour.
awk 'BEGIN { print "time1\tdiameter"; for (h = 0; h < 8; h++) for (i = 0; i < 2 * (h + 1); i++)
	print h * 3600 + 10 * i "\t50e-6" }' >grows.tsv
debriscount --output trend --period 1h --duration 8h grows.tsv >trend.tsv
is "the trend is two per hour in each hour" "$(column slope trend.tsv | tail -n 1 | awk '{ printf "%.6f", $1 }')" 2.000000
is "two periods have no interval of the slope" "$(cell slope trend.tsv 2)" nan
# 8 h of none: the deviation of one particle in eight periods, sqrt(1/8) per hour; spread of
# the hours 42 h2; 1.95996 deviations
printf 'time1\tdiameter\n' >none.tsv
debriscount --output trend --period 1h --duration 8h none.tsv >trend.tsv
near "hours without particles have an upper limit of the slope" "$(column slope_high trend.tsv | tail -n 1)" 0.106925 1e-5
is "hours of equal numbers have an upper limit of the slope" "$(awk 'BEGIN { print "time1\tdiameter"; for (h = 0; h < 8; h++)
	print h * 3600 + 10 "\t50e-6" }' | debriscount --output trend --period 1h --duration 8h |
	column slope_high /dev/stdin | tail -n 1 | awk '{ printf "%.5f", $1 }')" 0.32077
awk 'BEGIN { print "time1\tdiameter"; for (h = 0; h < 9; h++) { n = h < 5 ? 20 : 5 + h
	for (i = 0; i < n; i++) print h * 3600 + 10 * i "\t50e-6" } }' >turns.tsv
debriscount --output trend --period 1h --duration 9h --window 4 turns.tsv >trend.tsv
is "--window limits the trend to the last periods" "$(column slope trend.tsv | tail -n 1 | awk '{ printf "%.6f", $1 }')" 1.000000

awk 'BEGIN { print "time1\tdiameter"; split("1 5 12 8 6 3 11", n, " "); for (h = 1; h <= 7; h++)
	for (i = 0; i < n[h]; i++) print h * 3600 - 3000 + 10 * i "\t50e-6" }' >level.tsv
debriscount --period 1h --duration 7h --alarm 10:5 level.tsv >alarm.tsv
is "an alarm is active at the end and the status is 4" $? 4
is "the alarm is active until the count falls below the lower level" "$(column alarm alarm.tsv | tr '\n' ' ')" "0 0 1 1 1 0 1 "
debriscount --period 1h --duration 6h --alarm 10:5 level.tsv >alarm.tsv 2>err
is "rows after the duration are an error" "$? $(grep -c 'after --duration' err)" "1 1"
awk -F '\t' 'NR == 1 || $1 < 21600' level.tsv | debriscount --period 1h --duration 6h --alarm 10:5 >alarm.tsv
is "an alarm that was cleared gives status 0" $? 0
printf 'time1\tdiameter\n0.95\t5e-5\n' | debriscount --period 0.1s --duration 1s --output trend >tenths.tsv
is "ten periods of 0.1 s are one second" "$(column begin tenths.tsv | wc -l | tr -d ' ') $(column end tenths.tsv | tail -n 1) \
$(column per_hour tenths.tsv | tail -n 1 | awk '{ printf "%.3f", $1 }')" "10 1 36000.000"
# 11 particles in the last complete hour, then a second without any, and one with one
debriscount --period 1h --duration 25201s --alarm 10:5 level.tsv >alarm.tsv
is "an incomplete period does not clear an alarm" "$? $(column alarm alarm.tsv | tail -n 1)" "4 1"
(awk -F '\t' 'NR == 1 || $1 < 21600' level.tsv; printf '21600.5\t50e-6\n') >last.tsv
debriscount --period 1h --duration 21601s --alarm 10:5 last.tsv >alarm.tsv
is "a single particle in an incomplete period does not raise an alarm" "$? $(column alarm alarm.tsv | tail -n 1)" "0 0"
(cat last.tsv; awk 'BEGIN { for (i = 0; i < 9; i++) print "21600.6\t50e-6" }') |
	debriscount --period 1h --duration 21601s --alarm 10:5 >alarm.tsv
is "as many particles as a complete period needs raise an alarm in an incomplete one" "$? $(column alarm alarm.tsv | tail -n 1)" "4 1"
debriscount --period 1h --duration 7h --density 7.8g/cm3 --alarm 5e-9 --alarm-mass level.tsv >alarm.tsv
is "levels of mass raise an alarm" "$(column alarm alarm.tsv | tr '\n' ' ')" "0 0 1 0 0 0 1 "

# Rows come out as soon as their period is over.
mkfifo open
debriscount --period 10s <open >live.tsv &
exec 8>open
printf 'time1\tdiameter\n1\t5e-5\n11\t5e-5\n' >&8
i=0
until grep -q '^0	10	' live.tsv || [ $i = 300 ]; do
	sleep 0.1
	i=$((i + 1))
done
is "a period is written when the next one begins" "$(grep -c '^0	10	' live.tsv)" 1
exec 8>&-
wait
printf 'time1\tdiameter\n1\t5e-5\n11\t5e-5\n3\t5e-5\n' | debriscount --period 10s --duration 20s >late.tsv 2>err
is "a particle that arrives too late is counted and marked" "$? $(column rows late.tsv | tr '\n' ' ')$(grep -c 'after the end of their period' err)" "3 1 2 1"

sensorsim --uniform 50um:150um --number 60 --duration 20s --snr 40dB --truth truth.tsv | duet >found.tsv 2>err
debriscount --duration 20s --classes 50um,100um truth.tsv >a.tsv
debriscount --duration 20s --classes 50um,100um found.tsv >b.tsv 2>err
rising "the counts of duet equal the true counts or their intervals contain them" "$(cell number_low b.tsv)" \
	"$(cell number a.tsv)" "$(cell number_high b.tsv)"

is "a particle at the end of the record is in its last period" \
	"$(printf 'time1\tdiameter\n3\t5e-5\n20\t5e-5\n' | debriscount --period 10s --duration 20s | column rows /dev/stdin | tr '\n' ' ')" "1 1 "
fails "classes that do not ascend" 2 'is not above' debriscount --classes 2um,1um six.tsv
fails "classes and a standard" 2 'exclude one another' debriscount --classes 2um --standard iso4406 six.tsv
printf 'time1\tdiameter\n0\t1e-4\n' >begun.tsv
fails "a record without a length" 1 'no particle after 0 s: specify the length' debriscount begun.tsv
fails "a record of no length" 2 'duration 0: want 1ns' debriscount --duration 0 begun.tsv
fails "one of two options for the probability of detection" 2 'both --d50 and --detection-threshold' debriscount --d50 2um six.tsv
fails "codes of no volume" 2 'requires --flow or --volume' debriscount --output codes six.tsv
fails "a trend without periods" 2 'requires --period' debriscount --output trend six.tsv
fails "an alarm that clears above its level" 2 'CLEAR not above LEVEL' debriscount --alarm 1:2 six.tsv
fails "a volume by the period" 2 'requires --flow' debriscount --volume 1L --period 1s six.tsv
printf 'time1\ttime2\tdiameter\n-inf\t1\t5e-5\n' >endless.tsv
fails "an infinite time before a finite one" 1 'time1 is -inf, want a time' debriscount endless.tsv
fails "no times to part periods by" 1 'no column of times' debriscount --period 1s bottle.tsv
fails "an empty stream" 1 'empty, want table' debriscount
fails "no particle and no duration" 1 'with --duration' debriscount none.tsv
debriscount --duration 1h none.tsv >none.out
is "an hour without particles has an upper limit of 3.7" "$(cell number none.out) $(cell number_high none.out)" "0 3.68888"
printf '# units: um min\ndiameter\ttime1\n50\t1\n150\t2\n' >um.tsv
debriscount --classes 40um,100um um.tsv >um.out 2>err
is "diameters and times are converted from the units of the table" "$(column end um.out | tr '\n' ' ')$(column number um.out | tr '\n' ' ')" "120 120 1 1 "
fails "units that change within a table" 1 'line 5: the units change' sh -c '(cat um.tsv; sed "s/um/mm/" um.tsv) | debriscount'
fails "units that end within a table" 1 "line [0-9]*: the header before has no '# units'" sh -c '(cat um.tsv; grep -v "^#" um.tsv) | debriscount'
fails "units that begin within a table" 1 'line 3: the units change' sh -c '(printf "diameter\ttime1\n5e-5\t1\n"; cat um.tsv) | debriscount'
printf '# units: kg s\ndiameter\ttime1\n50\t1\n' >kg.tsv
fails "a diameter in kilograms" 1 "column 'diameter' is in 'kg', want m" debriscount kg.tsv
grep -v '^#' um.tsv >bare.tsv
fails "a diameter of 50 metres" 1 'line 2: diameter is 50 m, want metres' debriscount bare.tsv
printf 'diameter\ttime1\n1e-6\t5\n1e-6\t1e15\n' >far.tsv
fails "a time without end of periods before it" 1 'more than 10000000 periods' debriscount --period 2s far.tsv
fails "a duration without end of periods after the last particle" 2 'more than 10000000 periods after the last particle' \
	debriscount --period 2s --duration 1e12s six.tsv
printf '# units: 0mm\ndiameter\n50\n' >zero.tsv
fails "a unit that begins with a digit" 1 "column 'diameter' is in '0mm', want m" debriscount zero.tsv
fails "a record after a record" 1 'another record begins' sh -c 'cat six.tsv six.tsv | debriscount --period 100s'
fails "a record after a record of unknown length" 1 'another record begins' sh -c 'cat six.tsv six.tsv | debriscount'
printf '# cmd: a\ntime1\tdiameter\n1\t1e-4\n# cmd: b\ntime1\tdiameter\n1\t1e-4\n' >records.tsv
debriscount --duration 10s records.tsv >out 2>err
is "records that are counted as one are reported" "$? $(grep -c '2 records are counted as one' err)" "0 1"
fails "codes of a record of unknown length" 1 'volume of oil is unknown' debriscount --output codes --flow 1L/min bottle.tsv
printf 'diameter\tverdict\tsources\n10\tunresolved\t4\n' >far.tsv
fails "a section of balls of 10 metres" 1 'line 2: diameter is 10 m, want metres' debriscount far.tsv
printf '# units: um\ndiameter\n37.9\n38\n70\n' >edge.tsv
is "a diameter in another unit is in the class that begins with it" \
	"$(debriscount --standard as4059 edge.tsv | column rows /dev/stdin | tr '\n' ' ')" "0 0 0 1 1 1 "
printf 'diameter\n1e-5\n5e-5\n' >faint.tsv
debriscount --duration 10s --d50 50um --detection-threshold 5 faint.tsv >out 2>err
is "a particle that the sensor hardly detects is marked" "$? $(grep -c '^debriscount: 1 particles are of a size' err)" "3 1"
debriscount --duration 10s --density 7.8 faint.tsv >out 2>err
is "a density in g/cm3 without its unit gives a hint" "$(grep -c 'is 7.8g/cm3 meant' err)" 1
fails "an excitation of no material" 2 '\--excitation requires --non-ferrous' \
	debriscount --duration 10s --excitation 1MHz faint.tsv
fails "a flow in litres without its unit" 2 'flow 60: want' debriscount --flow 60 /dev/null
# a record that duet could not explain, in a pipe that loses its exit status
printf 'time1\tdiameter\n1\t60e-6\n# doubtful: pulses differ\n' >self.tsv
debriscount --duration 10s self.tsv >out 2>err
is "a table that calls itself doubtful is marked by status 3" "$? $(grep -c 'self.tsv: doubtful by its own account: pulses differ' err)" "3 1"
for output in classes codes trend; do
	debriscount --output $output --flow 1L/min --period 1s self.tsv >out 2>err
	grep '^# doubtful' out
done >said
is "its counts repeat why, of either output" "$(sort said | uniq -c | sed 's/^ *//')" "3 # doubtful: pulses differ"
# half of a section of length T lies within sqrt(3) standard errors, T / sqrt(12), of its middle
for se in 0.57 0.58; do
	printf 'time1\ttime1_se\tdiameter\tverdict\tsources\n1\t0\t60e-6\talone\t1\n12\t%s\t60e-6\tunresolved\t40\n' \
		"$(awk -v s=$se 'BEGIN { print 2 * s }')" >long.tsv
	debriscount --period 10s --duration 20s long.tsv >out 2>err
	echo "$? $(grep -c '1 sections that are not resolved reach beyond their period' err)"
done >across
is "a section that is longer than its period lasts is marked" "$(tr '\n' ';' <across)" "0 0;3 1;"
debriscount --duration 20s long.tsv >out 2>err
is "an unresolved section is not marked without --period" "$?" 0
# 32 particles in half a period are 11520 per hour of the whole one
awk 'BEGIN { print "time1\tdiameter"; for (i = 0; i < 32; i++) printf "%g\t1e-4\n", 40 + i * 0.15 }' >rise.tsv
for output in classes trend; do
	debriscount -o $output --period 10s --duration 45s --alarm 5000 rise.tsv >out 2>err
	echo $?
done >status
is "an incomplete last period raises the alarm of either output" "$(tr '\n' ' ' <status)" "4 4 "
# 2160 per hour, a section that may hold any number, then 360
awk 'BEGIN { print "time1\tdiameter\tverdict\tsources"; for (i = 1; i < 7; i++) print i "\t1e-4\talone\t1"
	print "15\tnan\tunresolved\t1\n25\t1e-4\talone\t1\n35\t1e-4\talone\t1" }' >veiled.tsv
debriscount --period 10s --duration 40s --alarm 1800:1000 veiled.tsv >out 2>err
is "a period whose count has no upper limit does not clear an alarm" "$? $(column alarm out | tr '\n' ' ')" "0 1 1 0 0 "
debriscount -o trend --window 3 --period 10s --duration 50s --alarm 1800:1000 veiled.tsv >out 2>err
is "a period whose count has no upper limit gives no limit to a slope" "$(column slope_high out | awk '{ printf "%s ", $1 ~ /inf|nan/ ? $1 : "finite" }')" \
	"nan nan inf inf finite "
sed '/^25/,$d' veiled.tsv | debriscount --period 10s --duration 20s --alarm 1800:1000 >out 2>err
is "an alarm is active at the end of a record whose last count is not known" $? 4
# 0.3 s is not before three periods of 0.1 s, though it is before three times the number 0.1
awk 'BEGIN { print "time1\tdiameter"; for (i = 0; i < 30; i++) printf "%.1f\t1e-4\n", i / 10 }' >border.tsv
debriscount --period 100ms border.tsv >border.out
is 'a particle at the end of a period is in the next one' "$(column rows border.out | sort -u)" 1
is 'periods end at decimal numbers' "$(column end border.out | head -n 3 | tr '\n' ' ')" '0.1 0.2 0.3 '
done_testing

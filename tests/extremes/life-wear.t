#!/bin/sh
# Stiff and extreme scenes of rwl: accurate, or refused in one line.
# shellcheck disable=SC2046,SC2086 # lists of words are meant as such
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# last COLUMN OPTION...: the last cell of a column
last() {
	c=$1
	shift
	rwl "$@" >out 2>err
	[ $? -ne 1 ] && column "$c" out | tail -1 # 3: a single fragment is doubtful
}

# fragments VOLUME...: a table of one step each
fragments() {
	echo volume
	printf '%s\n' "$@"
}

# series GAP...: one gap in um per hour
series() {
	printf '%s\n' "$@" | awk 'BEGIN { print "t\tgap" } { print (NR - 1) * 3600 "\t" ($1 ~ /[0-9]/ ? $1 "e-6" : $1) }'
}

fragments 1e-15 1e-15 >even.tsv
new="--new --fragment-area 1e-8m2 --area 1e-6m2 --step-time 1s --initial-gap 10um --threshold-gap 20um"

# --- volumes at the ends of the range; 1e-11 m3 are left, 100 fragments wear
for v in 1e-300 1e-100 1e-30 1e-15; do
	fragments $v $v >one.tsv
	relative "every fragment wears $v m3" "1e-11 / (100 $v) s" "1e${v#1e-}" 1e-9 \
		"$(last mean $new --wear one.tsv | awk '{ printf "%.12g", $1 * 1e13 }')"
done
fragments 1e-320 >one.tsv
relative "denormal volumes" "a life beyond 1e300 s, or never" 1 0 \
	"$(last q50 $new --wear one.tsv | awk '{ print ($1 == "inf" || $1 > 1e300) }')"
fragments 0 0 0 >zero.tsv
exactly "no fragment wears at all" "never fails" "nan inf 1" \
	"$(rwl $new --wear zero.tsv >out 2>err; echo "$(column mean out) $(column q05 out) $(column p_no_failure out)")"
fragments 1e3 >one.tsv
relative "a fragment wears 1000 m3" "1e-16 s" 1e-16 1e-9 "$(last mean $new --wear one.tsv)"
fragments 1e-15 >one.tsv
relative "a single fragment" "no spread" 0 1e-12 "$(last q95 $new --wear one.tsv |
	awk '{ printf "%g", $1 / 100 - 1 }')"
awk 'BEGIN { print "volume"; for (i = 0; i < 999; i++) print 0; print 1e-12 }' >rare.tsv
# the mean is 1e-15, its relative standard error 1: life of the 5 % of least wear, t of 999 degrees
relative "one fragment in 1000 holds all wear" "q95 = 100 s exp(1.6464)" 518.8 0.1 \
	"$(last q95 $new --wear rare.tsv -c 4000 --parts 1000000000)"
relative "the same, new rate in every step" "mean of those that fail is finite" 1 0 \
	"$(last mean $new --wear rare.tsv --wear-rate last --parts 1 | awk '{ print ($1 + 0 > 0 && $1 + 0 < 1e9) }')"
fragments 1e-9 1e-33 >wide.tsv
relative "volumes 24 decades apart, new rate in every step" "finite" 1 0 \
	"$(last q05 $new --wear wide.tsv --wear-rate last --parts 1 | awk '{ print ($1 ~ /^[0-9]/ && $1 + 0 < 1e9) }')"

# --- pressures
fragments 1e-15 >high.tsv
fragments 1e-27 >low.tsv
relative "classes 1 Pa and 1 TPa, wear 12 decades apart: m(p) = p" "zone at 1/2 of the high class" \
	"$(awk 'BEGIN { printf "%.12g", 1e-11 / (100 * (0.45e-15 + 0.1 * 0.5e-15)) }')" 1e-9 \
	"$(last mean $new --wear high.tsv:1TPa --wear low.tsv:1Pa)"
relative "pressures that differ in the last digit" "the mean of both classes" 200 1e-9 \
	"$(last mean $new --wear even.tsv:21000000.000000004Pa --wear zero.tsv:21MPa)"
refused "two classes of one pressure" 2 'each of several tables requires a pressure' rwl $new --wear even.tsv:1Pa --wear zero.tsv:1Pa
refused "a class at no pressure beside another" 2 'a pressure above 0' rwl $new --wear even.tsv:0Pa --wear zero.tsv:1Pa
relative "64 classes" "all wear at the same rate: 100 s" 100 1e-9 "$(last mean $new $(
	awk 'BEGIN { for (i = 1; i <= 64; i++) print "--wear even.tsv:" i "MPa" }'))"

# --- states
fragments 1.0e-15 1.2e-15 0.9e-15 >three.tsv
series $(awk 'BEGIN { for (i = 0; i < 50; i++) print 10 }') >constant.tsv
series 12 11 10 9 8 >falling.tsv
series 25 26 27 >passed.tsv
series 10 11 >two.tsv
series nan nan nan nan nan >nothing.tsv
series 10 11 nan nan nan nan >gone.tsv
series $(awk 'BEGIN { for (i = 0; i < 120; i++) print 1 + i * 0.01 + (i > 40) * 5 }') >step.tsv
series $(awk 'BEGIN { for (i = 0; i < 120; i++) print i == 80 ? 1e4 : 10 + i * 0.05 + 0.01 * sin(i * i) }') >spike.tsv
for rate in mean last filter; do
	# to the filter, no wear is no promise, and may be a dead sensor
	relative "constant state, rate $rate" "no failure" 1 $([ $rate = filter ] && echo 0.5 || echo 0) "$(last p_no_failure --threshold-gap 20um --wear-rate $rate constant.tsv)"
	relative "falling state, rate $rate" "no failure" 1 0.05 "$(last p_no_failure --threshold-gap 20um --wear-rate $rate falling.tsv)"
	relative "threshold already passed, rate $rate" "remaining life 0" 0 0 "$(last q95 --threshold-gap 20um --wear-rate $rate passed.tsv)"
	exactly "no values, rate $rate" "no prediction" nan "$(last mean --threshold-gap 20um --wear-rate $rate nothing.tsv)"
done
relative "two points" "9 h" 32400 1e-9 "$(last mean --threshold-gap 20um two.tsv)"
exactly "two points, filter" "no prediction" nan "$(last mean --threshold-gap 20um --wear-rate filter two.tsv)"
relative "observations stop" "the last prediction less the time since: 9 h - 4 h" 18000 1e-9 "$(last mean --threshold-gap 20um gone.tsv)"
rwl --threshold-gap 10um --wear-rate filter step.tsv >out 2>err
exactly "step of 5 um, then 79 points, filter" "0.01 um/h from 7.19 um: 281 h is in the interval of 90 %" yes \
	"$(echo "$(column q05 out | tail -n 1) $(column q95 out | tail -n 1)" | awk '{ print ($1 < 281 * 3600 && ($2 == "inf" || $2 + 0 > 281 * 3600)) ? "yes" : "no" }')"
series $(awk 'BEGIN { for (i = 0; i < 200; i++) print 1 + i * 0.01 + (i > 40) * 5 }') >step.tsv
relative "step of 5 um, then 159 points, filter" "0.01 um/h from 7.99 um: 201 h" 201 0.3 \
	"$(last q50 --threshold-gap 10um --wear-rate filter step.tsv | awk '{ print $1 / 3600 }')"
relative "a spike of 1 cm, then 39 points, filter" "0.05 um/h from 15.95 um: 81 h" 81 0.1 \
	"$(last q50 --threshold-gap 20um --wear-rate filter spike.tsv | awk '{ print $1 / 3600 }')"
relative "steps scaled by a constant state" "no failure" 1 0 "$(last p_no_failure --threshold-gap 20um --wear even.tsv constant.tsv)"
relative "steps scaled by two points" "9 h" 32400 1e-9 "$(last q50 --threshold-gap 20um --wear even.tsv two.tsv)"

# --- times and values
for t in 1e-12 1e12; do
	awk -v t=$t 'BEGIN { print "t\tgap"; for (i = 0; i < 60; i++)
		printf "%.17g\t%.17g\n", i * t, 1e-5 + i * 1e-8 + 1e-9 * sin(i * i) }' >times.tsv
	# 1 um ahead at 1e-8 m per interval, less the 0.59 um so far
	relative "times $t s apart, filter" "41 intervals" 41 0.05 "$(last q50 --threshold-gap 11um --wear-rate filter times.tsv |
		awk -v t=$t '{ printf "%.6g", $1 / t }')"
	relative "times $t s apart, mean" "41 intervals" 41 0.01 "$(last q50 --threshold-gap 11um times.tsv |
		awk -v t=$t '{ printf "%.6g", $1 / t }')"
	relative "times $t s apart, grey model" "a little earlier" 41 0.1 "$(last grey --grey --threshold-gap 11um times.tsv |
		awk -v t=$t '{ printf "%.6g", $1 / t }')"
done
# 1e6 h after the epoch, one second apart: the times keep nine digits
awk 'BEGIN { print "t\tgap"; for (i = 0; i < 60; i++) printf "%.17g\t%.17g\n", 3.6e9 + i, 1e-5 + i * 1e-8 }' >late.tsv
relative "times 1 s apart at 3.6e9 s, filter" "41 s" 41 1e-3 "$(last q50 --threshold-gap 11um --wear-rate filter late.tsv)"
printf 't\tleakage\n0\t1e-300\n1\t2e-300\n2\t3e-300\n' >small.tsv
relative "leakage 1e-300 m3/s" "gap 1e-98, rate as small: a finite or infinite life" 1 0 \
	"$(last q50 --threshold-gap 20um small.tsv | awk '{ print ($1 == "inf" || $1 + 0 > 0) }')"
printf 't\tleakage\n0\t1e300\n' >large.tsv
relative "leakage 1e300 m3/s" "remaining life 0" 0 0 "$(last q95 large.tsv)"
printf 't\tgap\n0\tinf\n' >infinite.tsv
refused "an infinite gap" 1 'is not a gap' rwl infinite.tsv
printf 't\tgap\nnan\t1\n' >timeless.tsv
refused "a time that is missing" 1 'the time is missing' rwl timeless.tsv
: >empty.tsv
refused "an empty state" 1 'empty.tsv' rwl empty.tsv
refused "an empty table of fragments" 1 'empty.tsv' rwl $new --wear empty.tsv
printf 'realisation\tstep\tvolume\n0\t1000001\t1e-15\n' >far.tsv
refused "step 1000001" 1 'step must be' rwl $new --wear far.tsv
printf 'realisation\tstep\tvolume\n4294967295\t1000000\t1e-15\n' >far.tsv
relative "realisation 4294967295, step 1e6" "100 s as for any other" 100 1e-9 "$(last mean $new --wear far.tsv)"
printf 'realisation\tstep\tvolume\n0\t1\t1e-15' >cut.tsv
refused "a table cut off in a number" 1 'truncated' rwl $new --wear cut.tsv

# --- scores
exactly "end of life before the first observation" "no score" nan \
	"$(rwl --threshold-gap 20um --eol 1e-9s two.tsv | sed -n 's/^# coverage: //p' | sed 's/^-//')"
relative "levels 0 and 1" "shortest and longest life" 1 0 "$(rwl $new --wear three.tsv --levels 0,0.5,1 >out
	awk -F '\t' '/^[0-9]/ { print ($3 + 0 > 0 && $3 + 0 < $4 + 0 && $5 + 0 > $4 + 0) }' out)"

# --- size
awk 'BEGIN { print "t\tgap"; for (i = 0; i < 100000; i++) print i "\t" 1e-5 + i * 1e-11 }' >long.tsv
relative "100 000 rows, filter" "100 000 rows out" 100000 0 "$(rwl --threshold-gap 20um --wear-rate filter -c 1 long.tsv | grep -vc '^[#t]')"
awk 'BEGIN { print "realisation\tstep\tvolume"; for (i = 0; i < 100000; i++) print i "\t1\t1e-15" }' >many.tsv
relative "100 000 fragments" "100 s" 100 1e-9 "$(last mean $new --wear many.tsv -c 50)"
relative "100 000 paths" "100 s" 100 0.1 "$(last q50 $new --wear three.tsv -c 100000)"
done_testing

#!/bin/sh
# Chapter 4: the 90 % intervals of rwl hold nine truths in ten, and
# a million rows pass in constant memory
. "$(dirname "$0")/../tap.sh"

# within NAME VALUE LOW HIGH
within() {
	if awk -v v="$2" -v a="$3" -v b="$4" 'BEGIN { exit !(v ~ /^[-+0-9.]/ && v >= a && v <= b) }'; then
		pass "$1: $2"
	else
		fail "$1" "got:  $2" "want: $3 to $4"
	fi
}

# --- coverage.  Each unit: an ensemble of 30 fragments (lognormal, spread 0.4) and a
# truth: a plate of countless fragments wears their true mean; a plate that is one
# fragment wears as one more draw.
awk 'function uniform() { state = state * 16807 % 2147483647; return state / 2147483647 }
function normal() { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()) }
BEGIN {
	state = 4711
	for (unit = 1; unit <= 300; unit++) {
		file = "unit" unit ".tsv"
		print "volume" >file
		for (i = 0; i < 30; i++) printf "%.9g\n", 1e-15 * exp(0.4 * normal()) >file
		close(file)
		printf "%d %.9g %.9g\n", unit, 1 / exp(0.08), exp(-0.4 * normal())
	}
}' >truths
# covered PARTS TRUTH-FIELD: share of intervals that hold the truth; 1e-15 m3 per step
# on 1e-8 m2 is 0.1 um per second, 10 um are left: 100 s over the truth
covered() {
	while read -r unit plate one; do
		rwl --new --wear "unit$unit.tsv" --step-time 1s --initial-gap 10um --threshold-gap 20um \
			--parts "$1" --count 400 |
			awk -F '\t' -v a="$plate" -v b="$one" -v k="$2" \
				'/^[0-9]/ { t = 100 * (k == 1 ? a : b); print (t >= $3 && t <= $5) }'
	done <truths | awk '{ s += $1; n++ } END { printf "%.3f", s / n }'
}
within "the 90 % interval holds nine in ten lives of plates of countless fragments" "$(covered 0 1)" 0.84 0.95
within "the 90 % interval holds nine in ten lives of plates that wear as one fragment" "$(covered 1 2)" 0.84 0.95

# --- filters: 100 units of even wear with noise and a passing wander, at 60 % of life
awk 'function uniform() { state = state * 16807 % 2147483647; return state / 2147483647 }
function normal() { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()) }
BEGIN {
	state = 815
	for (unit = 1; unit <= 100; unit++) {
		file = "run" unit ".tsv"
		print "t\tgap" >file
		rate = 3e-9 * exp(0.2 * normal())
		for (t = 0; 1e-5 + rate * t < 1.24e-5; t++) {
			wander = 0.92 * wander + 0.39 * 4e-8 * normal()
			printf "%d\t%.9g\n", t, 1e-5 + rate * t + wander + 8e-8 * normal() >file
		}
		close(file)
		printf "%d %.9g\n", unit, 4e-6 / rate - t + 1
	}
}' >ends
within "the 90 % interval of the rate filter holds nine in ten lives or more" "$(while read -r unit truth; do
	rwl --wear-rate filter --threshold-gap 14um --count 400 "run$unit.tsv" | grep -v '^#' | tail -1 |
		awk -F '\t' -v t="$truth" '{ print ($3 ~ /^[0-9]/ && t >= $3 + 0 && ($5 == "inf" || t <= $5 + 0)) }'
done <ends | awk '{ s += $1; n++ } END { printf "%.3f", s / n }')" 0.85 1

# --- a million rows
rows() { awk -v n="$1" 'BEGIN { print "t\tgap"; for (i = 0; i < n; i++) print i "\t" 1e-5 + i * 1e-12 }'; }
for n in 10000 1000000; do
	rows $n | rwl --threshold-gap 20um --wear-rate filter -c 2 --grey --stats stats.$n >out.$n
done
is "a million rows are written" "$(grep -c '^[0-9]' out.1000000)" 1000000
within "a million rows need the memory of ten thousand" \
	"$(echo "$(column memory_kb stats.1000000) $(column memory_kb stats.10000)" | awk '{ print $1 / $2 }')" 0.8 1.2
done_testing

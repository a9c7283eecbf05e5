#!/bin/sh
# Extreme scenes of debriscount and ballcal: accurate, or refused or marked in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# cell COLUMN OPTION...: the first cell of a column of debriscount, in 9 digits
cell() {
	c=$1
	shift
	debriscount "$@" >out 2>err
	column "$c" out | awk 'NR == 1 { print $1 ~ /^[-0-9.]/ ? sprintf("%.9g", $1) : $1 }'
}
# particles N DIAMETER: a table of them, one each second
particles() {
	awk -v n="$1" -v d="$2" 'BEGIN { print "time1\tdiameter"; for (i = 0; i < n; i++) print i "\t" d }'
}

particles 0 1e-6 >none.tsv
particles 1 100e-6 >one.tsv
particles 100000 10e-6 >many.tsv
scene "no particle in a year" "upper limit -ln 0.025 a year" 3.68887945 1e-8 "$(cell number_high --duration 365d none.tsv)"
scene "no particle" "code 0 of any volume" 0 0 "$(debriscount --output codes --volume 100mL none.tsv --duration 1s |
	grep -v '^#' | tail -n 1 | cut -f 4 | cut -d / -f 1 | tr -d '>=')"
scene "one particle" "lower limit -ln 0.975" 0.0253178079 1e-9 "$(cell number_low --duration 1h one.tsv)"
scene "100000 particles" "interval near 2 x 1.96 sqrt(n)" 1 2e-3 "$(cell number_high --duration 2d many.tsv >h
	cell number_low --duration 2d many.tsv >l; paste h l | awk '{ printf "%.6f", ($1 - $2) / (2 * 1.959964 * sqrt(1e5)) }')"
is "1e6 particles in a millilitre | code 27: to 1.3e6 | 27 | none" "$(
	debriscount --output codes --volume 0.1mL many.tsv --duration 2d | grep -v '^#' | tail -n 1 | cut -f 4 | cut -d / -f 1)" 27
is "1e11 particles in a millilitre | beyond the table | >28/>28/>=0 | none" "$(
	debriscount --output codes --volume 1e-12m3 many.tsv --duration 2d | grep -v '^#' | tail -n 1 | cut -f 4)" ">28/>28/>=0"
particles 3 1e-12 >atoms.tsv
scene "particles of 1 pm" "their mass" 1 1e-6 "$(cell kg_per_hour --duration 1h --density 1000kg/m3 atoms.tsv |
	awk '{ printf "%.9f", $1 / (3 * 3.14159265359 / 6 * 1e-33) }')"
particles 3 1e-2 >balls.tsv
scene "particles of 1 cm" "their mass" 1 1e-6 "$(cell kg_per_hour --duration 1h --density 1000kg/m3 balls.tsv |
	awk '{ printf "%.9f", $1 / (3 * 3.14159265359 / 6 * 1e-3) }')"
particles 3 1e6 >moons.tsv
refused "particles of 1000 km" 1 'want metres' debriscount --duration 1h moons.tsv
particles 2 1e-6 >blind.tsv
scene "particles detected with probability 1e-6" "each counts as 1e6" 1 1e-5 "$(
	cell number --duration 1h --d50 1m --detection-threshold 4.753424 blind.tsv | awk '{ printf "%.6f", $1 / 2e6 }')"
is "classes below the detection limit | no upper limit | inf | none" \
	"$(cell number_high --duration 1h --d50 1mm --detection-threshold 60 --classes 1um one.tsv)" inf
scene "periods of a nanosecond around one particle" "the rate of that period" 3.6e12 1e4 "$(printf 'time1\tdiameter\n1e-10\t1e-6\n' >now.tsv
	cell per_hour --period 1e-9s --duration 1e-9s now.tsv)"
scene "a material of 300 kinds" "one row each" 300 0 "$(awk 'BEGIN { print "time1\tdiameter\tm"
	for (i = 0; i < 300; i++) print "1\t1e-6\tk" i }' | debriscount --by m --duration 1s | grep -c '^0')"
printf 'time1\tdiameter\tverdict\tsources\n1\t1e-4\tunresolved\t1e300\n' >huge.tsv
is "a stretch of 1e300 particles | counted | 1e+300 | none" "$(cell number --duration 1s huge.tsv)" 1e+300
printf 'time1\tdiameter\n-1\t1e-6\n' >before.tsv
refused "a time before the record" 1 'want a time of 0 or later' debriscount --duration 1s before.tsv
printf 'time1\tdiameter\n1\tinf\n' >inf.tsv
refused "an infinite diameter" 1 'want a positive number' debriscount --duration 1s inf.tsv
printf 'time1\tdiameter\n1\t0\n' >zero.tsv
refused "a diameter of 0" 1 'want a positive number' debriscount --duration 1s zero.tsv

balls() { # AMPLITUDE...
	printf 'amplitude\tvelocity\n'
	printf '%s\t1\n' "$@"
}
balls 1e-300 1.01e-300 0.99e-300 >small.tsv
balls 1e-294 1.01e-294 0.99e-294 >large.tsv
ballcal --balls small.tsv:1um --balls large.tsv:100um >cal.tsv 2>err
scene "amplitudes of 1e-300 V" "exponent 3" 3 1e-9 "$(awk '$1 == "exponent" { printf "%.12g", $2 }' cal.tsv)"
balls 1 1 1 >same.tsv
balls 8 8 8 >eight.tsv
ballcal --balls same.tsv:1mm --balls eight.tsv:2mm >cal.tsv 2>err
scene "no scatter at all" "exponent 3" 3 1e-12 "$(awk '$1 == "exponent" { printf "%.15g", $2 }' cal.tsv)"
balls 1 0 1 >dead.tsv
refused "a pulse without amplitude" 1 'amplitude is 0' ballcal --balls dead.tsv:1mm
balls 1 1 >two.tsv
refused "two pulses" 1 'at least 3 pulses' ballcal --balls two.tsv:1mm
# The record ends with its last particle, before the end of the first period.
debriscount --period 1h one.tsv >out 2>err
is "a period longer than the record | no row, one line | $(grep -c '^[0-9]' out) $(grep -c 'no period of 3600 s is complete' err) | none" \
	"$(grep -c '^[0-9]' out) $(grep -c 'no period of 3600 s is complete' err)" "0 1"
debriscount --period 1h --duration 2h one.tsv >out 2>err
is "the same with a duration of two periods | two rows | $(grep -c '^[0-9]' out) | none" \
	"$(grep -c '^[0-9]' out) $(wc -l <err | tr -d ' ')" "2 0"
done_testing

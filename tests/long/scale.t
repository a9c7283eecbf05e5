#!/bin/sh
# Tables of particles are read in one pass and in memory that does not grow with them
. "$(dirname "$0")/../tap.sh"

if ! ${CC:-cc} -O2 -o particles "$top/tests/scale/particles.c" -lm 2>err; then
	skip 'a million particles need no more memory' 'no compiler'
	done_testing
fi
# A thousand rows a realisation: the number of realisations grows, too.
for n in 100000 1000000; do
	./particles $n | debrisstat --stats "stat.$n" >"fits.$n" 2>err
	is "debrisstat reads $n particles" "$(column particles "stat.$n")" "$n"
	./particles $n | rwl --new --wear - --step-time 1h --threshold-gap 11um --count 100 --stats "life.$n" \
		>"lives.$n" 2>err
	is "rwl reads $n particles" "$(column fragments_read "life.$n")" "$n"
done
# 131072 diameters and the sums of up to a million steps are kept apart
for f in stat life; do
	near "$f: ten times the particles need less than four megabytes more" \
		"$(echo "$(column memory_kb $f.1000000) $(column memory_kb $f.100000)" | awk '{ print ($1 - $2 < 4096) }')" 1 0
done
# The generator draws from a Weibull distribution of shape 2 and scale 10 um.
fitted() {
	awk -F '\t' -v name="$1" '$1 == name { print $2 }' fits.1000000
}
head -n 20 fits.1000000 >shown
near 'the fitted shape is the one put in' "$(fitted weibull_shape)" 2 0.01
near 'the fitted scale is the one put in' "$(fitted weibull_scale)" 1e-5 2e-8
done_testing

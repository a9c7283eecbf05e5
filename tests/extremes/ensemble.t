#!/bin/sh
# Stiff and extreme scenes of debrisstat and records, and thirty wear steps of debrisgen:
# accurate, or refused in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# fitted QUANTITY FILE
fitted() {
	awk -F '\t' -v q="$1" '$1 == q { print $2 }' "$2"
}

# --- debrisstat.  weibull N SCALE SHAPE: quantiles of the law, so that no draw scatters
weibull() {
	awk -v n="$1" -v s="$2" -v k="$3" 'BEGIN { print "realisation\tstep\tvolume\tdiameter\taspect"
		for (i = 0; i < n; i++) { d = s * exp(log(-log(1 - (i + 0.5) / n)) / k)
			printf "%d\t1\t%.17g\t%.17g\t1\n", i % 20, 0.5235987755982988 * d * d * d, d } }'
}
weibull 2000 2e-4 2.718 | debrisstat >fits
shape=$(fitted weibull_shape fits)
# 2000 quantiles of a law fit it but for their grain at the ends
relative 'Weibull of shape 2.718 and scale 200 um' 'the shape' 2.718 0.002 "$shape"
for unit in 1e-12 1e-7 1e-4; do
	weibull 2000 "$(awk -v u=$unit 'BEGIN { print 200 * u }')" 2.718 | debrisstat >fits
	relative "diameters of the order of $unit m" 'the same shape' "$shape" 1e-9 "$(fitted weibull_shape fits)"
done
weibull 2000 2e-4 50 | debrisstat >fits
relative 'shape 50: all nearly equal' 'the shape' 50 0.002 "$(fitted weibull_shape fits)"
weibull 2000 2e-7 0.3 | debrisstat >fits
relative 'shape 0.3: diameters over 15 decades' 'the shape' 0.3 0.002 "$(fitted weibull_shape fits)"
weibull 2000 2e-7 0.2 | debrisstat >fits
relative 'shape 0.2: diameters over 22 decades' 'the shape' 0.2 0.002 "$(fitted weibull_shape fits)"
weibull 1 2e-4 2 | debrisstat >fits
exactly 'one particle' 'counted, not fitted' '1 nan' "$(fitted particles fits) $(fitted weibull_shape fits)"
awk 'BEGIN { print "realisation\tstep\tvolume\tdiameter\taspect"; for (i = 0; i < 50; i++) print i "\t1\t1e-15\t1e-5\t1" }' |
	debrisstat >fits
exactly 'fifty equal particles' 'counted, not fitted' '50 nan' "$(fitted particles fits) $(fitted weibull_shape fits)"
weibull 100000 2e-4 2.718 | debrisstat --bootstrap 20 >fits
relative '100 000 particles, 20 bootstraps' 'the shape' 2.718 0.001 "$(fitted weibull_shape fits)"
printf 'realisation\tstep\tvolume\tdiameter\taspect\n0\t1\t1e-15\t-1e-5\t1\n' >negative
refused 'a diameter below zero' 1 'diameter' debrisstat negative

# --- records
roughgen --points 1 --sq 0 >point.nrrd
exactly 'a field of one point' 'one record of 1 x 1' '1 1' "$(records point.nrrd | awk -F '\t' '/^1\t/ { print $5, $6 }')"
roughgen --points 4096x16 --length 4096umx16um --sq 1um --corr 10um >strip.nrrd
exactly 'a strip of 4096 x 16' 'its sides' '4096 16' "$(records strip.nrrd | awk -F '\t' '/^1\t/ { print $5, $6 }')"
roughgen --points 8 --sq 1um --count 1000 >many.nrrd
exactly 'a thousand records' 'the thousandth alone has 64 heights' 64 "$(records --pick 1000 --output text many.nrrd | awk '!/^#/ && NF { n += NF } END { print n + 0 }')"
head -c 700 many.nrrd >cut.nrrd
refused 'a stream cut off in a record' 1 'cut off\|ends\|wanted\|want' records --check cut.nrrd

# --- thirty steps on one surface: what the particles have is what the surface has lost
roughgen --points 64 --length 1mm --sq 0.8um --corr 50um --crown auto --seed 3 >start.nrrd
bemcontact --load 20N --young 210GPa start.nrrd |
	debrisgen --yield 355MPa --friction 0.3 --steps 30 --stop-area 1 --surface worn.nrrd --summary steps.tsv >particles.tsv 2>/dev/null
height() { records --field height "$1" | awk -F '\t' '/^[0-9]/ { m = $11 } END { print m }'; }
lost=$(awk -v a="$(height start.nrrd)" -v b="$(height worn.nrrd)" 'BEGIN { printf "%.12g", (a - b) * 1e-6 }')
relative 'thirty wear steps' 'volume lost by the surface' "$lost" 1e-9 \
	"$(column volume particles.tsv | awk '{ s += $1 } END { printf "%.12g", s }')"
relative 'thirty wear steps' '30 steps' 30 0 "$(column step steps.tsv | tail -n 1)"
done_testing

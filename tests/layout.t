#!/bin/sh
# layout: the bound beside reference values, probabilities beside drawn particles, refusals
. "$(dirname "$0")/tap.sh"

# The layouts of which reference values are known: sd(v) / v in 1e-4 at 40 dB.
layout --coils 0 --coils 0,5cm --coils 0,25cm --coils 0,5cm,25cm --coils 0,0,25cm,25cm \
	--coils 0,25cm,50cm --snr 40dB --arrivals 100 --spread 2.5% --zone 127.3mm --method closed >six.tsv
is "six layouts give six rows" "$(column coils six.tsv | wc -l)" 6
is "relative errors of the velocity are those of the closed form" \
	"$(awk -F '\t' '/^[0-9]/ { printf "%.3g ", $10 / $5 * 1e4 }' six.tsv)" "7.52 4.44 1.55 1.44 1.1 0.797 "
layout --coils 0,25cm --snr 20dB --arrivals 100 >weak.tsv
near "ten times the noise gives ten times the error" \
	"$(column se_velocity weak.tsv | awk '{ printf "%.6f", $1 * 1000 }')" 19.74 0.01
layout --coils 0,25cm --snr 40dB --arrivals 100 --diameter 46.41589um >small.tsv
near "a particle of a tenth of the volume has a tenth of the signal" \
	"$(column se_velocity small.tsv | awk '{ printf "%.6f", $1 * 1000 }')" 19.74 0.01

layout --coils 0,25cm --coils 0,5cm,25cm --snr 40dB --arrivals 100 --method closed >closed.tsv 2>err
layout --coils 0,25cm --coils 0,5cm,25cm --snr 40dB --arrivals 100 --method sum --stats s >sum.tsv
near "integrals and sums over 100 samples agree to 1e-3" "$(paste closed.tsv sum.tsv |
	awk -F '\t' '/^[0-9]/ { d = $10 / $25 - 1; if (d < 0) d = -d; if (d > m) m = d } END { printf "%.6f", m }')" 0 1e-3
near "summed samples are counted" "$(column samples_summed s)" 8000 0
layout --coils 0,25cm --snr 40dB --arrivals 100 --rate 1MHz --stats s >fine.tsv
near "sums are skipped where the integrals are exact to all digits" "$(column samples_left_out s)" 320000 32

# Probabilities: a truth table of 20000 particles of sensorsim, 2000 of them asked.
chance() { # awk condition on the particles i and j, true where j stands in the way of i
	awk -F '\t' '/^[0-9]/ { a[n] = $2; b[n] = $3; v[n++] = $7 }
	END { for (i = 1000; i < n - 1000; i += 9) { m++; bad = 0
		for (j = i - 40; j <= i + 40; j++) if (j != i && ('"$1"')) bad = 1
		free += !bad } printf "%.5f", free / m }' truth.tsv
}
sensorsim --uniform 100um:100um --number 20000 --duration 500s --profile turbulent --truth - >truth.tsv
is "particles are simulated" "$(column time1 truth.tsv | wc -l)" 20000
layout --coils 0,25cm --snr 40dB --arrivals 40 --profile turbulent >p.tsv
# 2000 draws of 0.45: 0.011
near "as many pulses are isolated as in the simulation" "$(column p_alone p.tsv)" \
	"$(chance '(a[i] - a[j]) ^ 2 < (0.1273239545 * (1 / v[i] + 1 / v[j]) / 2) ^ 2')" 0.035
sensorsim --uniform 100um:100um --number 20000 --duration 200s --lag 0:0.9817ms --truth - >truth.tsv
# transit 19.635 to 20.617 ms: 20.126 ms by 2.439 % either way
layout --coils 0,25cm --snr 40dB --arrivals 100 --spread 2.439% --flow 58.535L/min >p.tsv
near "as many pulses have a unique candidate as in the simulation" "$(column p_unique p.tsv)" \
	"$(chance 'b[j] > a[i] + 0.019635 && b[j] < a[i] + 0.020617')" 0.02

# sd(t) = T / (snr sqrt(2 n) pi): 100 samples of 10 ms at 40 dB
layout --coils 0,25cm --snr 40dB --arrivals 1e4 --profile plug >plug.tsv
near "particles of one velocity are confused within the error of their delays" "$(column p_unique plug.tsv)" \
	"$(awk 'BEGIN { printf "%.12f", exp(-1e4 * 6 * sqrt(2) * 0.01 / (100 * sqrt(200) * 3.14159265358979)) }')" 1e-9

layout --best 4 --extent 1m --least-unique 0 --snr 40dB --arrivals 100 --spread 10% >best.tsv
is "without a bound on matching half of the coils are at either end" "$(column coils best.tsv)" "0,0,1,1"
layout --best 3 --extent 1m --least-unique 0.99 --snr 30dB --arrivals 100 --spread 10% --stats s >best.tsv
near "with a bound the best layout just meets it" "$(column p_unique_width best.tsv)" 0.99 1e-6
rising "layouts evaluated are counted" 500 "$(column layouts_searched s)"
layout --coils "$(column coils best.tsv)" --snr 30dB --arrivals 100 --spread 10% >again.tsv
is "the best layout has the same row if it is given" "$(sed "/^#/d" again.tsv)" "$(sed "/^#/d" best.tsv)"

layout --coils 0,1 --snr -30dB --arrivals 1 >low.tsv 2>err
is "a particle below the noise gives a warning and status 3" "$? $(grep -c deviations err)" "3 1"
layout --coils 0 --snr 40dB --per-ml 0 >none.tsv
is "oil without other particles has no overlaps" "$(column p_alone none.tsv) $(column arrivals none.tsv)" "1 0"
layout --coils 0 --snr 40dB --per-ml 0.1 --flow 60L/min >some.tsv
near "concentration times flow is the rate of arrivals" "$(column arrivals some.tsv)" 100 1e-9

# Three layouts with 200 particles each, as duet finds them: 5 % of one standard error.
for d in 10 25 50; do
	sensorsim --uniform 100um:100um --number 200 --burst 1 --span 1ms --period 100ms --spacing ${d}cm --snr 30dB \
		--seed 6 --truth truth.tsv | duet --pulse sine --gain 1 --spacing ${d}cm >found.tsv
	layout --coils 0,${d}cm --snr 30dB --arrivals 1 >bound.tsv
	for q in time1:se_time velocity:se_velocity; do
		near "the ${q%:*} of duet with coils $d cm apart is as exact as the bound" "$({
			column "${q%:*}" truth.tsv >a
			column "${q%:*}" found.tsv | paste a - | awk -v se="$(column "${q#*:}" bound.tsv)" '
				{ s += ($1 - $2) ^ 2 } END { printf "%.4f", sqrt(s / NR) / se }'
		})" 1 0.15
	done
done

fails "neither coils nor a search" 2 'specify either --coils X,X,... or --best N' layout --snr 40dB --arrivals 1
fails "a search without room" 2 'requires --extent' layout --best 2 --snr 40dB --arrivals 1
fails "an extent without a search" 2 '\--extent requires --best' layout --coils 0 --extent 1m --snr 40dB --arrivals 1
layout --coils 0 --bore 10 --flow 1 --snr 40dB --arrivals 1 >out 2>err
is "metres and cubic metres by mistake give a hint" "$(grep -c 'is 10mm meant' err) $(grep -c 'is 1L/min meant' err)" "1 1"
fails "the exponent of a profile that has none" 2 '\--exponent requires --profile turbulent' \
	layout --coils 0 --snr 40dB --arrivals 1 --exponent 8
fails "no signal to noise ratio" 2 '\--snr is missing' layout --coils 0 --arrivals 1
fails "no rate of arrivals" 2 'specify either --arrivals F or --per-ml N' layout --coils 0 --snr 40dB
fails "positions that do not ascend" 2 'positions must be ascending' layout --coils 1,0 --snr 40dB --arrivals 1
fails "a position without a unit that is one" 2 'want positions in m' layout --coils 0,5s --snr 40dB --arrivals 1
fails "a sum of more samples than can be addressed" 1 'out of memory: a pulse has 1.57' \
	layout --coils 0,25cm --snr 30dB --arrivals 1 --method sum --flow 1e-12 --bore 1m --zone 1km --rate 2GHz
fails "more coils than there is room for" 2 'more than 16 coils' \
	layout --coils 0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16 --snr 40dB --arrivals 1
fails "a second layout that is wrong is found before any output" 2 "want positions" \
	layout --coils 0,1 --coils x --snr 40dB --arrivals 1
is "a layout that is wrong prints nothing" "$(cat out)" ""
done_testing

#!/bin/sh
# Extreme scenes of layout: accurate, or refused or marked in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# cell COLUMN OPTION...: the first cell of a column, in six digits
cell() {
	c=$1
	shift
	layout "$@" >out 2>err
	column "$c" out | awk 'NR == 1 { printf "%.6g", $1 }'
}
two="--coils 0,25cm --arrivals 100"

scene "snr of 400 dB" "the error of 40 dB times 1e-18" 1.97393 1e-5 \
	"$(cell se_velocity $two --snr 400dB | awk '{ print $1 * 1e21 }')"
scene "snr of -100 dB" "status 3" 3 0 "$(layout $two --snr -100dB >out 2>err; echo $?)"
scene "1e6 particles per ml" "no pulse stands alone" 0 0 \
	"$(cell p_alone --coils 0,25cm --snr 40dB --per-ml 1e6)"
scene "no particles" "every pulse stands alone" 1 0 "$(cell p_alone --coils 0 --snr 40dB --per-ml 0)"
# the first order in the rate: 2 arrivals T = 2e-12 * 0.01 s, lost beside 1
scene "one particle in 30000 years" "every pulse stands alone" 1 0 \
	"$(cell p_alone --coils 0 --snr 40dB --arrivals 1e-12Hz)"
is "one sample a pulse on one coil | undetermined, status 3 | inf 3 | none" \
	"$(cell se_velocity --coils 0 --arrivals 1 --snr 40dB --rate 100Hz) $(
		layout --coils 0 --arrivals 1 --snr 40dB --rate 100Hz >out 2>err; echo $?)" "inf 3"
scene "2e16 samples a pulse" "sqrt(1e9) times better than 2e7" 1 1e-3 "$(
	a=$(cell se_velocity $two --snr 40dB --rate 2e9Hz --flow 1e-12m3/s --method closed)
	b=$(cell se_velocity $two --snr 40dB --rate 2Hz --flow 1e-12m3/s --method closed)
	awk -v a="$a" -v b="$b" 'BEGIN { printf "%.6f", a / b * sqrt(1e9) }')"
# far apart the width of the pulses counts for nothing: sd(v)/v = sd(t) sqrt(2) v / D
scene "coils 1 km apart" "error of the delay over the delay" 1 1e-5 "$(
	a=$(cell se_velocity --coils 0,1000 --snr 40dB --arrivals 1 --method closed)
	awk -v a="$a" 'BEGIN { printf "%.7f", a / (12.7323954 * sqrt(2) * 0.12732395 / 1000 / sqrt(1e6 * 2 * 3.14159265 ^ 2)) }')"
scene "16 coils in one place" "a quarter of the error of one" 0.25 1e-5 "$(
	a=$(cell se_velocity --coils 0 --snr 40dB --arrivals 1 --method closed)
	b=$(cell se_velocity --coils 0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0 --snr 40dB --arrivals 1 --method closed)
	awk -v a="$a" -v b="$b" 'BEGIN { printf "%.6f", b / a }')"
scene "a zone of 1 nm" "worst zone stays 1.67 spacings" 0.417442 1e-6 "$(cell zone_worst $two --snr 40dB --zone 1nm --method closed)"
scene "transit times that differ by 99.9 %" "nothing is paired by its delay alone" 0 1e-100 \
	"$(cell p_unique --coils 0,25cm --snr 40dB --spread 99.9% --arrivals 1e6)"
scene "the 1/100 law, almost a plug" "alone as in a plug" 1 2e-3 "$(
	a=$(cell p_alone $two --snr 40dB --profile turbulent --exponent 100)
	awk -v a="$a" 'BEGIN { printf "%.6f", a / exp(-2) }')"
scene "8 coils, best positions" "four at each end" 4 0 "$(
	layout --best 8 --extent 1m --least-unique 0 --snr 40dB --arrivals 1 >out
	column coils out | tr ',' '\n' | grep -c '^1$')"
refused "a particle twice as large as the bore" 2 'does not fit' \
	layout $two --snr 40dB --diameter 2cm --bore 1cm
refused "a rate of 0.1 Hz" 2 'want 1' layout $two --snr 40dB --rate 0.1Hz
refused "a coil 2 km away" 2 'beyond 1000 m' layout --coils 0,2000 --snr 40dB --arrivals 1
refused "a coil position that is not a number" 2 'want positions' layout --coils 0,nan --snr 40dB --arrivals 1
done_testing

#!/bin/sh
# Prognosis at the edge: each scene is accurate or refused in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# accurate SCENE EXPECTATION GOT WANT TOLERANCE (relative; to 1 where WANT is 0)
accurate() {
	relative "$1" "$2" "$4" "$5" "$3"
}

# series N EXPRESSION: t = 0 .. N - 1 (times T), y by awk
series() {
	awk "BEGIN { print \"t\\ty\"; pi = atan2(0, -1)
		for (t = 0; t < $1; t++) printf \"%.17g\\t%.17g\\n\", t * ${3:-1}, $2 }"
}

# last COLUMN ARG...: that column of the last row of aopf
last() {
	name=$1
	shift
	aopf "$@" >out 2>err || { head -1 err; return; }
	column "$name" out | tail -1
}

# odd_cells ROWS: how many cells of out, which has so many rows, are not finite where they
# should be (from the fifth row on)
odd_cells() {
	awk -F '\t' -v rows="$1" '/^[0-9]/ && ++n > 4 { for (i = 3; i <= 7; i++) if ($i ~ /nan|inf/) bad++ }
		END { print n == rows ? bad + 0 : n + 0 " rows" }' out
}

series 50 2 >s
accurate "constant series" "forecast as it is" "$(last prediction s)" 2 1e-6
# That no wear shows is no promise that none begins, but a healthy unit is not near its end
# either: the 5 % quantile is between a quarter of the age and the age.
accurate "constant series, threshold 3" "no crossing: 0.65 to 0.95" "$(last p_no_crossing -y 3 s)" 0.8 0.19
accurate "constant series, threshold 3" "may begin to wear: 12 to 50" "$(last rul_q05 -y 3 s)" 31 0.6
exactly "constant series, grey model" "no crossing" 1 "$(last p_no_crossing -y 3 --model grey s)"
series 50 '2 + 1e-12 * (t % 3)' >s
accurate "nearly constant series (1e-12)" "forecast as it is" "$(last prediction s)" 2 1e-9
series 50 0 >s
accurate "zero series" "forecast 0" "$(last prediction s)" 0 1e-6

series 1 1 >s
accurate "one point" "state is the point" "$(last state s)" 1 1e-6
series 2 1+t >s
accurate "two points" "state is the point" "$(last state s)" 2 1e-6
exactly "two points, threshold 5" "no life predicted yet" nan "$(last rul_q50 -y 5 s)"
series 4 1+t >s
accurate "four points on a line, threshold 10" "6 left by the straight line" "$(last rul_q50 --threshold 10 --model linear s)" 6 0.02
: >empty
refused "empty input" 1 "empty, want table" aopf empty
printf 't\ty\n0\tnan\n1\tnan\n2\tnan\n' >s
exactly "nothing but missing values" "state nan" nan "$(last state -y 1 s)"

series 200 't < 100 ? 1 : 2' >s
accurate "step by 1" "state follows within 100 rows" "$(last state s)" 2 0.01
series 200 't == 100 ? 1000 : 1 + t / 1000 + 0.01 * sin(t * t)' >s
accurate "one outlier of 1e5 sigma" "state returns" "$(last state s)" 1.199 0.02
accurate "one outlier of 1e5 sigma, threshold 1.4" "201 left" "$(last rul_q50 -y 1.4 s)" 201 0.15
series 100 't == 0 ? -1e6 : 1 + t / 1000 + 0.01 * sin(t * t)' >s
accurate "first value 1e8 sigma below the others, threshold 1.2" "101 left" "$(last rul_q50 -y 1.2 --direction up --lives-only s)" 101 0.2
series 101 'int(t / 25) / 6' >s
accurate "readings in steps of a sixth of the way, one in 25 rows" "50 left" "$(last rul_q50 -y 1 --lives-only s)" 50 0.5
series 120 't * t / 9e4 + 2e-4 * sin(t * t)' >s
accurate "wear as the square of time, 40 % of the life" "181 left" "$(last rul_q50 -y 1 --lives-only s)" 181 0.15
series 60 'exp(t)' >s
accurate "exploding series, e per row" "grey forecast" "$(last grey s)" \
	"$(awk 'BEGIN { print exp(59) }')" 0.3
exactly "exploding series" "all finite" 0 "$(odd_cells 60)"
accurate "exploding series" "state follows, at most a row behind" "$(last state s)" \
	"$(awk 'BEGIN { print exp(59) }')" 0.64
series 60 'exp(-t)' >s
aopf s >out
exactly "vanishing series, 1/e per row" "all finite" 0 "$(odd_cells 60)"

series 100 '1 + t / 100' >s
accurate "threshold already passed" "0 left" "$(last rul_q95 -y 1.5 s)" 0 0
accurate "threshold at the first value" "0 left" "$(last rul_q50 -y 1 --direction up s)" 0 0
status=0
aopf -y 0.5 --direction down s >out 2>err || status=$?
exactly "threshold on the other side" "never, status 3" "inf 3" "$(column rul_q05 out | tail -1) $status"
# A row of a part in 1e300 of the range says little of how the wear goes on.
accurate "threshold 1e300" "no crossing: at least 0.8" "$(last p_no_crossing -y 1e300 s)" 0.9 0.12
accurate "threshold at twice the life" "100 left" "$(last rul_q50 -y 2.99 s)" 100 0.01

series 100 '1 + 0.001 * t' >s
accurate "noise 1e-12 times the model error" "ess >= 1" \
	"$(last ess --sigma-v 1e-15 s | awk '{ print ($1 ~ /^[0-9]/ && $1 + 0 >= 1) }')" 1 0
accurate "noise 1e12 times the series" "ess of the order of N" "$(last ess --sigma-v 1e12 s)" 300 0.5
accurate "one particle" "state near the data" "$(last state --particles 1 s)" 1.099 0.05
accurate "order 1000 of 100 points" "state" "$(last state --order 1000 s)" 1.099 0.01

for scale in 1e-300 1e-12 1e12 1e300; do
	series 100 "(1 + 0.001 * t) * $scale" >s
	accurate "values of $scale" "state scales" \
		"$(last state s | awk -v s=$scale '{ print $1 / s }')" 1.099 1e-3
	accurate "values of $scale, threshold 1.2" "101 left" \
		"$(last rul_q50 -y "$(awk "BEGIN { printf \"%.17g\", 1.2 * $scale }")" s)" 101 0.01
	accurate "values of $scale, grey model" "101 left" \
		"$(last rul_q50 --model grey -y "$(awk "BEGIN { printf \"%.17g\", 1.2 * $scale }")" s)" \
		101 0.15
	series 100 "1 + 0.001 * t" "$scale" >s
	case $scale in *300) continue ;; esac
	accurate "times of $scale" "the same state" "$(last state s)" 1.099 1e-3
	accurate "times of $scale, threshold 1.2" "101 left" \
		"$(last rul_q50 -y 1.2 s | awk -v s=$scale '{ print $1 / s }')" 101 0.01
done
for scale in 1e-300 1e-12 1e12 1e300; do
	series 100 "0.01 * t * $scale" >s
	accurate "from 0 in steps of 1e-2 of $scale" "state scales" \
		"$(last state s | awk -v s=$scale '{ print $1 / s }')" 0.99 1e-3
	accurate "from 0 in steps of 1e-2 of $scale, threshold 1.5" "51 left" \
		"$(last rul_q50 -y "$(awk "BEGIN { printf \"%.17g\", 1.5 * $scale }")" s)" 51 0.01
done
series 100 '-(1 + 0.001 * t)' >s
accurate "negative values" "state" "$(last state s)" -1.099 1e-3
accurate "negative values falling to -1.2" "101 left" "$(last rul_q50 -y -1.2 --direction down s)" 101 0.01
awk 'BEGIN { print "t\ty"; for (k = 0; k < 60; k++) { t += 10 ^ (k % 7 - 3); printf "%.17g\t%.17g\n", t, 1 + t / 1e4 } }' >s
accurate "gaps of 1e-3 to 1e3" "state" "$(last state s)" \
	"$(tail -1 s | cut -f 2)" 0.01
accurate "gaps of 1e-3 to 1e3, threshold 3" "life" "$(last rul_q50 -y 3 s)" \
	"$(tail -1 s | awk '{ print 2e4 - $1 }')" 0.05

series 8 '1 + 0.1 * t' >s
accurate "2e6 particles" "state" "$(last state --particles 2e6 --max-order 4 s)" 1.7 0.01
refused "times that repeat" 1 "line 3: time 0 comes twice" \
	sh -c 'printf "t\ty\n0\t1\n0\t1\n" | aopf'
refused "time 1e400" 1 "not" sh -c 'printf "t\ty\n1e400\t1\n" | aopf'
refused "value 1e400" 1 "infinite" sh -c 'printf "t\ty\n0\t1e400\n" | aopf'

long() {
	awk -v n="$1" 'BEGIN { print "t\ty"; for (t = 0; t < n; t++) {
		s = (s * 16807 + 1) % 2147483647
		printf "%d\t%.6f\n", t, 1 + t / n + 0.05 * s / 2147483647 } }'
}
long 5000 | aopf --order 4 --particles 10 -S few -y 3 >/dev/null
long 100000 | aopf --order 4 --particles 10 -S stats -y 3 --after 1e5 >out
accurate "100000 rows" "state" "$(column state out | tail -1)" 2.025 0.02
[ -n "${ASAN_OPTIONS:-}" ] || # the sanitizer has an allocator of its own
	accurate "100000 rows" "the memory of 5000" "$(column memory_kb stats)" \
		"$(column memory_kb few)" 0.2

done_testing

#!/bin/sh
# aopf: the lives of simulated units on which something besides wear happens, as two tables.
#
# Of each scene UNITS (42) are simulated, of seven kinds of wear in turn, with 40 to 320
# rows and noise of .3 to 3 % of the way to the threshold, or of 5 to 15 % if the scene names
# noise.  aopf gets the rows up to an age.  The second table is of a load that takes five
# courses in turn, or falls once, and scales the rate of wear by a factor from its lowest
# value to its highest.
#
# age       % of the life
# crps      mean, in % of the life
# coverage  share of ends in the 90 % interval
# wrong     units with exit status 0 whose end is outside of this interval by more than its
#           width and 2 % of the life
# marked    units with exit status 3
. "$(dirname "$0")/setup"
units=${UNITS:-42}
seed=${SEED:-1}

# simulate SCENE [FACTOR]: the units of a scene as files 1, 2, ...; FACTOR: of the rate from
# the lowest load to the highest, by a covariate x
simulate() {
	awk -v units="$units" -v seed="$seed" -v scene="$1" -v factor="${2:-0}" '
	function uniform() { state = state * 16807 % 2147483647; return state / 2147483647 }
	function from(a, b) { return a + (b - a) * uniform() }
	function between(a, b) { return a * exp(log(b / a) * uniform()) }
	function normal(   r) {
		r = sqrt(-2 * log(uniform()))
		return r * cos(6.283185307179586 * uniform())
	}
	function logistic(s) { return 1 / (1 + exp(shape * (turn - s))) }
	function rise(s, at) { return (1 + tanh(20 * (s - at))) / 2 }
	function tanh(x) { return 1 - 2 / (1 + exp(2 * x)) }
	# the damage that a step of the operating time from s makes
	function worn(s, step) { return curve(s + step) - curve(s) }
	function curve(s) {
		if (scene == "wear that levels off beyond the threshold")
			return (1 + beyond) * (logistic(s) - logistic(0)) / (1 - logistic(0))
		if (scene == "two S-shaped steps") return (rise(s, 0.25) + rise(s, turn + 0.1)) * 0.5 + 0.01 * s
		if (kind == 1) return s ^ (shape / 3)
		if (kind == 2) return sqrt(s)
		if (kind == 3) return (exp(shape / 3 * s) - 1) / (exp(shape / 3) - 1)
		if (kind == 4) return (s + (s > turn ? 4 * (s - turn) : 0)) / (5 - 4 * turn)
		if (kind == 5 && s < 1) return (logistic(s) - logistic(0)) / (logistic(1) - logistic(0))
		return s
	}
	function load(pattern, i, rows,   k) {
		if (scene == "falls once") return i < rows / 4
		if (pattern == 0) return i % 2
		if (pattern == 1) return (1 + sin(6.283185307179586 * i / period)) / 2
		if (pattern == 2) return uniform()
		if (pattern == 3) return i / rows
		k = 0.95 * last + 0.3 * normal()
		return k < 0 ? 0 : k > 1 ? 1 : k
	}
	# what the sensor reads at row n
	function read(n, d,   y) {
		if (n % 10 == 0) common = normal()
		y = d + noise * (scene == "bursts of ten rows with common noise" ? common : normal())
		if (scene == "bursts of outliers" && burst-- > 0) return y + high
		if (scene == "bursts of outliers" && uniform() < 0.02) { burst = from(1, 8); high = from(-1, 1) }
		if (scene == "readings beyond the threshold, once" && n >= place && n < place + long) return y + 1
		if (scene == "a ceiling" && d > top) return top + noise * share * normal()
		if (scene == "a sensor that fails" && n > place) return failed
		if (scene == "two machines in turn" && n % 2) return 0.3 * y
		if (scene == "two machines in random order" && uniform() < 0.5) return 0.3 * y
		if (scene == "8 to 30 levels") return int(y * levels) / levels
		return y
	}
	BEGIN {
		state = seed * 7919 + 12345
		for (i = 0; i < 10; i++) uniform()
		for (i = 1; i <= units; i++) {
			kind = i % 7; rows = between(40, 320); shape = from(4.5, 12); turn = from(0.5, 0.8)
			noise = scene ~ /noise/ ? between(0.05, 0.15) : between(0.003, 0.03)
			wander = from(0.06, 0.25); period = between(4, rows); pattern = i % 5
			burst = 0; place = int(from(0.1, 0.35) * rows); long = int(from(3, 8))
			top = from(0.2, 0.9); share = int(from(0, 2)); levels = int(from(8, 31))
			failed = 1.5 * int(from(0, 3)) - 1; halt = from(0.1, 0.8); repair = from(0.1, 0.3)
			beyond = from(0.02, 0.3); jumps = from(6, 25)
			file = i; ratio = (10 * rows) ^ (1 / rows); s = t = d = last = 0
			print (factor ? "t\tx\ty" : "t\ty") >file
			for (n = 0; d < 1 && n < 4000; n++) {
				if (factor) {
					x = load(pattern, n, rows)
					printf "%.9g\t%.9g\t%.9g\n", t, last, read(n, d) >file
					last = x
				} else
					printf "%.9g\t%.9g\n", t, read(n, d) >file
				step = 1 / rows
				if (scene == "rows at random times") step *= -log(uniform())
				if (scene == "bursts of five rows") step *= n % 5 == 4 ? 4.6 : 0.1
				if (scene ~ /bursts of ten rows/) step *= n % 10 == 9 ? 9.1 : 0.1
				if (scene == "rows at a constant ratio") step = n ? t * (ratio - 1) : 0.1 / rows
				before = d
				rate = factor ? factor ^ (x - 0.5) : 1
				if (scene == "6 to 25 jumps")
					d += uniform() < jumps * step ? -log(uniform()) / jumps : 0
				else d += kind == 6 && scene !~ /steps|levels off/ ? step * rate + wander * sqrt(step * rate) * normal() : \
					worn(s, step * rate)
				s += step * rate
				t += step
				if (scene == "a halt" && n == place) t += halt
				if (scene == "a repair" && n == place) d -= repair * d
				if (scene == "a jump" && n == place) d += repair
			}
			if (d > 1) t -= step * (d - 1) / (d - before)
			printf "%d\t%.9g\n", i, t >"ends"
			close(file)
		}
		close("ends")
	}'
}

levels=0.05,0.1,0.15,0.2,0.25,0.3,0.35,0.4,0.45,0.5,0.55,0.6,0.65,0.7,0.75,0.8,0.85,0.9,0.95
# score SCENE AGES ARG...: lines of the table
score() {
	scene=$1
	ages=$2
	shift 2
	for age in $ages; do
		while read -r file end; do
			awk -v last="$age" -v end="$end" 'NR == 1 || $1 <= last / 100 * end' "$file" >rows
			status=0
			aopf -y 1 --direction up --lives-only --levels $levels "$@" rows >out 2>err || status=$?
			[ $status = 0 ] || [ $status = 3 ] || { cat err >&2; exit 1; }
			awk -F '\t' -v status=$status -v end="$end" '/^#/ { next }
				!q { for (i = 1; i <= NF; i++) if ($i == "rul_q05") q = i; next }
				{ row = $0 }
				END { print status "\t" end "\t" q "\t" row }' out
		done <ends >scored
		awk -F '\t' -v scene="$scene" -v age="$age" '
		{
			n++
			for (k = 1; k <= 19; k++) {
				e[k] = $(3 + $3 + k - 1)
				e[k] = e[k] ~ /inf|nan/ ? 4 : (e[k] - ($2 - $4)) / $2
				if (e[k] > 4) e[k] = 4
				crps += 2 * (e[k] < 0 ? -k / 20 : 1 - k / 20) * e[k] / 19
			}
			held += e[1] <= 0 && e[19] >= 0
			off = e[1] > 0 ? e[1] : -e[19]
			wrong += !$1 && off > e[19] - e[1] && off > 0.02
			marked += $1 == 3
		}
		END { printf "%s\t%d\t%.1f\t%.2f\t%d\t%d\n", scene, age, 100 * crps / n, held / n, wrong, marked }' scored
	done
}

printf 'scene\tage\tcrps\tcoverage\twrong\tmarked\n'
for scene in "nothing" "noise of 5 to 15 %" "8 to 30 levels" "rows at random times" \
	"bursts of five rows" "bursts of ten rows with common noise" \
	"rows at a constant ratio" "a halt" "a repair" "a jump" "6 to 25 jumps" \
	"two S-shaped steps" "wear that levels off beyond the threshold" \
	"bursts of outliers" \
	"readings beyond the threshold, once" "a ceiling" "a sensor that fails" \
	"two machines in turn" "two machines in random order"; do
	simulate "$scene"
	score "$scene" "40 60 80 95"
done
printf '\nload\tfactor\tfuture\tage\tcrps\tcoverage\twrong\tmarked\n'
while read -r factor load; do
	simulate "$load" "$factor"
	score "$load	$factor	none" "40 60 80" </dev/null
	for future in "" :mean :last; do
		score "$load	$factor	x$future" "40 60 80" --covariate "x$future" </dev/null
	done
done <<END
1 varies
3 varies
9 varies
9 falls once
END

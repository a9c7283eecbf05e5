#!/bin/sh
# debriscount: what its intervals are worth and what they cost.
#
# scene     knob       width, coverage, seconds (processor time)
# interval  particles  half width over the value, share of 200 records of a Poisson process
#                      whose 95 % interval of mass per hour holds the true one (sizes uniform
#                      from 50 to 150 um, ten hours), seconds of one
# rows      particles  nan, nan, seconds for so many rows, 100 periods, six classes
. "$(dirname "$0")/setup"

printf 'scene\tknob\twidth\tcoverage\tseconds\n'
for n in 3 10 30 100 1000; do
	k=1
	: >records
	while [ $k -le 200 ]; do
		awk -v n=$n -v k=$k 'BEGIN { srand(k * 7919 + n); print "time1\tdiameter"
			for (t = -36000 / n * log(1 - rand()); t < 36000; t -= 36000 / n * log(1 - rand()))
				printf "%.9g\t%.9g\n", t, 50e-6 + 100e-6 * rand() }' >r.tsv
		debriscount --classes 50um,150um --density 7800kg/m3 --duration 10h --stats s r.tsv >out 2>err
		awk -F '\t' -v s="$(column cpu_seconds s)" 'NR == 4 { print $15, $16, $17, s }' out >>records
		k=$((k + 1))
	done
	# mean of d^3: (150^4 - 50^4) / (4 100) um^3
	awk -v n=$n 'BEGIN { m = n / 10 * 7800 * 3.14159265 / 6 * 1.25e-12 }
		{ w += $1 > 0 ? ($3 - $2) / 2 / $1 : 0; c += $2 <= m && m <= $3; t += $4 }
		END { printf "interval\t%s\t%.4f\t%.3f\t%.5f\n", n, w / NR, c / NR, t / NR }' records
done
for n in 1000 10000 100000 1000000; do
	awk -v n=$n 'BEGIN { srand(1); print "time1\tdiameter"; for (i = 0; i < n; i++) printf "%.9g\t%.6g\n", i, 50e-6 + 1e-4 * rand() }' >r.tsv
	debriscount --standard as4059 --period $((n / 100))s --stats s r.tsv >out
	printf 'rows\t%s\tnan\tnan\t%s\n' $n "$(column cpu_seconds s)"
done

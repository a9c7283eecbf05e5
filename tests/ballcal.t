#!/bin/sh
# ballcal: constant, exponent and smallest size of a sensor from reference balls
. "$(dirname "$0")/tap.sh"

value() {
	awk -F '\t' -v q="$1" -v c="${2:-2}" '$1 == q { print $c }' cal.tsv
}

# Balls through the simulated sensor, pulses as duet finds them.
for d in 60 100 160; do
	sensorsim --uniform ${d}um:${d}um --number 40 --burst 1 --span 1ms --period 100ms --noise 5mV --seed $d >$d.au
	duet --pulse sine --gain 1 --verbose $d.au >$d.tsv 2>err
done
ballcal --balls 60.tsv:60um --balls 100.tsv:100um --balls 160.tsv:160um --noise 5mV --pulse-duration 10ms \
	--false-alarms 1e-3Hz >cal.tsv 2>err
is "three sizes are distinguished" "$(value sizes)" 3
rising "the interval contains the constant of the sensor" "$(value calibration 3)" 78539816339.7 "$(value calibration 4)"
near "the interval is narrow" "$(awk -v a="$(value calibration 3)" -v b="$(value calibration 4)" 'BEGIN { print b / a }')" 1 0.01
rising "the interval of the exponent contains 3" "$(value exponent 3)" 3 "$(value exponent 4)"
# threshold sqrt(2 ln(1e5)) = 4.7985; d50 = (4.7985 0.005 / (K 12.732))^(1/3)
near "the threshold allows one false alarm in 1000 s" "$(value threshold)" 4.79853 1e-5
near "half of the balls of 28.8 um are detected" "$(value d50 | awk '{ print $1 * 1e6 }')" 28.84 0.02
near "90 % of the balls are detected at a size 8.3 % larger" "$(awk -v a="$(value d50)" -v b="$(value d90)" 'BEGIN { print b / a }')" 1.0820 1e-4
# duet's threshold of 5.7 for 1e-9 a sample, 1e-5 a second, is 1 % higher: it searches over the delay, too.
duet --pulse sine --gain 1 --detectable seen.tsv 100.au >100.tsv 2>err
near "the smallest size is the one that duet detects" "$(ballcal --balls 60.tsv:60um --balls 100.tsv:100um \
	--balls 160.tsv:160um --pulse-duration 10ms --false-alarms 1e-5Hz | awk '$1 == "d50" { print $2 * 1e6 }')" \
	"$(awk -F '\t' '/^[0-9]/ { if ($3 >= 0.5) { print 1e6 * (d + (0.5 - p) / ($3 - p) * ($1 - d)); exit } d = $1; p = $3 }' seen.tsv)" 0.3
# Pairs within 40 ms: every other pulse overlaps, some with 30 times the error of one alone.
for d in 60 100; do
	sensorsim --uniform ${d}um:${d}um --number 40 --burst 2 --span 40ms --period 100ms --noise 5mV --seed $d |
		duet --pulse sine --gain 1 >pairs$d.tsv 2>err
done
smallest() {
	ballcal --balls "${1}60.tsv:60um" --balls "${1}100.tsv:100um" --pulse-duration 10ms 2>err |
		awk '$1 == "d50" { print $2 * 1e6 }'
}
near "the smallest size is that of single balls where some pulses overlap" "$(smallest pairs)" "$(smallest '')" 0.1
for d in 60 100; do
	sed '/^#/d; s/alone/overlap/' pairs$d.tsv >crowd$d.tsv
done
fails "no pulse tells the noise" 1 'no pulse stands alone.*want --noise' \
	ballcal --balls crowd60.tsv:60um --balls crowd100.tsv:100um --pulse-duration 10ms
sensorsim --uniform 100um:100um --number 40 --burst 1 --span 1ms --period 100ms --noise 5mV --seed 100 --phase 180deg |
	duet --pulse sine --gain 1 >negative.tsv
ballcal --balls 100.tsv:100um | sed '/^#/d' >right.out
ballcal --balls negative.tsv:100um | sed '/^#/d' >cal.tsv
near "a sensor of reversed polarity has the same constant" "$(value calibration | awk '{ print $1 * 1e-10 }')" \
	"$(awk '$1 == "calibration" { print $2 * 1e-10 }' right.out)" 0.005
awk -F '\t' -v OFS='\t' '/^#/ { next } n++ == 5 { $5 = -$5 } { print }' negative.tsv >mixed.tsv
fails "pulses of either sign" 1 'want the sign of those before' ballcal --balls mixed.tsv:100um
ballcal --balls 60.tsv:60um --balls 100.tsv:100um --balls 160.tsv:160um --noise 5mV --pulse-duration 10ms \
	--false-alarms 1e-3Hz >cal.tsv 2>err
near "all pulses that duet classifies as alone are used" "$(value pulses)" 120 2

# Exact powers: no scatter, no doubt about the exponent.
for d in 1 2 4; do
	awk -v d=$d 'BEGIN { print "amplitude\tvelocity\tverdict"; for (i = 0; i < 5; i++)
		printf "%.17g\t2\talone\n", 2 * d ^ 5 * (1 + (i - 2) * 0.01)
		print "1\t2\tmisfit" }' >$d.tsv
done
ballcal --balls 1.tsv:1mm --balls 2.tsv:2mm --balls 4.tsv:4mm --exponent 5 --stats st >cal.tsv 2>err
is "non-ferrous balls have the exponent 5" "$? $(value exponent | awk '{ printf "%.6f", $1 }')" "0 5.000000"
near "non-ferrous balls have their constant" "$(value calibration | awk '{ print $1 * 1e-15 }')" 1 0.001
is "doubtful rows are left out, counted and reported" "$(column rows_doubtful st) $(grep -c 'left out' err)" "3 1"
ballcal --balls 1.tsv:1mm --balls 2.tsv:2mm --balls 4.tsv:4mm >cal.tsv 2>err
is "non-ferrous balls with exponent 3 are marked by status 3" "$? $(grep -c 'the exponent is 5, not 3' err)" "3 1"
awk 'NR == 1 { print; next } { $1 *= 1.5; print }' OFS='\t' 2.tsv >off.tsv
ballcal --balls 1.tsv:1mm --balls off.tsv:2mm --balls 4.tsv:4mm --exponent 5 >cal.tsv 2>err
is "a size that does not fit the power law is marked by status 3" "$? $(grep -c 'no power law' err)" "3 1"
ballcal --balls 2.tsv:2mm --exponent 5 >cal.tsv 2>err
is "one size determines the constant but not the exponent" "$? $(value sizes) $(value exponent)" "0 1 "
for d in 1 2 4; do
	awk 'NR == 1 { print "# units: mV m/s 1"; print; next } { $1 *= 1000; print }' OFS='\t' $d.tsv >mV$d.tsv
done
ballcal --balls 1.tsv:1mm --balls 2.tsv:2mm --balls 4.tsv:4mm --exponent 5 >cal.tsv
want=$(value calibration)
ballcal --balls mV1.tsv:1mm --balls mV2.tsv:2mm --balls mV4.tsv:4mm --exponent 5 >cal.tsv
near "amplitudes are converted from the units of the table" "$(value calibration | awk '{ print $1 * 1e-15 }')" \
	"$(echo "$want" | awk '{ print $1 * 1e-15 }')" 1e-6

# Errors that the pulses of a table share: 1, -1 and 0.5 % in ln A, beside a scatter of 0.01 %; t of two degrees of
# freedom times their standard deviation, 0.010408, over the root of 3
n=0
for e in 0.01 -0.01 0.005; do
	n=$((n + 1))
	awk -v e=$e 'BEGIN { print "amplitude\tvelocity"; for (i = 0; i < 40; i++)
		printf "%.17g\t1\n", exp(e + 0.7e-4 * (i % 5 - 2)) }' >shared$n.tsv
	awk -v d=$n 'NR == 1 { print; next } { printf "%.17g\t1\n", $1 * d ^ 3 }' shared$n.tsv >size$n.tsv
done
ballcal --balls size1.tsv:1mm --balls size2.tsv:2mm --balls size3.tsv:3mm >cal.tsv 2>err
near "the interval of three tables is that of their means" \
	"$(awk -v a="$(value calibration 3)" -v b="$(value calibration 4)" 'BEGIN { print log(b / a) / 2 }')" 0.025855 1e-5
ballcal --balls size1.tsv:1mm --balls size2.tsv:2mm >cal.tsv 2>err
# 12.7062, Student's t of one degree, times 0.0141421 over the root of 2
near "the interval of the constant of two tables is that of their means" \
	"$(awk -v a="$(value calibration 3)" -v b="$(value calibration 4)" 'BEGIN { print log(b / a) / 2 }')" 0.127062 1e-5
is "two tables do not include a shared error in the exponent, and a message says so" "$(grep -c 'unless a diameter or a record has an error' err)" 1
ballcal --balls size1.tsv:1mm --balls size2.tsv:2mm --balls size3.tsv:3mm >cal.tsv 2>err
rising "errors that tables share leave the exponent in doubt" 0.05 "$(value exponent_p)" 1
ballcal --balls shared1.tsv:0.7mm --balls shared2.tsv:0.7mm --balls shared3.tsv:0.7mm >cal.tsv 2>err
is "three tables of one size do not determine the exponent" "$? $(value sizes) $(value exponent)" "0 1 "
ballcal --balls 60.tsv:60um --balls negative.tsv:100um >out 2>err
is "tables of either sign are marked" "$? $(grep -c 'positive in 1 tables and negative in 1' err)" "3 1"
# Two balls at once among nine single ones, whose scatter is 0.5 %: Grubbs' statistic is within 1e-3 of its maximum,
# t of 8 degrees of freedom about 150
awk 'BEGIN { print "amplitude\tvelocity"; for (i = 0; i < 10; i++)
	printf "%.17g\t%g\n", (i == 3 ? 2 : 1 + (i % 3 - 1) * 0.005) * (1 + i / 10), 1 + i / 10 }' >two.tsv
ballcal --balls two.tsv:100um >cal.tsv 2>err
is "a pulse of two balls at once is named and marked" "$? $(grep -c "two.tsv: 1 of 10 pulses .* pulse 4 on" err)" "3 1"
rising "it is no pulse of one ball" 0 "$(value outlier_p)" 1e-9
# Six pairs among 40 balls with a scatter of 1 %: the farthest pulse is only 2.4 deviations from the mean
awk 'BEGIN { srand(7); print "amplitude\tvelocity"; for (i = 0; i < 40; i++)
	printf "%.17g\t1\n", (i % 7 == 3 ? 2 : 1) * (1 + 0.035 * (rand() - 0.5)) }' >pairs.tsv
ballcal --balls pairs.tsv:100um >cal.tsv 2>err
is "pairs of balls that hide one another are counted and marked" "$? $(grep -c 'pairs.tsv: 6 of 40 pulses .* pulse 4 on' err)" "3 1"
awk 'BEGIN { print "amplitude\tvelocity"; for (i = 0; i < 40; i++) printf "%.17g\t1\n", 1 + 0.001 * i }' >drift.tsv
ballcal --balls drift.tsv:100um >cal.tsv 2>err
is "pulses spread evenly, as by a drift, are of one ball" "$? $(value outlier_p)" "0 1"
# 200 quantiles of a lognormal law of deviation 0.4, by a lambda law; the highest is 4.4 deviations
# from the mean, and 2.8 on the scale of logarithms
awk 'BEGIN { print "amplitude\tvelocity"; for (i = 0.5; i < 200; i++) {
	z = 4.91 * ((i / 200)^0.14 - (1 - i / 200)^0.14); printf "%.17g\t1\n", exp(0.4 * z) } }' >lognormal.tsv
ballcal --balls lognormal.tsv:100um >cal.tsv 2>err
is "a scatter of 40 % that multiplies has no outliers" "$? $(wc -l <err)" "0 0"
awk 'NR == 1 { print; next } { $2 = 1; print log($1) / 0.4 * 0.25 + 1 "\t" $2 }' lognormal.tsv | awk '$1 > 0.2 || NR == 1' >normal.tsv
ballcal --balls normal.tsv:100um >cal.tsv 2>err
is "neither has one of 25 % that adds" "$? $(wc -l <err)" "0 0"
awk 'NR != 5' two.tsv >single.tsv
ballcal --balls single.tsv:100um >cal.tsv 2>err
is "the others are not marked" "$? $(wc -l <err)" "0 0"
awk 'BEGIN { print "amplitude\tvelocity"; for (i = 0; i < 5; i++) print "1\t12.7" }' >copies.tsv
awk 'NR == 1 { print; next } { print 8 * $1 "\t" $2 }' copies.tsv >copies8.tsv
ballcal --balls copies.tsv:100um >cal.tsv 2>err
is "copies of one pulse, which have no scatter, are marked" "$? $(grep -c 'all 5 pulses are equal' err)" "3 1"
ballcal --balls copies.tsv:100um --balls copies8.tsv:200um >cal.tsv 2>err
is "rounding of equal pulses does not change the exponent" "$(value exponent_p) $(grep -c 'the exponent is' err)" "1 0"
printf '# doubtful: pulses differ\n' | cat single.tsv - >self.tsv
ballcal --balls self.tsv:100um >cal.tsv 2>err
is "a table that calls itself doubtful is marked by status 3" "$? $(grep -c 'own account: pulses differ' err)" "3 1"
is "its calibration says why" "$(grep '^# doubtful' cal.tsv)" '# doubtful: pulses differ'
fails "no balls" 2 '\--balls is missing' ballcal
fails "balls without a diameter" 2 'want FILE:D' ballcal --balls 1.tsv
ln -s 1.tsv same.tsv
fails "a file by two names" 2 'the same file is given twice' ballcal --balls 1.tsv:1mm --balls same.tsv:2mm
fails "a diameter in seconds" 2 'want a diameter' ballcal --balls 1.tsv:5s
fails "noise without a duration" 2 '--noise requires --pulse-duration' ballcal --balls 1.tsv:1mm --noise 1V
fails "a smallest size without noise" 1 "no column 'amplitude_se'" ballcal --balls 1.tsv:1mm --pulse-duration 1s
fails "more false alarms than pulses" 2 'for any threshold' ballcal --balls 2.tsv:2mm --exponent 5 --noise 1V \
	--pulse-duration 1s --false-alarms 2Hz 2>err
fails "two pulses" 1 'at least 3' sh -c 'head -n 3 1.tsv >x; ballcal --balls x:1mm'
fails "no amplitude" 1 "no column 'amplitude'" ballcal --balls st:1mm
printf 'amplitude\tvelocity\n1\t1\n' >one.tsv
fails "a ball of 100 m" 2 "'100' is more than 0.1 m, want a diameter" ballcal --balls one.tsv:100
done_testing

#!/bin/sh
# debrisstat: fits, steps, classes, what is counted, refusals
. "$(dirname "$0")/tap.sh"

# table: rows "realisation step diameter(um) aspect" become a particle table.
table() {
	printf '# cmd: drawn\n'
	printf 'realisation\tstep\tparticle\tvolume\tdiameter\taspect\n'
	awk '{ d = $3 * 1e-6
		printf "%d\t%d\t1\t%.17g\t%.17g\t%g\n", $1, $2, 3.14159265358979 / 6 * d ^ 3, d, $4 }'
}

fit() {
	awk -v q="$1" '$1 == q { print $'"$2"' }' fits.tsv
}

# Quantiles of the Weibull distribution (2-17), in three realisations.
awk 'BEGIN { for (i = 0; i < 3000; i++) { p = (i + 0.5) / 3000
	print i % 3, 1 + int(i / 3) % 10, 200.698 * (-log(1 - p)) ^ (1 / 2.718), 1.2 } }' |
	table >weibull.tsv
debrisstat weibull.tsv >fits.tsv
# Quantiles instead of draws: shape and scale within 1/n or so.
near "the Weibull shape is that of the sample" "$(fit weibull_shape 2)" 2.718 0.005
near "the Weibull scale is that of the sample" "$(fit weibull_scale 2)" 200.698e-6 0.05e-6
near "the Weibull mean is 178.5 um as in the thesis" "$(fit weibull_mean 2)" 178.52e-6 0.05e-6
rising "the interval contains the shape" "$(fit weibull_shape 3)" 2.718 "$(fit weibull_shape 4)"
near "the width of the interval is 1.53 shape / sqrt(n)" \
	"$(awk '$1 == "weibull_shape" { print ($4 - $3) / 2 / $2 }' fits.tsv)" 0.0279 0.0005
near "the Kolmogorov-Smirnov distance is small" "$(fit ks_distance 2)" 0 0.001
is "realisations are counted" "$(fit realisations 2)" 3
is "particles are counted" "$(fit particles 2)" 3000
awk 'BEGIN { for (i = 0; i < 3; i++) print i, 1, 10, 1.2 }' | table | debrisstat >fits.tsv
is "a mean of equal diameters is within its interval" "$(fit mean_diameter 3) $(fit mean_diameter 4)" \
	"$(fit mean_diameter 2) $(fit mean_diameter 2)"
debrisstat --diameter 0:200um weibull.tsv >fits.tsv
rising "leaving out large particles biases the shape" 2.9 "$(fit weibull_shape 2)"
debrisstat --diameter 0:200um --truncated weibull.tsv >fits.tsv
near "a truncated fit has the right shape" "$(fit weibull_shape 2)" 2.718 0.02
near "a truncated fit has the right scale" "$(fit weibull_scale 2)" 200.698e-6 1e-6

# Quantiles of a Weibull distribution whose logarithms lie within a few SPREAD of 100 um: the shape is that of
# the sample, some 1 / SPREAD, or nan, and never a limit of the search.
# narrow N SPREAD
narrow() {
	awk -v n="$1" -v s="$2" 'BEGIN { for (i = 0; i < n; i++)
		printf "%d 1 %.17g 1\n", i, 100 * (1 + s * log(-log(1 - (i + 0.5) / n))) }' | table
}
# shape FILE SPREAD OPTION...: the shape of the file times the spread
shape() {
	file=$1
	spread=$2
	shift 2
	debrisstat "$@" "$file" >fits.tsv
	awk -v s="$spread" '$1 == "weibull_shape" { print $2 == "nan" ? "nan" : $2 * s }' fits.tsv
}
# verdicts WANT TOLERANCE "VALUE...": what each value is, relative to the one wanted
verdicts() {
	echo "$3" | awk -v want="$1" -v tolerance="$2" '{ for (i = 1; i <= NF; i++) {
		off = $i == "nan" ? 0 : $i / want - 1
		printf "%s ", $i == "nan" ? "nan" : off * off < tolerance ^ 2 ? "right" : $i
	} }'
}
for n in 3 30 1000; do
	whole=
	cut=
	narrow $n 1e-3 >wide.tsv
	want=$(shape wide.tsv 1e-3)
	want_cut=$(shape wide.tsv 1e-3 --truncated --diameter 99.95um:1mm)
	for e in 3 4 5 6 7 8 9 10 11 12 13 14 15; do
		narrow $n 1e-$e >equal.tsv
		whole="$whole $(shape equal.tsv 1e-$e)"
		cut="$cut $(shape equal.tsv 1e-$e --truncated --diameter "$(awk -v e=$e 'BEGIN { printf "%.17g", 100 - 50 * 10 ^ -e }')um:1mm")"
	done
	is "$n nearly equal diameters: the shape is that of the spread down to 1e-12, and below it nan" \
		"$(verdicts "$want" 0.001 "$whole")" \
		"right right right right right right right right right right nan nan nan "
	# Rounding of the likelihood hides the maximum of some truncated fits: these are nan.
	like "$n nearly equal diameters cut off below: the shape is that of the spread, or nan from 1e-7 on" \
		"$(verdicts "$want_cut" 0.01 "$cut")" \
		'^right right right right \(\(right\|nan\) \)\{6\}nan nan nan $'
done
narrow 400 1e-9 >equal.tsv
debrisstat equal.tsv >fits.tsv
near "nearly equal diameters have the shape of their spread" "$(fit weibull_shape 2 | awk '{ print $1 / 1e9 }')" 1 0.02
rising "the interval of nearly equal diameters contains the shape" "$(fit weibull_shape 3)" 1e9 "$(fit weibull_shape 4)"

# Counts 3 x^2 + 2 in all up to step x, over two realisations.
awk 'BEGIN { for (x = 1; x <= 6; x++) { n = x == 1 ? 5 : 3 * (2 * x - 1)
	for (i = 0; i < n; i++) print i % 2, x, 100, 1 + i % 4 } }' | table >growth.tsv
debrisstat growth.tsv >fits.tsv
near "cumulative power law: the factor is recovered" "$(fit power_factor 2)" 3 1e-6
near "cumulative power law: the exponent is recovered" "$(fit power_exponent 2)" 2 1e-7
near "cumulative power law: the offset is recovered" "$(fit power_offset 2)" 2 1e-5
debrisstat --growth step --step 2:6 growth.tsv >fits.tsv
near "power law per step: the exponent is recovered" "$(fit power_exponent 2)" 1 1e-7
near "power law per step: the factor is recovered" "$(fit power_factor 2)" 6 1e-5
near "power law per step: the offset is recovered" "$(fit power_offset 2)" -3 1e-5

debrisstat -o steps growth.tsv >steps.tsv
is "steps: the mean number of particles is right" "$(column particles steps.tsv | tr '\n' ' ')" \
	"2.5 4.5 7.5 10.5 13.5 16.5 "
is "steps: the standard deviation is taken over realisations" \
	"$(column particles_sd steps.tsv | awk '{ printf "%.6f ", $1 }')" \
	"0.707107 0.707107 0.707107 0.707107 0.707107 0.707107 "
is "steps: particles are accumulated" "$(column cumulative_particles steps.tsv | tr '\n' ' ')" \
	"5 14 29 50 77 110 "
near "steps: the mean volume is right" "$(column volume steps.tsv | head -n 1)" 1.3089969389957e-12 1e-24
near "steps: volumes are accumulated" "$(column cumulative_volume steps.tsv | tail -n 1)" 2.87979326579e-11 1e-22
debrisstat -o steps --realisations 5 growth.tsv >steps.tsv
is "realisations without particles count as zero" "$(column particles steps.tsv | head -n 1)" 1
# Five realisations and nine steps, of which two and six have particles
{
	grep -v '^#' growth.tsv
	printf '# realisation: %s\n' 0 1 2 0 3 4
	echo '# last_step: 9'
} >ends.tsv
debrisstat -o steps ends.tsv >told.tsv
debrisstat -o steps --realisations 5 growth.tsv | grep -v '^#' >steps.tsv
is "realisations and steps that comments tell of count as zero" "$(grep -v '^#' told.tsv | head -n "$(wc -l <steps.tsv)" |
	cksum) $(column step told.tsv | tail -n 1)" "$(cksum <steps.tsv) 9"
printf 'realisation\tstep\n0\t1\n0\t2\n1\t1\n2\t1\n' >summary.tsv
debrisstat -o steps --step 1:2 --summary summary.tsv growth.tsv >steps.tsv
is "the summary states which steps took place" "$(column realisations steps.tsv | tr '\n' ' ')" "3 2 "

debrisstat -o aspects --aspects 1,2,3,4 growth.tsv >aspects.tsv
is "aspects: particles are counted in their classes" "$(column count aspects.tsv | tr '\n' ' ')" "31 27 27 25 "
near "aspects: shares add up to 1" "$(column share aspects.tsv | awk '{ s += $1 } END { print s }')" 1 1e-6
debrisstat -o sizes --bin 20um weibull.tsv >sizes.tsv
is "sizes: all particles are counted" "$(column count sizes.tsv | awk '{ s += $1 } END { print s }')" 3000
near "sizes: the density integrates to 1" "$(column density sizes.tsv | awk '{ s += $1 * 20e-6 } END { print s }')" 1 1e-6
near "sizes: the fit follows the histogram" "$(awk '!/^[#l]/ { d = $4 - $5; s += (d < 0 ? -d : d) * 20e-6 }
	END { print s }' sizes.tsv)" 0 0.03

# Realisations that differ: the bootstrap sees it, the likelihood cannot.
awk 'BEGIN { for (r = 0; r < 12; r++) for (i = 0; i < 50; i++)
	print r, 1 + i % 5, (60 + 15 * r) * (-log(1 - (i + 0.5) / 50)) ^ 0.5, 1 }' | table >groups.tsv
debrisstat groups.tsv >fits.tsv
plain=$(awk '$1 == "weibull_scale" { print $4 - $3 }' fits.tsv)
debrisstat --bootstrap 200 groups.tsv >fits.tsv
cp fits.tsv again
near "bootstrap intervals over realisations are much wider" \
	"$(awk -v p="$plain" '$1 == "weibull_scale" { print ($4 - $3) / p }' fits.tsv)" 4 1.5
debrisstat --bootstrap 200 groups.tsv >fits.tsv
same "bootstrap intervals are reproducible" fits.tsv again

roughgen -n 32 -L 0.25mm -q 4um -l 30um --crown 16um -c 3 | bemcontact -F 5N -E 210GPa |
	debrisgen -Y 355MPa -u 0.3 --steps 3 -E 210GPa --summary s.tsv 2>warning >p.tsv
debrisstat -o steps --summary s.tsv p.tsv >steps.tsv
near "the volume equals that in the summary of debrisgen" \
	"$(column volume steps.tsv | awk '{ s += 1e12 * $1 } END { print s * 3 }')" \
	"$(column volume s.tsv | awk '{ s += 1e12 * $1 } END { print s }')" 1e-9

# Volumes of 1, 10 and 100 (1e-16 m3) in steps 1 to 3 of two realisations.
awk 'BEGIN { print "realisation\tstep\tvolume\tdiameter\taspect"
	for (r = 0; r < 2; r++) for (s = 1; s <= 3; s++)
		print r "\t" s "\t" 10 ^ (s - 17) "\t" 1e-5 * (s + r) "\t1" }' >decades.tsv
is "--step A:B gives the mean volume of the steps from A to B" "$(for steps in 1 2 3 1:2 2:3 1:3; do
	debrisstat --step $steps decades.tsv | awk '$1 == "volume_per_step" { printf "%.4g ", $2 / 1e-16 }'
done)" "1 10 100 5.5 55 37 "

# Two studies: volumes 1 2 3 4 and 2 4 6 8 (1e-12 m3) of one particle each.
study() {
	printf 'realisation\tstep\tvolume\tdiameter\taspect\n'
	awk -v f="$1" 'BEGIN { for (r = 0; r < 4; r++) for (i = 0; i < 3; i++)
		printf "%d\t1\t%.17g\t%.17g\t1\n", r, f * (r + 1) * 1e-12 / 3, (10 + r + i) * f * 1e-6 }'
}
study 1 >one.tsv
study 2 >two.tsv
debrisstat --compare two.tsv one.tsv >against.tsv
row() { awk -F '\t' -v q="$1" -v c="$2" '$1 == q { print $c }' against.tsv; }
near "the other study wears twice as much" "$(row volume_per_step 7)" 2 1e-12
near "the other study has particles twice as large" "$(row mean_diameter 7)" 2 1e-12
near "the difference is as large as the first value" "$(row volume_per_step 4)" 2.5e-12 1e-22
# standard errors sqrt(5 / 3 / 4) / 2.5 of both logarithms; Welch: 6 degrees, t 1.94318 at 95 %
near "the lower limit is that of Student" "$(row volume_per_step 8)" \
	"$(awk 'BEGIN { e = sqrt(5 / 12) / 2.5; print 2 * exp(-1.94318 * e * sqrt(2)) }')" 1e-4
# (1.644854 + 1.281552)^2 2 (5 / 3) / 2.5^2 / ln(2)^2 = 9.5
is "the number of realisations for a significant difference is right" "$(row volume_per_step 10)" 10
near "the ratio of lives is the inverse of that of the volumes" "$(awk "BEGIN { print $(row life 8) * $(row volume_per_step 9) }")" 1 1e-6
is "every quantity has its unit" "$(cut -f 11 against.tsv | grep -v '^#' | tr '\n' ' ')" "unit m3 m 1 m m 1 "
# Life: 1e-6 m of 2e-8 m2 at 2.5e-12 m3 in 3 mm, against 1e-8 m2 at 5e-12 m3 in 1 mm.
{ printf '# nominal_area: 2e-8 m2\n# step_distance: 3 mm\n'; cat one.tsv; } >slid1.tsv
{ printf '# nominal_area: 1e-8 m2\n# step_distance: 1 mm\n'; cat two.tsv; } >slid2.tsv
debrisstat --compare slid2.tsv slid1.tsv >against.tsv
near "life is the distance in which 1 um is worn off" "$(row life 2 | awk '{ print $1 * 1e6 }')" 24 1e-9
near "the life in the other study is right" "$(row life 3 | awk '{ print $1 * 1e6 }')" 2 1e-9
near "the difference of the lives is right" "$(row life 4 | awk '{ print $1 * 1e6 }')" -22 1e-9
rising "the ratio has an interval" "$(row life 5)" "$(row life 4)" "$(row life 6)"
near "the ratio of lives counts areas and distances" "$(row life 7)" 0.083333333 1e-8
is "life is a distance" "$(row life 11)" m
is "the number of realisations that would show a difference in life is printed" "$(row life 10)" "$(awk 'BEGIN {
	print int(2.926407 ^ 2 * 2 * (5 / 3) / 2.5 ^ 2 / log(12) ^ 2) + 1 }' | awk '{ print $1 < 2 ? 2 : $1 }')"
debrisstat --compare slid2.tsv --depth 2um slid1.tsv >against.tsv
near "life is proportional to the depth" "$(row life 2 | awk '{ print $1 * 1e6 }')" 48 1e-9
sed 1d slid1.tsv >unknown.tsv
debrisstat --compare slid2.tsv unknown.tsv >against.tsv
is "without an area there is no life" "$(row life 2) $(row life 4)" "nan nan"
printf 'realisation\tstep\tvolume\tdiameter\taspect\n0\t1\t1e-15\t1e-5\t1\n' >first.tsv
fails "steps after the last of the table" 1 'first.tsv has no step after 1: .* specify --summary' \
	debrisstat --step 1:2 first.tsv
printf 'realisation\tstep\n0\t1\n0\t2\n' >both.tsv
is "a step that shed nothing counts if the summary has it" \
	"$(debrisstat --step 1:2 --summary both.tsv first.tsv | awk '$1 == "volume_per_step" { print $2 }')" 5e-16
fails "steps after the last of the summary" 1 'first.tsv has no step after 2$' \
	debrisstat --step 3 --summary both.tsv first.tsv
printf 'realisation\tstep\tdiameter\tvolume\taspect\n0\t1\t20\t8e-15\t1\n' >bare.tsv
fails "diameters in micrometres without a unit" 1 "bare.tsv: line 2: diameter is 20 m, want metres or a '# units:' line" debrisstat bare.tsv
printf 'realisation\tstep\tdiameter\tvolume\taspect\n0\t1\t20e-6\t8000\t1\n' >bare.tsv
fails "volumes in cubic micrometres without a unit" 1 "bare.tsv: line 2: volume is 8000 m3, want m3 or a '# units:' line" debrisstat bare.tsv
areas() { # of the second surface, m2
	printf '# nominal_area: 1e-8 m2\n# step_distance: 1e-4 m\nrealisation\tstep\tdiameter\tvolume\taspect\n'
	printf '0\t1\t2e-5\t8e-15\t1\n# cmd: b\n# nominal_area: %s m2\n1\t1\t3e-5\t9e-15\t1\n' "$1"
}
areas 1e-8 >alike.tsv
areas 2e-8 >mixed.tsv
ok "studies of one area are compared" sh -c 'debrisstat --compare alike.tsv alike.tsv >out'
fails "surfaces of two areas have no common life" 1 "mixed.tsv: line 7: surfaces of 1e-08 and of 2e-08 m2 in one study" \
	debrisstat --compare mixed.tsv alike.tsv
ok "without --compare the area does not matter" sh -c 'debrisstat mixed.tsv >out'
fails "a truncation without limits" 2 '\--truncated requires --diameter' debrisstat --truncated first.tsv
for c in "bin 1um:fits" "aspects 1,2:sizes" "growth step:steps" "confidence 0.9:aspects" "bootstrap 9:sizes" \
	"truncated --diameter 1um:1mm:aspects"; do
	# shellcheck disable=SC2086 # words
	fails "--${c%% *} of another output" 2 "--${c%% *} has no effect with --output ${c##*:}" \
		debrisstat --output ${c##*:} --${c%:*} first.tsv
done
fails "a seed where nothing is drawn" 2 '\--seed requires --bootstrap or --compare' debrisstat --seed 2 first.tsv
fails "a depth without a comparison" 2 'depth requires --compare' debrisstat --depth 1um one.tsv
debrisstat --compare one.tsv one.tsv >against.tsv
is "a study does not differ from itself" "$(row volume_per_step 7) $(row volume_per_step 10)" "1 inf"
fails "studies are compared by their fits" 2 '--compare excludes --output' debrisstat --compare two.tsv --output sizes one.tsv
fails "one realisation cannot be compared" 1 'at least two realisations of each study' sh -c \
	'awk "!/^[123]/" two.tsv >lone.tsv; debrisstat --compare lone.tsv one.tsv'

# Two ensembles in one table must not be added up realisation by realisation.
fails "the same realisations twice" 1 'realisation 0 stands in two parts' sh -c 'cat growth.tsv growth.tsv | debrisstat'
grep -v '^#' growth.tsv >bare.tsv
fails "two equal tables without comments joined" 1 'realisation 0 stands in two parts' sh -c 'cat bare.tsv bare.tsv | debrisstat'
awk -F '\t' -v OFS='\t' 'NR > 1 { $1 += 2 } 1' bare.tsv | cat bare.tsv - >both.tsv
is "other realisations form a larger ensemble" "$(debrisstat both.tsv | sed -n 's/^realisations.\([0-9]*\).*/\1/p')" 4

head -n 2 growth.tsv | debrisstat >fits.tsv
is "a table without rows has no fit" "$(fit weibull_shape 2) $(fit particles 2)" "nan 0"
fails "an empty stream" 1 "empty, want table" debrisstat
printf 'realisation\tstep\tdiameter\tvolume\n' >t
fails "a missing column" 1 "aspect" debrisstat t
printf 'realisation\tstep\tdiameter\tvolume\taspect\n0\t1\tnan\t1\t1\n' >t
fails "a missing diameter" 1 "line 2: diameter is nan" debrisstat t
printf 'realisation\tstep\tdiameter\tvolume\taspect\n0\t1.5\t1\t1\t1\n' >t
fails "a step that is not an integer" 1 "line 2: step is 1.5" debrisstat t
fails "diameters turned round" 2 "LO below HI" debrisstat --diameter 2um:1um t
fails "more realisations than said" 1 "has 2" debrisstat --realisations 1 growth.tsv
awk '/^[#r]/ || $1 == 0' growth.tsv >s1.tsv
fails "a bootstrap of one realisation" 1 "two realisations" debrisstat --bootstrap 10 s1.tsv
printf 'realisation\tstep\tvolume\tdiameter\taspect\n4000000000\t2000000\t1\t1\t1\n' >late.tsv
fails 'a step beyond those of debrisgen' 1 'line 2: step is 2000000, want a whole number, 1 to 1e+06' \
	debrisstat late.tsv
# Diameters of whole micrometres: 70 um is not below seven classes of 10 um, though it is below
# seven times the number 1e-5
awk 'BEGIN { print "realisation\tstep\tvolume\tdiameter\taspect"
	for (i = 1; i < 400; i++) printf "0\t1\t1e-15\t%de-6\t1\n", i }' >whole.tsv
debrisstat -o sizes --bin 10um whole.tsv >whole.out
is "a diameter at the limit of a class is in the upper one" "$(column count whole.out | sort -n | uniq -c | awk '{ printf "%d of %d, ", $1, $2 }')" \
	'1 of 9, 39 of 10, '
is "limits of classes are decimal numbers" "$(column high whole.out | sed -n '3p;6p;7p' | tr '\n' ' ')" '3e-05 6e-05 7e-05 '
done_testing

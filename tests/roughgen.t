#!/bin/sh
# roughgen: streams, roughness, provenance, measured surfaces, refusals
. "$(dirname "$0")/tap.sh"

# value COLUMN FILE: first value of a table column
value() { column "$1" "$2" | head -1; }

# Realisations are functions of their number: one process, many, any thread count.
roughgen -n 60x45 -q 0.5um:2um -c 8 -j 1 >one
for k in 0 1 2 3 4 5 6 7; do
	roughgen -n 60x45 -q 0.5um:2um -f $k -c 1
done | records --join >many
same "one process and eight give the same realisations" one many
roughgen -n 60x45 -q 0.5um:2um -c 8 -j 2 >two
same "one thread and two give the same surface" one two
roughgen -n 60x45 --skewness -1 --kurtosis 5 -c 3 -j 1 >one
(roughgen -n 60x45 --skewness -1 --kurtosis 5 -f 0 -c 2 -j 3 && roughgen -n 60x45 --skewness -1 --kurtosis 5 -f 2) | records --join >two
same "one thread and two give the same non-Gaussian surface" one two

is "neighbouring large seeds give different surfaces" \
	"$(for s in 9007199254740992 9007199254740993; do roughgen -n 8 -s $s | tail -c 512 | cksum; done | sort -u | wc -l)" 2
is "a large seed may have a sign" "$(roughgen -n 8 -s +9007199254740993 | tail -c 512 | cksum)" \
	"$(roughgen -n 8 -s 9007199254740993 | tail -c 512 | cksum)"
fails "a large seed without all its digits" 2 'with all its digits' roughgen -s 1e17

# The header rebuilds the record.
roughgen -n 32 -q 1um:3um --pair 0.5um --crown auto -s 7 -c 3 >three
records --pick 2 -o nrrd three >second
cmd=$(sed -n 's/^cmd:=//p' second | head -1)
sh -c "$cmd" >again
records --pick 2 -o nrrd three | tail -c 8192 >a
tail -c 8192 again >b
same "the recorded command reproduces one record of an ensemble" a b
is "the record has the documented keys" "$(sed -n '/^#/q; s/:=.*//p' again | tr '\n' ' ')" \
	"fields realisation seed sq crown cmd stream "

# Roughness is met exactly, without the crown.
roughgen -n 64 -q 3um --measure >t
near "--sq sets Sq exactly" "$(value sq t)" 3e-6 1e-20
roughgen -n 64 --sa 3um --measure >t
near "--sa sets Sa exactly" "$(value sa t)" 3e-6 1e-20
roughgen -n 64 -L 1mm -l 200um --slope 0.1 --measure >t
# Wavelengths of 60 points and more: seven-point differences are exact to 1e-3 or so;
# the area is periodic but the differences are not taken across its rim.
near "--slope sets the rms slope" "$(value sdq_iso7 t)" 0.1 0.004
roughgen -n 64 -q 1um -c 50 --measure >t
is "each realisation has a row" "$(column sq t | wc -l)" 50
roughgen -n 64 -q 78um:82um -c 50 --measure >t
column sq t | sort -g >sorted
ok "--sq A:B draws Sq from the whole range" awk '
	NR == 1 { low = $1 } { high = $1 }
	END { exit !(low >= 78e-6 && low < 78.5e-6 && high <= 82e-6 && high > 81.5e-6) }' sorted
# Greenwood and Tripp: variances add; the two samples correlate by about a tenth.
roughgen -n 128 -l 40um -q 0.8um --pair 1.6um -c 20 --measure >t
near "--pair adds the variances" "$(column sq t | awk '{ s += $1 * $1 } END { print s / NR }')" \
	3.2e-12 0.1e-12
roughgen -n 64 -q 1um >a
roughgen -n 64 -q 0 --pair 1um >b
ok "--pair adds an independent surface" sh -c '! cmp -s a b'
roughgen -n 64 -q 1um --crown auto >a
is "--crown auto is 4 Sq" "$(sed -n 's/^crown:=//p' a | awk '{ printf "%.12g", $1 }')" 4e-06
roughgen -n 3 -q 0 -L 3mm --crown 8um >a
# Centre 0; edge centres (1 mm)^2 / 4.5 mm^2, corner centres 2 / 4.5.
is "--crown works on a flat surface" "$(records -o text a | awk '!/^#/ && NF { printf "%.5g %.5g %.5g ", $1, $2, $3 }')" \
	"-3.5556e-06 -1.7778e-06 -3.5556e-06 -1.7778e-06 0 -1.7778e-06 -3.5556e-06 -1.7778e-06 -3.5556e-06 "

roughgen -n 3 -q 0 -L 3mm --crown 8um --measure >t
near "--measure includes the crown" "$(value sq t)" 1.18519e-6 1e-11
# A crown stays out of what is done to the roughness.
roughgen -n 64 -q 1um --crown 4um | roughgen -q 3um --crown 2um - >a
is "a crown in the input is kept with its keys" \
	"$(sed -n 's/^sq:=//p; s/^crown:=//p' a | awk '{ printf "%.12g ", $1 }')" "3e-06 6e-06 "
roughgen -n 64 -q 3um --crown 6um >b
records -o text a >a.txt
records -o text b >b.txt
near "a crown in the input is kept in the heights" "$(paste a.txt b.txt | awk '!/^#/ { for (i = 1; i <= NF / 2; i++) {
	d = $i - $(i + NF / 2); if (d < 0) d = -d; if (d > w) w = d; n++ } } END { print (n ? w + 0 : "no rows") }')" 0 1e-14

# Heights of given moments.
roughgen -n 128 -l 50um --skewness -1.2 --kurtosis 4.3 --measure >t
near "--skewness sets Ssk" "$(value ssk t)" -1.2 1e-6
near "--kurtosis sets Sku" "$(value sku t)" 4.3 1e-6
roughgen -n 128 -l 50um --skewness -1.2 --kurtosis 4.3 >a
ok "the error of the spectrum is stated and small" awk -F = '
	/^spectrum_error/ { e = $2 } END { exit !(e > 0 && e < 0.05) }' a
roughgen -n 64 --skewness 1 --measure >t
near "the default kurtosis is 3 + 1.5 S^2" "$(value sku t)" 4.5 1e-6

# Parameters against their definitions, written out.
sum_up() { # NAME FILE
	perl "$top/tests/areal.pl" 48 40 2e-6 1.5e-6 <heights >want
	awk '/^[#r]/ { next } { for (i = 2; i <= 14; i++) print $i; print $17; print $18 }' "$2" |
		paste - want >both
	# Sdr, the excess over 1, loses three digits; rounding does not.
	near "$1: fifteen parameters agree with an independent computation" "$(awk '
		{ d = $1 / $2 - 1; if (d < 0) d = -d; if (d > w) w = d; n += NF == 2 }
		END { if (n == 15) print w; else print "only " n " values" }' both)" 0 1e-10
}
roughgen -n 48x40 -L 96umx60um -q 1um -l 8umx5um --skewness 0.8 >rough
roughgen --measure rough >t
tail -c 15360 rough >heights
sum_up "a rough surface" t
# Levelled, it is as it was before it was tilted.
roughgen --level rough >level
perl -e 'read STDIN, my $b, 15360; my $i = 0;
	print pack "d<*", map { $_ + 3e-7 * ($i % 48) - 5e-7 * int($i++ / 48) } unpack "d<*", $b' \
	<heights >tilted
tail -c 15360 level >heights
roughgen --level --measure --raw 48x40 --pixel 2umx1.5um tilted >t
sum_up "tilted and levelled" t

# Preparing: crop, level, resample, raw, streams with several records.
roughgen -n 40x30 -c 2 >s
roughgen --crop 5:6:20:10 s >c
is "--crop sets size and keeps spacing" "$(records c | awk -F '\t' '$1 == 1 { print $5, $6, $8 }')" \
	"20 10 2.5e-05"
is "--crop keeps the samples" "$(records -o text --pick 1 c | sed -n 2p | cut -f 1-3)" \
	"$(records -o text --pick 1 s | sed -n 8p | cut -f 6-8)"
is "every record of a stream is processed" "$(records -o count c)" "2"
roughgen --resample 20x15 s >c
is "--resample sets size and spacing" "$(records c | awk -F '\t' '$1 == 1 { print $5, $6, $8, $9 }')" \
	"20 15 5e-05 5e-05"
tail -c 9600 s >raw.f64
roughgen --raw 40x30 --pixel 25um raw.f64 | tail -c 9600 >c
same "--raw does not change the samples" raw.f64 c
cat s | roughgen - >c
roughgen s >d
is "- names standard input" "$(tail -c 9600 c | cksum)" "$(tail -c 9600 d | cksum)"
roughgen --crop 5:6:20:10 --level --resample 15 --crown 1um s >c
records --pick 2 -o nrrd c >second
sh -c "$(sed -n 's/^cmd:=//p' second | head -1)" >again
same "the recorded command reproduces a processed record through the pipe" second again
records --pick 1 -o gsf s >s.gsf
roughgen --measure s.gsf >t
roughgen -n 40x30 --measure >u
near "a GSF file is measured in float32" "$(value sq t)" "$(value sq u)" 1e-12
roughgen -q 2um s | roughgen --measure - >t
near "a measured surface is scaled on request" "$(value sq t)" 2e-6 1e-20
roughgen -n 64 --skewness 5 | roughgen --measure >t
near "--measure alone reads standard input" "$(value ssk t)" 5 1e-6
roughgen -n 64 --skewness 5 | roughgen -q 2um --level --measure >u
near "--measure with processing reads standard input" "$(value sq u)" 2e-6 1e-20
is "the header of the result records the processing" "$(sed -n 's/^# cmd: .*| //p' t)" "roughgen --measure -"

# ISO 25178: S-filter, form, L-filter, core, spectrum.
roughgen -n 96 -L 0.96mm -q 1um -l 40um >iso.nrrd
roughgen --s-filter 50um --ends periodic --measure iso.nrrd >s.tsv
roughgen --l-filter 50um --ends periodic --measure iso.nrrd >l.tsv
roughgen --measure iso.nrrd >whole.tsv
rising "the filters split the slopes of a surface" "$(value sdq l.tsv)" "$(value sdq s.tsv)" "$(value sdq whole.tsv)"
roughgen --s-filter 50um --ends periodic iso.nrrd | records -o text | grep -v '^#' >a
roughgen --l-filter 50um --ends periodic iso.nrrd | records -o text | grep -v '^#' >b
records -o text iso.nrrd | grep -v '^#' >c
near "the filtered parts add up to the whole" "$(paste a b c | awk 'NF { for (i = 1; i <= 96; i++) { d = $i + $(i + 96) - $(i + 192)
	m = d > m ? d : -d > m ? -d : m } } END { print m * 1e12 }')" 0 0.01
roughgen --s-filter 100um --ends crop --stats st iso.nrrd | records >size
is "--ends crop removes half of the nesting index on all sides" \
	"$(column nx size) $(column ny size) $(value samples_cropped st)" "86 86 1820"
for k in 0 1 2; do
	roughgen --s-filter 0.2mm --ends $k --measure iso.nrrd >order.tsv
	value sq order.tsv
done >orders
is "the regression orders differ at the edge" "$(sort -u orders | wc -l)" 3
roughgen -n 40 -q 0 --crown 1um | roughgen --crop 2:1:36:38 --form paraboloid --measure >t
near "a paraboloid is removed as form" "$(value sz t | awk '{ print $1 * 1e6 }')" 0 1e-9
roughgen --form poly6 --measure iso.nrrd >p6.tsv
roughgen --form plane --measure iso.nrrd >p1.tsv
rising "a form with more terms leaves smaller residuals" "$(value sq p6.tsv)" "$(value sq p1.tsv)" "$(value sq whole.tsv)"
roughgen -n 256 -L 1mm -q 1um -l 5um --measure >core.tsv
# normal heights, some 10^4 independent ones: 2.574 Sq and 9.9 %
near "Sk of Gaussian heights is 2.574 Sq" "$(value sk core.tsv | awk '{ print $1 * 1e6 }')" 2.574 0.06
near "Smr1 of Gaussian heights is 9.9 %" "$(value smr1 core.tsv)" 0.099 0.01
roughgen -n 64 -q 1um --spectrum --taper none >psd.tsv
near "the spectrum integrates to Sq^2" "$(awk -F '\t' '/^[0-9]/ { s += $4 * $5 / 1e-6 } END { printf "%.9f", s * 1e12 }' psd.tsv)" 1 1e-6
roughgen -n 64 -q 1um | roughgen --spectrum >hann.tsv
near "a window preserves the mean of the spectrum" "$(awk -F '\t' '/^[0-9]/ { s += $4 * $5 / 1e-6 } END { printf "%.9f", s * 1e12 }' hann.tsv)" 1 0.4
fails "a form of too few samples" 1 'too few for --form poly2' sh -c 'roughgen -n 2 -q 0 | roughgen --form poly2 -'
fails "a crop of everything" 1 'removes all of' roughgen --l-filter 0.96mm --ends crop iso.nrrd
fails "measure and spectrum" 2 'exclude one another' roughgen --measure --spectrum iso.nrrd
fails "a taper without a spectrum" 2 'requires --spectrum' roughgen --taper none iso.nrrd
fails "a filter without a file" 2 '\--s-filter: applies to a measured' roughgen --s-filter 1um
fails "an S-filter above the L-filter" 2 'is not below --l-filter' roughgen --s-filter 64um --l-filter 32um iso.nrrd
fails "an L-filter that leaves nothing" 1 'shorter than a pixel: no height is left' roughgen --l-filter 1nm iso.nrrd
# Heights that alternate: half of the amplitude should pass an index of two samples; by the
# weights 1 and exp(-pi^2 / (4 ln 2)) of a sample and its neighbours 0.89 does.
perl -e 'print pack("d<", $_ % 2 ? 1e-6 : -1e-6) for 1 .. 64' >zigzag.f64
passed() { roughgen --raw 64x1 --pixel 1um --ends periodic --s-filter "$1" --measure zigzag.f64 >zigzag.tsv 2>err; }
passed 2um
near "a filter of two samples passes more than its index states" "$(value sq zigzag.tsv | awk '{ print $1 * 1e6 }')" \
	"$(awk 'BEGIN { b = exp(-atan2(0, -1) ^ 2 / 4 / log(2)); print (1 - 2 * b) / (1 + 2 * b) }')" 1e-5
is "a warning states it" "$(cat err)" 'roughgen: --s-filter 2e-06 m is less than five samples: of waves of two samples 39 % more pass than it states'
passed 5um
is "a filter of five samples gives none" "$(cat err)" ""
passed 0.1um
is "a filter far below a sample does nothing, as stated" "$(cat err)" 'roughgen: --s-filter 1e-07 m is shorter than a pixel and does nothing'
roughgen --l-filter 2mm iso.nrrd 2>err >long.nrrd
is "a filter longer than the surface gives a warning" "$(grep -c 'longer than the surface' err)" 1

# Refusals.
fails "no heights of kurtosis below skewness^2 + 1" 2 'must exceed' \
	roughgen --skewness 1 --kurtosis 1.9
fails "kurtosis out of reach of few points" 1 'out of reach' \
	roughgen -n 4 -L 1mm -l 0.1mm --skewness 0 --kurtosis 60
fails "correlation length above the side" 1 'longer than a side' roughgen -l 2mm
fails "one point cannot be rough" 2 'single point' roughgen --points 1
is "a single point is a valid flat surface" "$(roughgen --points 1 --sq 0 | records | awk '/^1/ { print $5 * $6 }')" 1
if command -v python3 >/dev/null; then
	python3 -c 'import pty, sys; sys.exit(pty.spawn(["timeout", "5", "roughgen", "--measure"]) >> 8)' >tty </dev/null
	is "--measure does not wait for a terminal" "$? $(grep -c 'nothing to measure' tty)" "2 1"
else
	skip "--measure does not wait for a terminal" "no python3"
fi
fails "a range that runs backwards" 2 'is descending' roughgen -q 2um:1um
fails "a bare prefix" 2 'q' roughgen -q 2u
fails "Sq and Sa" 2 'exclude' roughgen -q 1um --sa 1um
fails "roll-off without Hurst" 2 '--rolloff requires --hurst' roughgen --rolloff 1um
fails "level without file" 2 '--level: applies to a measured' roughgen --level
fails "points with file" 2 '--points: is for generated' roughgen -n 4 s
fails "a spectrum with file" 2 '--corr: is for generated' roughgen -l 1um s
fails "a crop outside" 1 'record 1: --crop 30:0:11:5 is not within 40 x 30' \
	roughgen --crop 30:0:11:5 s
fails "raw without pixel" 2 'go together' roughgen --raw 3x3 s
fails "layers of raw heights" 2 'raw 3x3x1: want NXxNY$' roughgen --raw 3x3x1 --pixel 1um s
fails "a missing file" 1 'nowhere: No such file' roughgen nowhere
fails "nothing to measure" 1 'standard input: empty, want' roughgen --measure
fails "an empty file" 1 '/dev/null: empty, want' roughgen /dev/null
printf '\0\0\0\0\0\0\370\177\0\0\0\0\0\0\0\0' >nan.f64
fails "a missing sample" 1 'record 1: height is .*nan' roughgen --raw 2x1 --pixel 1um nan.f64
is "nothing is written before a refusal" "$(wc -c <out)" 0
printf '\0\0\0\0\0\0\370\177\0\0\0\0\0\0\360\177' >inf.f64
fails "an infinite sample is not filled" 1 'inf' roughgen --fill --raw 2x1 --pixel 1um inf.f64
printf '\0\0\0\0\0\0\370\177' >all.f64
fails "all samples missing" 1 'every height is missing' roughgen --fill --raw 1x1 --pixel 1um all.f64
fails "a truncated file" 1 'want 24 bytes, got 16' roughgen --raw 3x1 --pixel 1um nan.f64
fails "a flat surface cannot be scaled" 1 'flat' sh -c \
	'roughgen -n 4 -q 0 | roughgen -q 1um -'

# Counters say what was done and what was left out.
roughgen -n 64 --hurst 0.8 --rolloff 0.25mm --longest 0.25mm --cutoff 0.1mm -S st >/dev/null
near "waves drawn and skipped add up to all waves" "$(awk '{ print $1 + $2 }' <<-EOF
	$(value waves st) $(value waves_skipped st)
	EOF
)" 4095 0
roughgen -n 64 -q 0 -S st >/dev/null
is "a flat surface takes no transform" "$(value transforms st)" 0
roughgen -n 64 -q 1um -S st >/dev/null
is "a rough surface takes one transform" "$(value transforms st)" 1
# The longest wave of a periodic side has a 1/e length of 0.19 of it.
roughgen -n 16x32 -L 1mmx2mm -l 0.19mmx0.39mm >/dev/null 2>err
is "correlation lengths up to a fifth of the sides are silent" "$(cat err)" ''
roughgen -n 16x32 -L 1mmx2mm -l 0.19mmx0.5mm >/dev/null 2>err
is "longer ones are not reached, which is said" "$(grep -c -e '--corr 0.0005m is above a fifth of the side of 0.002m' err)" 1
# Keys of a contact that are not those of processed heights.
roughgen -n 32 -L 0.1mm -q 0.5um -l 8um | bemcontact --boundary periodic --pressure 20MPa -E 210GPa >periodic.nrrd 2>err
keys() { strings -n 3 "$1" | sed -n 's/^\([a-z_]*\):=.*/\1/p' | grep -xE 'estar|boundary|load|area|approach|converged|edge_load' | tr '\n' ' '; }
roughgen --resample 16 periodic.nrrd >coarse.nrrd
is "processed heights keep boundary and modulus, but no results of a contact" "$(keys coarse.nrrd)" "estar boundary "
roughgen --crop 4:4:16:16 periodic.nrrd >piece.nrrd
is "a piece of a periodic surface is not periodic" "$(keys piece.nrrd)" "estar "
roughgen --s-filter 10um --ends crop periodic.nrrd >inner.nrrd
is "nor what the ends of a filter leave of it" "$(keys inner.nrrd)" "estar "
done_testing

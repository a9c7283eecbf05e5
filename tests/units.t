#!/bin/sh
# Every table tells the units of its columns, one for each; records --pretty shows them
. "$(dirname "$0")/tap.sh"

# told FILE: a table has as many units as columns
told() {
	is "$1 states its units" "$(awk -F '\t' '/^# units: / { sub("^# units: ", ""); n = split($0, unit, " "); next }
		!/^#/ { print n == NF ? "all" : n " of " NF; exit }' "$1")" all
}

roughgen --points 32 --length 25um --sq 0.8um --corr 5um --count 3 >surfaces.nrrd
roughgen --measure surfaces.nrrd >areal.tsv
bemcontact --pressure 21MPa --young 210GPa surfaces.nrrd >contact.nrrd
debrisgen --yield 355MPa --friction 0.3 --steps 3 --young 210GPa --summary summary.tsv contact.nrrd >particles.tsv 2>err
for o in fits steps sizes aspects; do
	debrisstat --output $o particles.tsv >$o.tsv
done
records surfaces.nrrd >list.tsv
records --output table --pick 1 contact.nrrd >points.tsv
bpfilter --band 70:130 --order 20 --rate 1kHz --taps >taps.tsv
rwl --new --wear summary.tsv --speed 1mm/s --rates rates.tsv >life.tsv 2>err
rwl --new --wear summary.tsv --speed 1mm/s --samples --count 3 >samples.tsv 2>err
printf '# units: h L/min\nt\tleakage\n0\t1.5\n100\t1.6\n200\t1.7\n300\t1.8\n400\t1.9\n' >flow.tsv
rwl --grey --eol 1000h --levels 0.1,0.9 flow.tsv >scores.tsv 2>err
aopf --threshold 2.8 flow.tsv >prognosis.tsv 2>err
printf 'diameter\n1e-4\n' | sensorsim --duration 5s --noise 5mV --truth truth.tsv >signal.au
duet --sections sections.tsv signal.au >found.tsv 2>err
roughgen --spectrum surfaces.nrrd >spectrum.tsv
bemcontact --pressure 21MPa --young 210GPa --table contacts.tsv --patches patches.tsv surfaces.nrrd >contact.nrrd
roughgen --points 32 --length 0.25mm --sq 1um --corr 10um --crown auto --count 130 |
	bemcontact --pressure 50MPa --young 210GPa | debrisfit --yield 250MPa:500MPa --friction 0:0.5 >surrogate.tsv
bpfilter --band 70:130 --order 20 --rate 1kHz --response >response.tsv
layout --coils 0,25cm --snr 40dB --arrivals 100 >layouts.tsv
delaynet --columns 40 --layers 6 --count 200 --batch 20 --epochs 3 >small.net
delaynet --task score --columns 40 --count 50 small.net >scored.tsv
delaynet --task data --columns 40 --count 5 --truth delays.tsv >examples.au
delaynet --task apply --network small.net examples.au >applied.tsv
printf 'unit\tt\ty\nA\t0\t1\nA\t1\t2\nA\t2\t2\nA\t3\t3\nA\t4\t3\n' >fleet.tsv
aopf --unit unit --threshold 9 --mission 3 --cost-ratio 2 --alarm 2 --weights fleet.tsv >outlook.tsv 2>err
aopf fleet.tsv >filtered.tsv
awk 'BEGIN { print "time1\tdiameter\tmaterial"; for (t = 0; t < 60; t++) print t "\t1e-4\tsteel" }' >shed.tsv
wear-volume --period 10s shed.tsv >volume.tsv
debriscount --classes 50um,80um --period 10s --flow 10L/min --by material shed.tsv >classes.tsv 2>err
debriscount --output codes --volume 1mL shed.tsv >codes.tsv 2>err
debriscount --output trend --period 10s --classes 50um shed.tsv >trend.tsv 2>err
abrade --gap 9um --hardness 2GPa,6GPa --friction 0.1 --summary worn.tsv shed.tsv >scratches.tsv
awk 'BEGIN { print "amplitude\tvelocity"; for (i = 0; i < 9; i++) print 1 + i / 100 "\t2" }' >balls.tsv
ballcal --balls balls.tsv:100um --noise 1mV --pulse-duration 1ms >sensor.tsv 2>err
sigconvert --output channels signal.au >channels.tsv
sigconvert --output text signal.au >samples.tsv
printf 'Time [h];Flow [L/min]\n0;1,5\n2;1,6\n' | sigconvert --output table >logged.tsv
debrisstat --compare particles.tsv particles.tsv >compared.tsv 2>err
for f in spectrum contacts patches surrogate response layouts scored delays applied outlook filtered volume \
	classes codes trend worn scratches sensor channels samples logged compared; do
	told $f.tsv
done
# Programs that write a table write one above.
tables='roughgen bemcontact debrisgen debrisfit debrisstat sensorsim bpfilter duet delaynet aopf rwl records layout abrade'
tables="$tables debriscount ballcal sigconvert wear-volume"
sed -n 's/^PROGRAMS = //p' "$top/Makefile" | tr ' ' '\n' | while read -r p; do
	case " $tables surfimport " in
	*" $p "*) ;;
	*) echo "$p" ;;
	esac
done >unknown
is "no program is left out" "$(cat unknown)" ""
for f in areal particles summary steps fits sizes aspects list points taps rates life samples scores truth sections found; do
	told $f.tsv
done

# 40e-6 is 3.9999999999999996e-05 as a product, not as a quotient.
printf '# units: um\ndiameter\n40\n50.3\n' >um.tsv
is "cells with a unit are the numbers nearest to those that are meant" \
	"$(abrade --gap 1um --friction 0.1 --hardness 1GPa um.tsv 2>/dev/null | awk -F '\t' '/^#/ { next }
		!c { for (i = 1; i <= NF; i++) if ($i == "diameter") c = i; next } { print $c }' | tr '\n' ' ')" \
	"4e-05 5.03e-05 "
is "a long surface is doubted where its length has no unit" "$(for l in 0.2 200mm 20cm .2m; do
	roughgen --points 8 --length $l --sq 1um --corr 50mm 2>&1 >/dev/null | grep -c 'without a unit'
done | tr '\n' ' ')" "1 0 0 0 "

# What people see: four digits, units, comments but no commands.
records --pretty life.tsv >shown
is "--pretty shows units in the header" "$(grep -c 't \[s\] *mean \[s\] *q05 \[s\].* p_no_failure$' shown)" 1
is "--pretty shows four digits" "$(awk '$1 ~ /^[0-9]/ { print $3 }' shown)" \
	"$(awk -F '\t' '/^[0-9]/ { printf "%.4g", $3 }' life.tsv)"
is "--pretty shows assumptions but not the command" "$(grep -c '^assumed: ' shown) $(grep -c cmd shown)" "1 0"
is "--pretty aligns columns" "$(records --pretty summary.tsv | awk '!/:/ { print length }' | sort -u | wc -l)" 1
is "--pretty keeps text" "$(records --pretty fits.tsv | awk '$1 == "weibull_scale" { print $NF }')" m
fails "a field is no table" 1 'contact.nrrd: this is a field' records --pretty contact.nrrd
done_testing

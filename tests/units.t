#!/bin/sh
# Every table tells the units of its columns, one for each; records --pretty shows them
. "$(dirname "$0")/tap.sh"

# told FILE: the number of units is that of the columns
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
for f in areal particles summary steps fits sizes aspects list points taps rates life samples scores truth sections found; do
	told $f.tsv
done

# What people see: four digits, units, comments but no commands.
records --pretty life.tsv >shown
is "--pretty shows units in the header" "$(grep -c 't \[s\] *mean \[s\] *q05 \[s\].* p_no_failure$' shown)" 1
is "--pretty shows four digits" "$(awk 'END { print $3 }' shown)" \
	"$(awk -F '\t' '/^[0-9]/ { printf "%.4g", $3 }' life.tsv)"
is "--pretty shows assumptions but not the command" "$(grep -c '^assumed: ' shown) $(grep -c cmd shown)" "1 0"
is "--pretty aligns columns" "$(records --pretty summary.tsv | awk '!/:/ { print length }' | sort -u | wc -l)" 1
is "--pretty keeps text" "$(records --pretty fits.tsv | awk '$1 == "weibull_scale" { print $NF }')" m
fails "a field is no table" 1 'contact.nrrd: this is a field' records --pretty contact.nrrd
done_testing

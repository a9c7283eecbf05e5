#!/bin/sh
# bemcontact at the edge: every scene is accurate, its error stated, or refused in a line
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

pi=3.141592653589793

# heights NX NY 'EXPRESSION of $x $y': raw samples in h.f64; rand() is from a fixed seed
heights() {
	perl -e 'my ($nx, $ny, $e) = @ARGV; my $f = eval "sub { my (\$x, \$y) = \@_; $e }";
		my $s = 1; sub noise { $s = ($s * 16807) % 2147483647; $s / 2147483647 - 0.5 }
		for my $y (0 .. $ny - 1) { for my $x (0 .. $nx - 1) {
		print pack "d<", $f->($x, $y) } }' "$1" "$2" "$3" >h.f64
	size=$1x$2
}

# press ARGUMENTS: presses h.f64
press() {
	timeout 60 bemcontact --raw "$size" --fields height,pressure,gap "$@" h.f64
}

# solve ARGUMENTS: presses h.f64 into out.nrrd; status in $status, message in err
solve() {
	press "$@" >out.nrrd 2>err
	status=$?
}

key() { strings -n 3 "${2:-out.nrrd}" | sed -n "s/^$1:=//p" | head -1; }

# column NAME ROW FILE: of a table
column() { awk -F '\t' -v name="$1" -v row="$2" '/^#/ { next } !c { for (c = NF; c > 0 && $c != name; c--); next }
	++n == row { print $c }' "$3"; }

calc() { awk "BEGIN { printf \"%.17g\", $1 }"; }

# error GOT WANT: relative difference
error() { calc "($2) ? sqrt((($1) / ($2) - 1) ^ 2) : sqrt(($1) ^ 2)"; }

# True if the only reason for status 3 is that most of the load is at the edge
is_cut_off() {
	[ "$status" = 3 ] && [ "$(key converged)" = yes ] && awk -v e="$(key edge_load)" 'BEGIN { exit !(e > 0.5) }'
}

# accurate SCENE EXPECTATION ERROR LIMIT: also wants status 0, or the contact at the edge
accurate() {
	reached="area $(key area | cut -c 1-6), $(key iterations) iterations"
	if [ "$status" = 0 ] || is_cut_off; then
		near "$1 | $2 | $reached | $(printf %.1e "$3")" "$3" 0 "$4"
	else
		fail "$1 | $2 | $reached | $3" "status $status" "$(head -2 err)"
	fi
}

# The error of out.nrrd by sums that share nothing with the solver: the relative duality gap
# of its pressure, or 1 where the gap it wrote differs from u - h - approach by more than
# rounding leaves, some 1e-15 a term.
${CC:-cc} -O2 -o complementarity "$top/tests/extremes/complementarity.c" -lm || exit 1
residual() {
	for f in height pressure gap; do
		values $f >$f.values
	done
	# shellcheck disable=SC2046 # numbers are words
	paste height.values pressure.values gap.values | ./complementarity "$(key boundary)" \
		$(sed -n 's/^sizes: [0-9]* //p; s/^spacings: [^ ]* //p; /^$/q' out.nrrd 2>/dev/null) \
		"$(key estar)" "$(key approach)" "$(key hardness)" | awk '{ print $1 <= 1e-12 && $2 ~ /^[0-9]/ ? $2 : 1 }'
}

# Values of a field as text
values() { records -o text --field "$1" out.nrrd | tr '\t' '\n' | grep '^[-0-9]'; }

rough='1e-6 * (cos($x * 0.2) * sin($y * 0.3 + 1) + 0.3 * sin($x * 0.9 + $y * 0.7) + 0.2 * noise())'

# From one cell to all
heights 33 33 '$x == 16 && $y == 16 ? 1e-6 : 0'
solve --pixel 1um --estar 100GPa -F 0.05N
accurate "one cell in contact, free" "indentation F 4 asinh(1) / (pi E* h)" \
	"$(error "$(key indentation)" "0.05 * 3.525494348078172 / ($pi * 1e11 * 1e-6)")" 1e-12
near "one cell | area is one cell | $(key area) | -" "$(key area)" 0.00091827364554637 1e-15
solve --pixel 1um --estar 100GPa -F 0.05N --solver pk
accurate "one cell in contact, pk" "indentation F 4 asinh(1) / (pi E* h)" \
	"$(error "$(key indentation)" "0.05 * 3.525494348078172 / ($pi * 1e11 * 1e-6)")" 1e-12
# A cell 1 m high: the displacement is 1e-11 of it
heights 33 33 '$x == 16 && $y == 16 ? 1 : 0'
solve --pixel 1um --estar 100GPa -F 1uN
accurate "one cell of 1 m in contact, free" "energy F^2 4 asinh(1) / (2 pi E* h)" \
	"$(error "$(key energy)" "1e-12 * 3.525494348078172 / (2 * $pi * 1e11 * 1e-6)")" 1e-12
heights 64 64 "$rough"
last=0
for p in 1e2 1e5 1e7 1e8 1e9 1e10 1e11 1e13; do
	solve --pixel 1um --estar 100GPa --boundary periodic --pressure ${p}Pa
	accurate "periodic, mean pressure ${p%e*}e$((${p#*e} - 11)) E*" "solved, by direct sums; more area than before" \
		"$(calc "$(key area) < $last ? 1 : $(residual)")" 1.01e-8
	last=$(key area)
done
is "periodic, 100 E* | full contact | area $last | -" "$last" 1
for p in 1e2 1e7 1e9 1e13; do
	solve --pixel 1um --estar 100GPa --pressure ${p}Pa
	accurate "free, mean pressure ${p%e*}e$((${p#*e} - 11)) E*" "solved, by direct sums" "$(residual)" 1.01e-8
done

# Stiffness: pressures scale with it, shapes do not change
solve --pixel 1um --estar 1GPa --pressure 10MPa
area=$(key area) approach=$(key approach)
for e in 1e3 1e6 1e12 1e15; do
	solve --pixel 1um --estar ${e}Pa --pressure "$(calc "$e / 100")Pa"
	accurate "E* $e Pa" "the approach of 1 GPa" "$(error "$(key approach)" "$approach")" 1e-12
done
solve --pixel 1um --young 1GPa,1000TPa --poisson 0,0 --pressure 10MPa
accurate "E1/E2 = 1e6" "as against a rigid body, 1e-6 less" \
	"$(error "$(key approach)" "$approach")" 1e-5
for nu in 0 0.25 0.499999 0.5; do
	solve --pixel 1um --young "$(calc "2e9 * (1 - $nu ^ 2)")Pa" --poisson $nu --pressure 10MPa
	accurate "nu $nu" "E / (2 (1 - nu^2)) is E*" "$(error "$(key approach)" "$approach")" 1e-11
done

# Slopes and sizes: a similar problem at another scale
for s in 1e-6 1e-3 1e3; do
	heights 64 64 "$s * ($rough)"
	solve --pixel 1um --estar 1GPa --pressure "$(calc "1e7 * $s")Pa"
	accurate "heights x $s" "the same area, approach in proportion" \
		"$(error "$(key approach)" "$approach * $s")" 1e-11
done
for l in 1e-6 1e6 1e9; do
	heights 64 64 "$l * ($rough)"
	solve --pixel "$(calc "1e-6 * $l")m" --estar 1GPa --pressure 10MPa
	accurate "all lengths x $l (pixel $(calc "1e-6 * $l") m)" "only the units change" \
		"$(error "$(key approach)" "$approach * $l")" 1e-11
done
heights 64 64 "$rough"
solve --pixel 1um --estar 1Pa --pressure 0.01Pa
accurate "all stresses x 1e-9" "only the units change" "$(error "$(key approach)" "$approach")" 1e-11
is "lengths and stresses scaled | the same cells in contact | area $(key area) | -" "$(key area)" "$area"
heights 64 64 "$rough"
solve --pixel 1pm --estar 100GPa --pressure 100GPa
accurate "rms slope 5e5 (pixel 1 pm)" "solved, by direct sums" "$(residual)" 1.01e-8

# Aspect of cells: a wave along x, cells 100 times as long as wide and the reverse
for d in "1e-6 1e-4" "1e-4 1e-6"; do
	{
		printf 'NRRD0004\ntype: double\ndimension: 2\nsizes: 256 4\nspacings: %s\n' "$d"
		printf 'units: "m" "m"\nendian: little\nencoding: raw\n\n'
		perl -e 'for (0 .. 1023) { print pack "d<", 1e-6 * cos(2 * 3.141592653589793 * (($_ & 255) + 0.5) / 256) }'
	} >wave.nrrd
	dx=${d% *}
	bemcontact --estar 100GPa --boundary periodic --pressure "$(calc "0.3 * $pi * 1e11 * 1e-6 / (256 * $dx)")Pa" wave.nrrd >out.nrrd 2>err
	status=$?
	accurate "cells of $d m, a wave" "area (2/pi) asin sqrt 0.3 to a cell" \
		"$(calc "sqrt(($(key area) - 0.369010119565545) ^ 2)")" 0.008
	bemcontact --fields height,pressure,gap --estar 100GPa --pressure 100MPa wave.nrrd >out.nrrd 2>err
	status=$?
	accurate "cells of $d m, free" "solved, by direct sums" "$(residual)" 1.01e-8
done

# Shapes
heights 48 48 1e-6
solve --pixel 1um --estar 100GPa --boundary periodic --pressure 1GPa
accurate "flat, periodic" "uniform pressure" \
	"$(values pressure | awk '{ d = $1 / 1e9 - 1; if (d < 0) d = -d; if (d > m) m = d } END { print (NR ? m + 0 : "no rows") }')" 1e-8
solve --pixel 1um --estar 100GPa --pressure 1GPa
accurate "flat, free: a punch" "solved, by direct sums; full contact" "$(calc "$(key area) == 1 ? $(residual) : 1")" 1.01e-8
heights 48 48 '$x < 24 ? 1e-6 : 0'
solve --pixel 1um --estar 100GPa --pressure 10MPa
accurate "step edge, light" "only the upper half in contact" "$(calc "sqrt(($(key area) - 0.5) ^ 2)")" 1e-9
solve --pixel 1um --estar 100GPa --pressure 10GPa --boundary periodic
accurate "step edge, pressed in" "solved, by direct sums; all but the foot of the step" \
	"$(calc "($(key area) > 0.5) * ($(key area) < 1) ? $(residual) : 1")" 1.01e-8
heights 48 48 '1e-6 * noise()'
for b in free periodic; do
	solve --pixel 1um --estar 100GPa --pressure 1GPa --boundary $b
	accurate "white noise, $b" "solved, by direct sums" "$(residual)" 1.01e-8
done
heights 64 64 '(($x + $y) & 1) * 1e-7'
solve --pixel 1um --estar 100GPa --pressure 1GPa --boundary periodic
accurate "checkerboard" "solved, by direct sums" "$(residual)" 1.01e-8

# Grids
for g in "1 1" "1 97" "97 1" "2 2" "3 5" "31 37" "61 61" "127 2" "400 4" "4 400"; do
	# shellcheck disable=SC2086 # two words
	heights $g "$rough"
	for b in free periodic; do
		solve --pixel 1um --estar 100GPa --pressure 500MPa --boundary $b
		accurate "grid $size, $b" "solved, by direct sums" "$(residual)" 1.01e-8
	done
done

# Hardness
heights 64 64 "$rough"
for h in 1.000001 1.01 2; do
	solve --pixel 1um --estar 100GPa --pressure 1GPa --hardness "$(calc "$h * 1e9")Pa"
	accurate "hardness $h x mean pressure" "area at least load / hardness" \
		"$(calc "$(key area) * $h < 1 - 1e-9 ? 1 : $(residual)")" 1.01e-8
done
refused "hardness at the mean pressure" 1 'not below the hardness' press --pixel 1um --estar 100GPa --pressure 1GPa --hardness 1GPa
refused "hardness just below the mean pressure" 1 'not below the hardness' press --pixel 1um --estar 100GPa --pressure 1GPa --hardness 999999999Pa
refused "periodic, approach past full contact" 1 'beyond full contact' press --pixel 1um --estar 100GPa --boundary periodic --approach 5um

for k in 16 1000 4000; do
	for solver in bccg pk; do
		solve --pixel 1um --estar 100GPa --pressure "$(calc "$k / 4096 * 2e9")Pa" --hardness 2GPa --solver $solver
		accurate "load of $k cells at the hardness, $solver" "the energy at 1e-9 less load" \
			"$(error "$(key energy)" "$(bemcontact --raw $size --pixel 1um --estar 100GPa --hardness 2GPa \
				--pressure "$(calc "$k / 4096 * 2e9 * (1 - 1e-9)")Pa" --tolerance 1e-11 h.f64 >near.nrrd
				key energy near.nrrd)")" 1e-7
	done
done

# A pit that touches nothing changes nothing, however deep and wherever it is: the mean
# difference of the pressures from those over a pit of 0.1 mm
for at in "20 31" "40 10"; do
	set -- $at
	for b in free periodic; do
		for depth in 1e-4 1 1e3; do
			heights 64 64 "\$x == $1 && \$y == $2 ? -$depth : ($rough)"
			if [ $depth = 1e-4 ]; then
				solve --pixel 1um --estar 100GPa --pressure 1GPa --boundary $b --tolerance 1e-12
				values pressure >shallow
				continue
			fi
			solve --pixel 1um --estar 100GPa --pressure 1GPa --boundary $b
			accurate "a pit of $depth m at $at, $b" "the pressure over a pit of 0.1 mm" "$(values pressure |
				paste - shallow | awk '{ d = $1 - $2; s += d < 0 ? -d : d; t += $2 } END { print s / t }')" 2e-7
		done
	done
done

# A ball of radius R under tangential loads: Hertz, and Cattaneo and Mindlin with the shear
# modulus G: a = (3 F R / 4 E*)^(1/3), the part of its area that sticks s^2 and the
# displacement 3 mu F (2 - nu) / (8 G a) (1 - s^2), s = (1 - T / mu F)^(1/3)
heights 160 160 '-(($x - 79.5) ** 2 + ($y - 79.5) ** 2) * 1e-12 / 2 / 4e-3'
for share in 1e-4 0.1 0.5 0.9 0.999; do
	solve --pixel 1um --young 70GPa --poisson 0.2 -F 5N --friction 0.7 --tangential "$(calc "$share * 3.5")N"
	stick=$(calc "(1 - $share) ^ (2 / 3)")
	radius=$(calc "(3 * 5 * 4e-3 / 4 / (70e9 / 1.92)) ^ (1 / 3)")
	accurate "a ball, $share of its friction" "displacement of Cattaneo and Mindlin" "$(error "$(key tangential_displacement)" \
		"3 * 3.5 * 1.8 / (8 * 70e9 / 2.4 * $radius) * (1 - $stick)")" 1e-3
	accurate "a ball, $share of its friction" "stick area of Cattaneo and Mindlin, of the contact" \
		"$(calc "sqrt(($(key stick_area) / $(key area) - $stick) ^ 2)")" 0.01
done
refused "a tangential load above the friction" 1 'slips: friction bears 3.5 N' press --pixel 1um --young 70GPa --poisson 0.2 -F 5N --friction 0.7 --tangential 3.6N

# A curve of loads in one run: every row Hertz
press --pixel 1um --estar 36GPa -F 6N --sweep 6 --table sweep.tsv >out.nrrd 2>err
status=$?
for row in 1 2 4 6; do
	accurate "a ball, row $row of 6 of a sweep" "approach of Hertz" "$(error "$(column indentation $row sweep.tsv)" \
		"(9 * $row ^ 2 / (16 * 4e-3 * 36e9 ^ 2)) ^ (1 / 3)")" 1e-3
	accurate "a ball, row $row of 6 of a sweep" "stiffness 2 E* a" "$(error "$(column stiffness $row sweep.tsv)" \
		"2 * 36e9 * (3 * $row * 4e-3 / 4 / 36e9) ^ (1 / 3)")" 0.01
done

# Four by three equal bumps far apart: patches by hand, each a twelfth of the load
heights 160 120 '-((($x % 40) - 19.5) ** 2 + (($y % 40) - 19.5) ** 2) * 1e-12 / 2 / 1e-3'
press --pixel 1um --estar 36GPa --boundary periodic -F 0.12N --patches patches.tsv >out.nrrd 2>err
status=$?
accurate "4 x 3 bumps" "12 patches" "$(calc "sqrt(($(grep -c '^[0-9]' patches.tsv) - 12) ^ 2)")" 0
for row in 1 7 12; do
	accurate "4 x 3 bumps, patch $row" "a twelfth of the load" \
		"$(error "$(column load $row patches.tsv)" 0.01)" 1e-6
	accurate "4 x 3 bumps, patch $row" "centre on its bump" "$(calc "sqrt(($(column x $row patches.tsv) - (($row - 1) % 4 * 40 + 20) * 1e-6) ^ 2 \
		+ ($(column y $row patches.tsv) - (int(($row - 1) / 4) * 40 + 20) * 1e-6) ^ 2) / 1e-6")" 1e-6
	accurate "4 x 3 bumps, patch $row" "area of Hertz" "$(error "$(column corrected_area $row patches.tsv)" \
		"$pi * (3 * 0.01 * 1e-3 / 4 / 36e9) ^ (2 / 3)")" 0.05
done

# A layer under a wave of 1 um, pressed flat: amplitude of the pressure at the limits of
# thickness: of the substrate, of the layer alone, and of confined compression of a thin
# layer on a rigid base
heights 64 4 '1e-6 * cos(2 * 3.141592653589793 * $x / 64)'
q=$(calc "2 * $pi / 64e-6")
# layer NAME LIMIT STIFFNESS SUBSTRATE THICKNESS YOUNG POISSON
layer() {
	solve --pixel 1um --boundary periodic --pressure "$(calc "2e-6 * ($3)")Pa" --young "$4,1e30Pa" --poisson 0.25,0.25 \
		--coating "$5" --coating-young "$6" --coating-poisson "$7"
	accurate "a layer of $5, $6 on $4" "$1" "$(error "$(values pressure | awk 'NR == 1 { l = h = $1 }
		{ if ($1 < l) l = $1; if ($1 > h) h = $1 } END { printf "%.17g", (h - l) / 2 / 1e-6 }')" "$3")" "$2"
}
layer "the substrate alone" 1e-5 "100e9 / (1 - 0.0625) * $q / 2" 100GPa 1pm 300GPa 0.2
layer "the layer alone" 1e-9 "300e9 / (1 - 0.04) * $q / 2" 100GPa 1m 300GPa 0.2
layer "one material at any thickness" 1e-9 "100e9 / (1 - 0.0625) * $q / 2" 100GPa 10um 100GPa 0.25
layer "E (1 - nu) / ((1 + nu) (1 - 2 nu) t)" 1e-3 "1e9 * 0.7 / (1.3 * 0.4) / 100e-9" 1e18Pa 100nm 1GPa 0.3

# Precision
for b in free periodic; do
	solve --pixel 1um --estar 100GPa --pressure 500MPa --tolerance 1e-13 --boundary $b
	accurate "tolerance 1e-13, $b" "reached" "$(residual)" 1.01e-13
	solve --pixel 1um --estar 100GPa --pressure 500MPa --tolerance 1e-16 --boundary $b
	line="tolerance 1e-16, $b | reached, or exit 3 within 400 iterations"
	line="$line | exit $status, $(key iterations) iterations | $(key optimality_gap)"
	case $status$(key converged) in
	0yes | 3no) if [ "$(key iterations)" -lt 400 ]; then pass "$line"; else fail "$line"; fi ;;
	*) fail "$line" "$(cat err)" ;;
	esac
done

# Not numbers, or beyond them
heights 8 8 '$x + $y ? 0 : "nan"'
refused "a height that is not a number" 1 'height' press --pixel 1um --estar 1GPa --pressure 1MPa
heights 8 8 '$x + $y ? 0 : 1e308 * ($x ? -1 : 1)'
refused "a height of 1e308 m" 1 'float64' press --pixel 1um --estar 1GPa --pressure 1MPa
heights 8 8 '$x & 1 ? 1e200 : -1e200'
refused "heights whose square overflows" 1 'float64' press --pixel 1um --estar 1GPa --pressure 1MPa
done_testing

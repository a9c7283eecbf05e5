#!/bin/sh
# Stiff and extreme scenes of debrisgen: accurate, or refused in one line.
. "$(dirname "$0")/../tap.sh"

# shellcheck source=tests/extremes/scenes.sh
. "${test_file%/*}/scenes.sh"

# One loaded cell of side 1 um and 1 GPa in the middle of 9 x 9.
roughgen -n 9 -L 9um --sq 0 --crown 9um | bemcontact -F 1mN --estar 1000TPa >cell.nrrd

# below H OPTION...: largest von Mises stress of layer 1 at depth H, Pa
below() {
	h=$1
	shift
	debrisgen -Y 1e30 --depth-step "$h" --stress s.nrrd --stress-layers 2 "$@" cell.nrrd >/dev/null
	records -o table s.nrrd | awk -v z="$h" '!/^[#r]/ && $4 > 0 && $5 > m { m = $5 } END { print m }'
}

# Below the middle of the pyramid of pressure of one cell (sums over 10^4 parts of it,
# extrapolated); from far away a point load: 3/2pi + (1 - 2 nu)/4pi over z^2.
# Near the surface the values are those at z = 0 and a term in z/h.
relative "one cell, z/h = 1e-6" "0.2 p under the middle" 0.2e9 2e-4 "$(below 1e-12m)"
relative "one cell, z/h = 0.5" "0.436438 p" 436438093 3e-5 "$(below 0.5um)"
relative "one cell, z/h = 5" "0.0196142 p" 19614181 2e-5 "$(below 5um)"
far() { awk -v z="$1" 'BEGIN { printf "%.17g", 1e9 * (1.5 + 0.1) / 3.14159265358979324 / z ^ 2 }'; }
relative "one cell, z/h = 1e3" "a point load" "$(far 1e3)" 1e-6 "$(below 1mm)"
relative "one cell, z/h = 1e4" "a point load" "$(far 1e4)" 1e-7 "$(below 10mm)"
relative "mu = 5, on the surface" "sqrt(0.2^2 + 3 5^2) p" 8662563131.083085 1e-5 "$(below 1e-12m -u 5)"
relative "nu = 0.5, on the surface" "a hydrostatic patch: 0, in Pa" 0 5e4 "$(below 1e-12m --poisson 0.5)"
relative "nu = 0, on the surface" "sxx = syy = -p/2: 0.5 p" 0.5e9 1e-4 "$(below 1e-12m --poisson 0)"

# The same scene in other units.
cells() {
	sq=$1 corr=$2 crown=$3 length=$4 load=$5 young=$6 yield=$7
	roughgen -n 64 -L "$length" -q "$sq" -l "$corr" --crown "$crown" | bemcontact -F "$load" -E "$young" |
		debrisgen -Y "$yield" -u 0.3 --steps 3 -E "$young" 2>/dev/null | awk '/^[#r]/ { next }
			{ printf "%d %d %.6f %.6f;", $2, $4, $8, $14 }'
}
here=$(cells 8um 50um 32um 0.5mm 20N 210GPa 355MPa)
count=$(echo "$here" | tr ';' '\n' | grep -c .)
is "all lengths x 1e9 | the same $count particles | $count | 0" \
	"$(cells 8e3 50e3 32e3 5e5 20e18 210GPa 355MPa)" "$here"
is "all stresses x 1e-9 | the same $count particles | $count | 0" \
	"$(cells 8um 50um 32um 0.5mm 20e-9 210 0.355)" "$here"
is "all stresses x 1e-15 | the same $count particles | $count | 0" \
	"$(cells 8um 50um 32um 0.5mm 20e-15 210e-6 355e-9)" "$here"

# Everything and nothing fails.
debrisgen -Y 1e30 -S st cell.nrrd >t
is "nothing fails | no particle | $(grep -vc '^[#r]' t) rows, $(column layers st) layers searched | 0" \
	"$(grep -vc '^[#r]' t) $(column layers st)" "0 1"
roughgen -n 9 -L 9um --sq 0 --crown 9um | bemcontact -F 1N --estar 1000TPa >crushed.nrrd
refused "everything fails" 1 "deeper than ten times" debrisgen --yield 1MPa crushed.nrrd
roughgen -n 32 -L 1mm --sq 1nm -l 200um | bemcontact --pressure 1GPa -E 210GPa --boundary periodic >flat.nrrd
refused "everything fails, periodic" 1 "deeper than ten times" debrisgen --stop-area 1 -Y 1MPa --boundary periodic flat.nrrd
debrisgen --stop-area 1 -Y 600MPa --boundary periodic flat.nrrd >t 2>err
is "periodic, yield just above the confined mean 4/7 p | no particle | $(grep -vc '^[#r]' t) rows | 0" \
	"$(grep -vc '^[#r]' t) $(cat err)" "0 "
roughgen -n 16 -L 1mm | bemcontact --pressure 0 -E 1GPa >zero.nrrd
debrisgen -Y 1 zero.nrrd >t
is "no load | no particle | $(grep -vc '^[#r]' t) rows | 0" "$(grep -vc '^[#r]' t)" 0

# Yield exactly at the largest stress: over it nothing, under it one cell.
peak=$(debrisgen -Y 1e30 -u 0.3 --stress s.nrrd --stress-layers 1 cell.nrrd >t && records s.nrrd | awk '$3 == "von_mises" { print $12 }')
times_peak() { awk -v p="$peak" -v f="$1" 'BEGIN { printf "%.17g", p * f }'; }
debrisgen -u 0.3 -Y "$(times_peak 1.000000000001)" cell.nrrd >t
is "yield 1e-12 above the largest stress | no particle | $(grep -vc '^[#r]' t) rows | 0" \
	"$(grep -vc '^[#r]' t)" 0
debrisgen -u 0.3 -Y "$(times_peak 0.999999999999)" --depth-step 10um cell.nrrd >t
relative "yield 1e-12 below it" "one cell, 12.41 um across" \
	"$(awk 'BEGIN { printf "%.17g", (6 * 10 / 3.14159265358979324) ^ (1 / 3) * 1e-6 }')" 1e-6 "$(column diameter t)"

# The volume that direct sums of point loads give under the pressure of a file:
# worn FILE NX NY DX DY
${CC:-cc} -O2 -D_XOPEN_SOURCE=700 -o worn "$top/tests/extremes/worn.c" -lm || exit 1
worn() {
	file=$1
	shift
	records -o text --field pressure "$file" | tr '\t' '\n' | grep '^[-0-9]' |
		./worn "$@" 0.3 0.3 355e6 | cut -d ' ' -f 1
}

# Thin, long and odd grids.
for n in 1x64 64x1 7x131; do
	nx=${n%x*} ny=${n#*x}
	roughgen -n $n -L "$(awk -v x="$nx" -v y="$ny" 'BEGIN { print x "um" "x" y "um" }')" -q 0.1um -l 5um |
		bemcontact --pressure 50MPa -E 210GPa >thin.nrrd
	debrisgen -Y 355MPa -u 0.3 --summary s.tsv thin.nrrd 2>err >t
	relative "$n cells" "particles have the volume worn off" \
		"$(column volume t | awk '{ s += $1 } END { printf "%.17g", s }')" 1e-12 "$(column volume s.tsv)"
	relative "$n cells" "the volume by direct sums" \
		"$(worn thin.nrrd "$nx" "$ny" 1e-6 1e-6)" 0.02 "$(column volume s.tsv)"
done
roughgen -n 16 -L 1mmx10um -q 0.1um -l 8um | bemcontact -F 1N -E 210GPa >flat.nrrd
for step in 1um ''; do
	debrisgen -Y 355MPa -u 0.3 ${step:+--depth-step "$step"} --summary s.tsv flat.nrrd 2>err >t
	relative "cells 1:100${step:+, $step deep}" "particles have the volume worn off" \
		"$(column volume t | awk '{ s += $1 } END { printf "%.17g", s }')" 1e-12 "$(column volume s.tsv)"
done
relative "cells 1:100" "the volume by direct sums" "$(worn flat.nrrd 16 16 6.25e-5 6.25e-7)" 0.02 "$(column volume s.tsv)"
for seed in 1 2 3; do
	roughgen --seed $seed -n 64 -L 0.5mm -q 8um -l 50um --crown 32um | bemcontact -F 20N -E 210GPa >rough.nrrd
	debrisgen -Y 355MPa -u 0.3 --summary s.tsv rough.nrrd >t
	relative "rough, seed $seed" "the volume by direct sums" \
		"$(worn rough.nrrd 64 64 7.8125e-6 7.8125e-6)" 0.01 "$(column volume s.tsv)"
done

# Depth steps far from the sides of a cell.
roughgen -n 40 -L 1mm --sq 0 --crown 50um | bemcontact -F 50N -E 210GPa >ball.nrrd
volume() { debrisgen -Y 355MPa -u 0.3 "$@" --summary s.tsv ball.nrrd >t && column volume s.tsv; }
exact=$(worn ball.nrrd 40 40 2.5e-5 2.5e-5)
relative "a smooth ball" "the volume by direct sums" "$exact" 0.01 "$(volume)"
relative "cells 25 times flatter" "the volume by direct sums" "$exact" 1e-4 "$(volume --layer mid --depth-step 1um)"
relative "cells twice as tall, five deep" "the volume by direct sums" "$exact" 0.2 "$(volume --layer mid --depth-step 50um)"

if [ -x "$top/build/unit/particles_large" ]; then
	"$top/build/unit/particles_large" >large
	while read -r line; do
		case $line in
		"ok "*) pass "${line#* - }" ;;
		"not ok "*) fail "${line#* - }" ;;
		esac
	done <large
else
	skip "particles of 1e7 cells, checkerboards" "build/unit/particles_large is not built"
fi
done_testing

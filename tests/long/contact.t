#!/bin/sh
# bemcontact against others' results, and what it promises of its work and memory
. "$(dirname "$0")/../tap.sh"
bench=${BIN:-$top/bin}
bench=${bench%/bin}/build/bench/contact

key() { strings -n 3 "$2" | sed -n "s/^$1:=//p"; }

mean() { awk '{ s += $1 } END { print s / NR }'; }


# Area against load by Green's function molecular dynamics (Campana and Mueser): Hurst 0.8,
# rms gradient 0.2766, two decades of wavelengths.  Realisations differ by some per cent.
roughgen -n 512 -L 1m --hurst 0.8 --rolloff 1m --cutoff 10mm --slope 0.2766 -c 4 -s 5 >rough.nrrd
for row in "0.001 0.00827 0.1" "0.01 0.0779 0.05" "0.04 0.2846 0.05" "0.113 0.6571 0.05" \
	"0.24 0.9406 0.05"; do
	# shellcheck disable=SC2086 # three words
	set -- $row
	bemcontact --estar 1Pa --boundary periodic --pressure "$1Pa" --tolerance 1e-5 rough.nrrd >pressed.nrrd
	near "the area at p/E* $1 is right to $3" "$(key area pressed.nrrd | mean | awk -v w="$2" '{ print $1 / w }')" \
		1 "$3"
done

# A ball on a half-space, both of G 200, nu 0.42, R 50, F 9.1954: a 1, p0 4.3905, approach 0.02
# (worked in the units of the CONTACT manual)
perl -e 'for $y (0 .. 255) { for $x (0 .. 255) {
	print pack "d<", -((($x - 127.5) / 64) ** 2 + (($y - 127.5) / 64) ** 2) / 100 } }' >ball.f64
bemcontact --raw 256x256 --pixel 0.015625m -E 568Pa --poisson 0.42 -F 9.1954N ball.f64 >ball.nrrd
near "the approach of a ball is right" "$(key approach ball.nrrd)" 0.02 2e-6
near "the largest pressure of a ball is right" "$(records -o list --field pressure ball.nrrd | column max /dev/stdin)" 4.3905 5e-4

# Strips and primes: the pressure agrees with that of Polonsky and Keer's loop, which shares
# neither preconditioner nor coarse grids, in far fewer iterations
for row in "4096x64 60" "64x1024 25" "1024x16 30" "3x2000 30" "509x37 25"; do
	# shellcheck disable=SC2086 # two words
	set -- $row
	nx=${1%x*} ny=${1#*x}
	roughgen --points "$1" --length "${nx}umx${ny}um" --hurst 0.8 --rolloff 64um --cutoff 8um --slope 0.1 -s 3 >strip.nrrd
	bemcontact --estar 1Pa --boundary periodic --pressure 0.02Pa strip.nrrd >fast.nrrd
	bemcontact --estar 1Pa --boundary periodic --pressure 0.02Pa --solver pk --tolerance 1e-7 strip.nrrd >slow.nrrd
	at_most "$1 periodic: the iterations are few" "$(key iterations fast.nrrd)" "$2"
	near "$1 periodic: the energy is that of Polonsky and Keer's solver" "$(awk "BEGIN { print \
		$(key energy fast.nrrd) / $(key energy slow.nrrd) - 1 }")" 0 2e-6
done

# Rough down to the cells: bounds cut off much of a step, which is restored close by
roughgen --points 2048 --length 3mm --hurst 0.9 --rolloff 900um --slope 0.3 -s 72 >rough.nrrd
bemcontact --estar 1Pa --boundary periodic --pressure 0.06Pa rough.nrrd >fast.nrrd
at_most "2048x2048 rough down to the cells: the iterations are few" "$(key iterations fast.nrrd)" 18

# Strips of white noise, in which the bounds cut off much of a step everywhere
perl -e 'srand(3); for (1 .. 64 * 4096) { print pack "d<", 1e-6 * sqrt(-2 * log(1 - rand)) * cos(6.283185307179586 * rand) }' >noise.f64
for size in 64x4096 4096x64; do
	for p in 3e9 30e9 60e9; do
		bemcontact --raw $size --pixel 1um --estar 100GPa --boundary periodic --pressure ${p}Pa noise.f64 >strip.nrrd
		at_most "$size of white noise, $(key area strip.nrrd | cut -c 1-4) in contact: the iterations are few" \
			"$(key iterations strip.nrrd)" 35
	done
done

# Work: transforms to an optimality gap of 1e-8 on defined surfaces (tests/bench/contact.c), those of
# coarser grids counted by size; memory in doubles per cell less what any program needs.
if [ -x "$bench" ]; then
	none=$("$bench" per 16 0.01 bccg 1e-2 | cut -f 16)
	for row in "per 1024 0.0025 90 8.2" "per 1024 0.01 90 8.2" "per 1024 0.036 90 8.2" \
		"free 512 0.0208333333333 60 12"; do
		# shellcheck disable=SC2086 # five words
		set -- $row
		"$bench" "$1" "$2" "$3" bccg 1e-8 >row
		at_most "$1 $2 under $3: the optimality gap is small" "$(cut -f 6 row)" 1e-8
		at_most "$1 $2 under $3: the transforms are few" "$(cut -f 15 row)" "$4"
		at_most "$1 $2 under $3: the doubles per cell are few" \
			"$(awk -F '\t' -v z="$none" '{ printf "%.2f", ($16 - z) * 131072 / $2 ^ 2 }' row)" "$5"
	done
else
	skip "work and memory are bounded" "build/bench/contact is not built: make bench-contact builds it"
fi
done_testing

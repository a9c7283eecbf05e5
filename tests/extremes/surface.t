#!/bin/sh
# Stiff and extreme surfaces: each is accurate, or refused in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# value COLUMN: of the first row of t
value() { column "$1" t | head -1; }

# measure NAME EXPECTATION COLUMN WANT TOLERANCE OPTION...: relative error of a parameter
measure() {
	name=$1
	expectation=$2
	parameter=$3
	want=$4
	tolerance=$5
	shift 5
	roughgen "$@" --measure >t 2>err
	relative "$name" "$expectation" "$want" "$tolerance" "$(value "$parameter")"
}

# Sizes.
measure "1 x 64 points" "Sq exact" sq 1e-6 1e-12 -n 1x64
measure "64 x 1 points" "Sq exact" sq 1e-6 1e-12 -n 64x1
measure "2 x 2 points" "Sq exact" sq 1e-6 1e-12 -n 2
measure "3 x 2 points" "Sq exact" sq 1e-6 1e-12 -n 3x2
measure "prime sides, 127 x 131" "Sq exact" sq 1e-6 1e-12 -n 127x131
measure "odd sides, 99 x 75" "rms slope as wanted" sdq_iso7 0.1 0.02 -n 99x75 -l 60um --slope 0.1
measure "one flat point" "Sq = 0" sq 0 0 -n 1 -q 0
refused "one rough point" 2 'single point' roughgen -n 1
measure "2048 x 2 points" "Sq exact" sq 1e-6 1e-12 -n 2048x2 -L 1mmx1mm

# Correlation lengths.  White noise: Sdq = sqrt 4 Sq / dx, up to 2 / sqrt(2 n) = 2 %.
measure "correlation length 1/1000 of the spacing" "white noise: Sdq = 2 Sq / dx" sdq 0.2 0.02 \
	-n 100 -l 10nm
measure "the same, exponential" "white noise: Sdq = 2 Sq / dx" sdq 0.2 0.02 -n 100 -l 10nm --acf exp
# Gaussian: Sdq = 2 Sq / corr; 400 patches: 5 %.
measure "correlation length of four spacings" "Sdq = 2 Sq / corr" sdq_iso7 0.05 0.05 \
	-n 256 -l 40um -L 2.56mm
# The next waves, along the diagonals, have e^-pi^2 = 5e-5 of the power.
measure "correlation length of the whole side" "one wavelength: Sdq = 2 pi Sq / L" \
	sdq_iso7 6.283e-3 0.05 -n 128 -l 1mm
refused "correlation length above the side" 1 'longer than a side' roughgen -l 1.1mm
refused "anisotropic, one length above the side" 1 'longer than a side' roughgen -l 10umx2mm
measure "correlation lengths 1 : 100 on pixels 1 : 100" "Str of the samples = 0.01" str 0.01 0.2 \
	-n 256 -L 1mmx100mm -l 50umx5mm
measure "Hurst exponent 0" "rms slope as wanted" sdq_iso7 0.1 0.15 -n 256 --hurst 0 --cutoff 20um --slope 0.1
measure "Hurst exponent 2" "Sq exact" sq 1e-6 1e-12 -n 256 --hurst 2
refused "cut-off above the side" 1 'no wave' roughgen --cutoff 3mm
refused "cut-off above roll-off" 2 'longer than' roughgen --hurst 0.8 --rolloff 10um --cutoff 20um

# Units: lengths times 1e9 change nothing but units.
roughgen -n 64 -L 1mm -q 1um --measure >t
want=$(value sdq)
for l in "1pm 1e-15" "1m 1e-3" "1Mm 1e3"; do
	set -- $l
	measure "side $1, Sq $2 m" "Sdq as at 1 mm, 1 um" sdq "$want" 1e-12 -n 64 -L "$1" -q "$2"
done
measure "rms slope 1e-6" "Sdr = Sdq_cell^2 / 2 = 4.9e-13" sdr 4.943e-13 0.002 -n 64 --slope 1e-6
measure "rms slope 10" "Sdq as wanted" sdq_iso7 10 0.02 -n 64 --slope 10
measure "Sq 1e9 m" "Sq exact" sq 1e9 1e-12 -n 64 -q 1e9
refused "Sq 1e-300 m" 2 'want 0, or 1e-30' roughgen -n 64 -q 1e-300
refused "Sq nan" 2 'nan' roughgen -n 64 -q nan
refused "Sq -1 um" 2 'sq' roughgen -n 64 -q -1um
refused "side 1e-300 m" 2 'length' roughgen -n 64 -L 1e-300
refused "4e9 points" 2 'points' roughgen -n 4000000000

# Moments.
measure "kurtosis 1.01: heights near two values" "Sku exact" sku 1.01 1e-6 -n 64 --skewness 0 --kurtosis 1.01
measure "skewness 10, kurtosis 200" "Ssk exact" ssk 10 1e-6 -n 64 --skewness 10 --kurtosis 200
measure "skewness -30, kurtosis 950" "Sku exact" sku 950 1e-6 -n 64 --skewness -30 --kurtosis 950
measure "kurtosis a thousandth above the limit" "Ssk exact" ssk 2 1e-5 -n 64 --skewness 2 --kurtosis 5.005
refused "kurtosis at the limit" 2 'must exceed' roughgen -n 64 --skewness 2 --kurtosis 5
refused "kurtosis 900 with 64 points" 1 'out of reach' roughgen -n 8 --skewness 0 --kurtosis 900
refused "imposed heights on 2 x 2 points" 1 'out of reach' roughgen -n 2 --skewness 1

# Measured surfaces.
printf '%8s' '' | tr ' ' '\0' >zero.f64
measure "one measured point" "Sq = 0" sq 0 0 --raw 1x1 --pixel 1um zero.f64
roughgen -n 64 -q 1nm >small.nrrd
measure "resampled to one point" "Sq = 0" sq 0 1e-24 --resample 1 small.nrrd
# The Gaussian correlation has 6.4 samples to its length: cubic pieces follow it to a
# per cent.  The wanted slope is that of the 64 points by a formula of sixth order.
roughgen --measure small.nrrd >t
want=$(value sdq_iso7)
measure "resampled from 64 to 1001 x 999 points" "Sdq is kept" sdq "$want" 0.02 \
	--resample 1001x999 small.nrrd

# Filters and form.
roughgen --measure small.nrrd >t
sq=$(value sq)
measure "an L-filter of 1000 km" "Sq stays" sq "$sq" 1e-9 --l-filter 1e6 small.nrrd
measure "an S-filter of 1000 km around a surface that repeats" "Sq = 0" sq 0 1e-21 --s-filter 1e3 --ends periodic small.nrrd
measure "an S-filter of 1 fm" "Sq exactly the same" sq "$sq" 0 --s-filter 1e-15 small.nrrd
measure "one point filtered" "Sq = 0" sq 0 0 --raw 1x1 --pixel 1um --s-filter 1um --ends 2 zero.f64
roughgen -n 2000x1 -q 1nm -l 20um >line.nrrd
measure "a profile of 2000 points, poly6" "Sk of some nm" sk 2.5e-9 0.5 --form poly6 line.nrrd
awk 'BEGIN { for (i = 0; i < 4096; i++) printf "%s", i % 64 < 32 ? "\\0\\0\\0\\0\\0\\0\\0\\0" : "\\0\\0\\0\\0\\0\\0\\360\\077" }' >words
printf "$(cat words)" >steps.f64
measure "steps of 1 m on pixels of 1 nm" "Svk = 2 m" svk 2 1e-3 --raw 64x64 --pixel 1nm steps.f64
done_testing

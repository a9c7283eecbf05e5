#!/bin/sh
# Extreme scenes of abrade: accurate, or refused or marked in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"

# one COLUMN DIAMETER OPTION...: what becomes of a single particle, in 12 digits
one() {
	c=$1
	printf 'diameter\taspect\n%s\n' "$2" >one.tsv
	shift 2
	abrade "$@" one.tsv >out 2>err
	column "$c" out | awk '{ print $1 ~ /^[-0-9.]/ ? sprintf("%.12g", $1) : $1 }'
}
ratio() {
	awk -v a="$1" -v b="$2" 'BEGIN { printf "%.9f", a / b }'
}
pi=3.14159265358979

# shallow limit pi d D H1 H2 / (H1 + H2)
scene "an overlap of 1e-9 diameters" "load of the shallow limit" 1 1e-6 "$(ratio \
	"$(one load '10.00000001e-6	1' --gap 10um --hardness 2GPa,6GPa --friction 0)" \
	"$(awk -v p=$pi 'BEGIN { printf "%.12g", p * 10e-6 * 1e-14 * 1.5e9 }')")"
scene "hardness equal, half the overlap each" "depth 0.5 um" 0.5e-6 1e-17 \
	"$(one depth1 '10e-6	1' --gap 9um --hardness 3GPa,3GPa --friction 0)"
scene "hardness 1 Pa against 1000 TPa" "the soft body takes the whole indentation" 1e-6 1e-15 \
	"$(one depth1 '10e-6	1' --gap 9um --hardness 1Pa,1e15Pa --friction 0)"
scene "hardness 1000 TPa against 1 Pa" "only the soft body carries the load" 1 1e-6 "$(ratio \
	"$(one load '10e-6	1' --gap 9um --hardness 1e15Pa,1Pa --friction 0)" "$(awk -v p=$pi 'BEGIN { printf "%.12g", p * 9e-12 }')")"
scene "a gap of 1e-7 diameters" "at most section times hardness: pi d^2 / 4 H" 1 1e-6 "$(ratio \
	"$(one load '10e-6	1' --gap 1pm --hardness 2GPa,6GPa --friction 0)" "$(awk -v p=$pi 'BEGIN { printf "%.12g", p * 25e-12 * 2e9 }')")"
scene "a particle of 0.1 m in a gap of 1 pm" "marked as buried" 3 0 "$(one mode '0.1	9' --gap 1pm --hardness 2GPa --friction 0 >mode
	abrade --gap 1pm --hardness 2GPa --friction 0 one.tsv >out 2>err; echo $?)"
is "a gap larger than all particles | nothing touches | free 0 | none" \
	"$(one mode '10e-6	1' --gap 1m --hardness 2GPa --friction 0) $(one load '10e-6	1' --gap 1m --hardness 2GPa --friction 0)" "free 0"
is "a needle of aspect 1e6, friction 10 | grooves: 1e6 > 20 | grooves | none" \
	"$(one mode '10e-6	1e6' --gap 9um --hardness 2GPa --friction 10)" grooves
is "a sphere embedded beyond its equator | slides on the harder body | grooves | none" \
	"$(one mode '20e-6	1' --gap 3um --hardness 1GPa,9GPa --friction 0.1)" grooves
is "a sphere without friction | rolls: 1 <= 1 | rolls | none" \
	"$(one mode '10e-6	1' --gap 9um --hardness 2GPa --friction 0)" rolls
scene "a load of 1e-30 N on one particle" "the gap is its diameter" 1 1e-9 "$(ratio "$(
	printf 'diameter\n10e-6\n' >p.tsv
	abrade --load 1e-30N --hardness 2GPa --friction 0 --summary s p.tsv >out; column gap s)" 10e-6)"
printf 'diameter\n1e-9\n1e-2\n' >p.tsv
scene "diameters seven decades apart under a load" "the load is reached" 1 1e-9 \
	"$(abrade --load 1N --hardness 2GPa,6GPa --friction 0 --summary s p.tsv >out; column load s)"
scene "code 28:27:26, 1e6 particles per ml" "no particle larger than the gap is left out" 0 0 "$(
	abrade --iso 28:27:26 --largest 20um --area 1mm2 --gap 4um --hardness 2GPa --friction 0 --stats st >out
	column particles_left_out st | awk '{ print ($1 > 100) }')"
scene "code 28:27:26 on 100 square metres" "refused: more than memory can hold" 1 0 "$(
	abrade --iso 28:27:26 --largest 20um --area 100m2 --gap 4um --hardness 2GPa --friction 0 >out 2>err; echo $?)"
is "the cleanest code | no particle, an empty table | 0 | none" "$(
	abrade --iso 2:1:0 --largest 20um --area 1mm2 --gap 4um --hardness 2GPa --friction 0 >out; grep -c '^[0-9]' out)" 0
scene "a load that no gap can carry" "refused" 1 0 "$(
	abrade --iso 18:16:13 --largest 20um --area 1mm2 --load 1MN --hardness 2GPa --friction 0 >out 2>err; echo $?)"
scene "a groove 1000 times around a surface" "volume kept" 1 1e-9 "$(
	roughgen --points 16 --length 10um --sq 0 >flat.nrrd
	printf 'diameter\taspect\n2e-6\t3\n' >p.tsv
	abrade --gap 1.9um --hardness 2GPa,1GPa --friction 0 --slide 10mm --surface flat.nrrd --particles w p.tsv >worn.nrrd
	ratio "$(records -o list worn.nrrd | awk -F '\t' '/^[0-9]/ { printf "%.12g", -$11 * 1e-10 }')" "$(column volume1 w)")"
refused "no hardness at all" 2 'want at least 1Pa' abrade --gap 1um --hardness 0 --friction 0 p.tsv
printf 'diameter\nnan\n' >nan.tsv
refused "a diameter that is missing" 1 'diameter is nan' abrade --gap 1um --hardness 2GPa --friction 0 nan.tsv
printf 'diameter\n10\n' >large.tsv
refused "a diameter of 10 m: a number without its unit" 1 'want metres' abrade --gap 1um --hardness 2GPa --friction 0 large.tsv
printf 'diameter\n-1e-6\n' >minus.tsv
refused "a negative diameter" 1 'want a positive number' abrade --gap 1um --hardness 2GPa --friction 0 minus.tsv
done_testing

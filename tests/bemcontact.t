#!/bin/sh
# bemcontact - options, streams, statuses; the physics is in tests/unit/contact.c
. "$(dirname "$0")/tap.sh"

key() { # key NAME FILE [RECORD]
	strings -n 3 "$2" | sed -n "s/^$1:=//p" | sed -n "${3:-1}p"
}

# Heights of a wavy surface, 32 x 24 points
perl -e 'for $y (0..23) { for $x (0..31) {
	print pack "d<", 1e-6 * cos($x * 0.39269908169872414) * sin($y * 0.2617993877991494 + 0.3)
	+ 2e-7 * sin($x * 1.9 + $y * 2.3) } }' >h.f64
solve="bemcontact --raw 32x24 --pixel 2um --estar 100GPa"

ok "a contact with a free boundary is solved" sh -c "$solve --pressure 200MPa h.f64 >free.nrrd"
near "the load is mean pressure times area" "$(key load free.nrrd)" 0.6144 1e-13
is "the record states that it converged" "$(key converged free.nrrd)" yes
near "the duality gap is within the tolerance" "$(key optimality_gap free.nrrd)" 0 1e-8
near "the indentation is the approach from first contact" "$(awk "BEGIN {
	print 1e6 * ($(key indentation free.nrrd) - ($(key approach free.nrrd))) }")" \
	"$(od -An -v -t f8 -w8 h.f64 | sort -g | tail -1 | awk '{ print 1e6 * $1 }')" 1e-5
$solve -F 0.6144N h.f64 >load.nrrd
is "the same load gives the same pressure" "$(key area load.nrrd)" "$(key area free.nrrd)"
$solve --approach "$(key approach free.nrrd)m" h.f64 >approach.nrrd
near "the same approach gives the same pressure" "$(key load approach.nrrd)" 0.6144 1e-6
bemcontact --raw 32x24 --pixel 2um -E 200GPa --poisson 0 --pressure 200MPa h.f64 >two.nrrd
is "two bodies of 200 GPa have a contact modulus of 100 GPa" "$(key approach two.nrrd)" "$(key approach free.nrrd)"
bemcontact --raw 32x24 --pixel 2um -E 150GPa,300GPa --poisson 0,0 --pressure 200MPa h.f64 >two.nrrd
near "bodies of 150 and 300 GPa have the same contact modulus" "$(key approach two.nrrd)" "$(key approach free.nrrd)" 1e-17

for m in "--solver pk" "--multiply mlms" "--multiply mlms --solver pk"; do
	# shellcheck disable=SC2086 # several words
	$solve --pressure 200MPa --tolerance 1e-10 $m h.f64 >other.nrrd
	near "--solver or --multiply $m gives the same pressure" "$(awk "BEGIN { print $(key energy other.nrrd) / $(key energy free.nrrd) - 1 }")" 0 2e-7
done

# A strip of a wave and noise at a given approach, where no load limits steps that grow
perl -e 'srand(3); for my $y (1 .. 40) { for my $x (1 .. 1000) { print pack "d<", 5e-7 * (cos($x * 0.006283185307179586) +
	0.5 * sqrt(-2 * log(1 - rand)) * cos(6.283185307179586 * rand)) } }' >strip.f64
for a in -0.2um 0.8um; do
	strip="bemcontact --raw 1000x40 --pixel 1um --estar 100GPa --approach $a strip.f64"
	$strip >strip.nrrd
	$strip --solver pk >other.nrrd
	near "a strip at an approach of $a: --solver pk gives the same load" "$(awk "BEGIN { print $(key load other.nrrd) / $(key load strip.nrrd) - 1 }")" 0 1e-6
done
# 12 and 14 iterations; 59 where the mean of a step is that of the longest wave, 28 where every cell
# starts under pressure
strip="bemcontact --raw 1000x40 --pixel 1um --estar 100GPa"
$strip --pressure 20MPa strip.f64 >strip.nrrd
$strip --approach "$(key approach strip.nrrd)m" strip.f64 >other.nrrd
ok "a given approach takes at most twice the iterations of the load" \
	[ "$(key iterations other.nrrd)" -le $((2 * $(key iterations strip.nrrd))) ]
near "both give the same load" "$(awk "BEGIN { print $(key load other.nrrd) / $(key load strip.nrrd) - 1 }")" 0 1e-6
$solve --pressure 200MPa --boundary periodic h.f64 >periodic.nrrd
near "a periodic surface carries the same load" "$(key load periodic.nrrd)" 0.6144 1e-13
ok "a periodic boundary gives another pressure" [ "$(key energy periodic.nrrd)" != "$(key energy free.nrrd)" ]
$solve --pressure 200MPa --hardness 300MPa h.f64 >capped.nrrd
is "no pressure exceeds the hardness" "$(records -o list --field pressure capped.nrrd | column max /dev/stdin)" 300000000

$solve --pressure 200MPa --fields gap,pressure h.f64 >some.nrrd
is "the requested fields are written" "$(key fields some.nrrd)" "pressure Pa, gap m"
$solve --pressure 200MPa --tolerance 1e-13 --fields height,pressure,displacement,gap h.f64 | records -o table |
	awk '!/^#/ && ++n > 1 { r = $7 - ($5 + $8); d = n == 2 ? r : d
	if (r - d > 1e-17 || d - r > 1e-17) bad = 1; if ($8 < -1e-12 || $6 < 0) bad = 1
	if ($6 > 0 && $8 > 1e-12) bad = 1 } END { print bad + 0, n - 1 }' >check
is "g = u - h - approach, p >= 0, g >= 0, p g = 0 hold in every cell" "$(cat check)" "0 768"

cat free.nrrd load.nrrd periodic.nrrd >three.nrrd
bemcontact --estar 100GPa --pressure 200MPa -S stats three.nrrd >again.nrrd
is "three records are read and three are written" "$(records -o count again.nrrd)" 3
is "the solver starts from the pressure of the records" "$(column warm_starts stats)" 3
is "two records need no further iteration" "$(key iterations again.nrrd 1),$(key iterations again.nrrd 2)" 0,0
bemcontact --estar 100GPa --pressure 200MPa -j 2 three.nrrd >threads.nrrd
same "two threads give the same bytes" again.nrrd threads.nrrd

sh -c "$(key cmd free.nrrd)" >replay.nrrd
same "the recorded command reproduces the stream" free.nrrd replay.nrrd

fails "not converged: status 3" 3 'record 1: not converged: optimality gap .* after 2 iterations' \
	sh -c "$solve --boundary periodic --pressure 200MPa --max-iterations 2 h.f64 >poor.nrrd"
is "the record states that it did not converge" "$(key converged poor.nrrd)" no
is "without load there is no pressure and no work" "$($solve --pressure 0Pa -S stats h.f64 >none.nrrd
	column transforms stats),$(key area none.nrrd)" 0,0
fails "layers of raw heights" 2 "raw 32x24x2: want NXxNY$" bemcontact --raw 32x24x2 --pixel 1um h.f64
fails "a tolerance that is none" 2 'tolerance 0.5: want .* to 0.1' bemcontact --estar 1GPa --pressure 1Pa --tolerance 0.5
fails "no load given" 2 'specify one of --load' bemcontact --estar 1GPa
fails "two loads given" 2 'specify only one of --load' bemcontact --estar 1GPa --pressure 1Pa -F 1N
roughgen -n 16 >new.nrrd
fails "no material" 2 'record 1 states no contact modulus: specify either --estar or --young' bemcontact --pressure 1kPa new.nrrd
bemcontact --pressure 10MPa --estar 100GPa --boundary periodic --hardness 1GPa new.nrrd >solved.nrrd
bemcontact --pressure 10MPa solved.nrrd >again.nrrd
is "a record keeps modulus, boundary and hardness of its last contact" "$? $(for k in estar boundary hardness; do key $k again.nrrd; done | tr '\n' ' ')" \
	"0 $(for k in estar boundary hardness; do key $k solved.nrrd; done | tr '\n' ' ')"
fails "both materials" 2 'either --estar or --young' bemcontact --pressure 1Pa --estar 1GPa -E 2GPa
fails "multi-level sums over a period" 2 'requires --boundary free' \
	bemcontact --pressure 1Pa --estar 1GPa --multiply mlms --boundary periodic
fails "unknown field" 2 "--fields sigma: want height|pressure" bemcontact --pressure 1Pa --estar 1GPa --fields gap,sigma
fails "unit of another quantity" 2 '--load' bemcontact -F 1MPa --estar 1GPa
fails "load above the hardness" 1 'h.f64: record 1: mean pressure 2e+08 Pa is not below' \
	$solve --pressure 200MPa --hardness 200MPa h.f64
fails "approach beyond full contact" 1 'beyond full contact' $solve --boundary periodic --approach 1mm h.f64
head -c 6000 h.f64 >short.f64
fails "heights cut short" 1 'record 1: want .* bytes, got 6000' $solve --pressure 1MPa short.f64
printf 'NRRD0004\ntype: double\nendian: little\nencoding: raw\ndimension: 3\nsizes: 1 2 1\nkinds: list domain domain\nspacings: 1 1 1\nfields:=pressure Pa\n\n1234567812345678' >bad.nrrd
fails "no heights" 1 "height" bemcontact --pressure 1Pa --estar 1GPa bad.nrrd
# Tables: a ball of radius 1 against the closed forms of Hertz
perl -e 'for $y (0 .. 95) { for $x (0 .. 95) {
	print pack "d<", -((($x - 47.3) / 96) ** 2 + (($y - 48) / 96) ** 2) / 2 } }' >ball.f64
ball="bemcontact --raw 96x96 --pixel 0.010416666666666666m --estar 1Pa --load 0.02N"
$ball --table curve.tsv --patches patches.tsv --sweep 5 --stats stats ball.f64 >ball.nrrd
is "each step of the load has a row" "$(column load curve.tsv | awk '{ printf "%.4f ", $1 }')" \
	"0.0040 0.0080 0.0120 0.0160 0.0200 "
near "the stiffness is 2 E* a" "$(column stiffness curve.tsv | tail -1)" 0.49324 2e-3
near "the approach of the last step is that of the record" \
	"$(column approach curve.tsv | tail -1)" "$(key approach ball.nrrd)" 1e-12
near "the approach agrees with Hertz in an earlier step" "$(column indentation curve.tsv | head -1)" 0.020801 2e-5
near "the area corrected for the perimeter agrees with Hertz" "$(column corrected_area curve.tsv | tail -1)" 0.19108 2e-3
near "the largest pressure agrees with Hertz" "$(column peak curve.tsv | tail -1)" 0.15701 2e-4
near "half of the cells have a pressure below p0 sqrt(1/2)" "$(column p50 curve.tsv | tail -1)" 0.11102 2e-3
is "the contact is one patch" "$(column patches curve.tsv | tail -1),$(column cells patches.tsv | wc -l)" "1,1"
near "the patch carries the load" "$(column load patches.tsv)" 0.02 1e-13
near "the centre of the patch is that of the ball" "$(column x patches.tsv)" 0.4979166666 1e-5
ok "the work of the stiffness is counted separately" [ "$(column stiffness_transforms stats | cut -d . -f 1)" -gt 0 ]
bemcontact --raw 96x96 --pixel 0.010416666666666666m --estar 1Pa --approach 40mm --sweep 2 \
	--table curve.tsv ball.f64 >/dev/null
near "--sweep with an approach takes equal steps from first contact" "$(column indentation curve.tsv | awk '
	{ r[NR] = $1 } END { print r[1] / r[2] }')" 0.5 1e-9
$ball --hardness 0.02001Pa --table curve.tsv ball.f64 >/dev/null
is "the stiffness is nan at the largest load of the hardness" "$(column stiffness curve.tsv)" nan
$solve --pressure 30GPa --boundary periodic --table curve.tsv h.f64 >/dev/null
is "a periodic surface in full contact is infinitely stiff" "$(column area curve.tsv),$(column stiffness curve.tsv)" 1,inf
$ball --table curve.tsv ball.f64 >/dev/null
sh -c "$(sed -n 's/^# cmd: //p' curve.tsv)" >again.tsv
same "the recorded command reproduces the table" curve.tsv again.tsv
# A coating of the same material has no effect, a thick one behaves like its material alone
layer="bemcontact --raw 32x24 --pixel 2um --boundary periodic --pressure 50MPa h.f64"
$layer --young 100GPa --poisson 0.3 --tolerance 1e-12 >bare.nrrd
$layer --young 100GPa --poisson 0.3 --tolerance 1e-12 --coating 3um --coating-young 100GPa >same.nrrd
near "a coating of the same material has no effect" "$(awk "BEGIN {
	print $(key approach same.nrrd) / $(key approach bare.nrrd) - 1 }")" 0 1e-10
$layer --young 100GPa,1e30Pa --poisson 0.25 --tolerance 1e-12 >bare.nrrd
$layer --young 1GPa,1e30Pa --coating 1mm --coating-young 100GPa --coating-poisson 0.25 --tolerance 1e-12 >thick.nrrd
near "a thick coating behaves like a half-space" "$(awk "BEGIN {
	print $(key approach thick.nrrd) / $(key approach bare.nrrd) - 1 }")" 0 1e-10
is "the record of a coated body has no contact modulus" "$(key estar thick.nrrd)" nan
$layer --young 1000GPa --poisson 0.3 --coating 3um --coating-young 1GPa 2>err >soft.nrrd
is "pressures beyond a tenth of the modulus of a soft layer are doubted" "$(grep -c 'contact modulus of 1.1 GPa: no solid is elastic' err)" 1
$layer --young 1000GPa --poisson 0.3 --coating 3um --coating-young 100GPa 2>err >hard.nrrd
is "those of a stiff one are not" "$(cat err)" ''
fails "the material of no coating" 2 '\--coating-young requires --coating' \
	bemcontact --estar 1GPa --pressure 1Pa --coating-young 1GPa
fails "steps of load that no table shows" 2 '\--sweep requires --table' bemcontact --estar 1GPa --pressure 1Pa --sweep 3
fails "a coating on a free surface" 2 'requires --boundary periodic' \
	bemcontact --pressure 1Pa --young 1GPa --coating 1um --coating-young 2GPa
fails "a coating of no material" 2 'requires --young and --coating-young' \
	bemcontact --pressure 1Pa --estar 1GPa --coating 1um
# A record that is pressed again keeps no key of the earlier contact.
$solve --pressure 200MPa --boundary periodic --hardness 400MPa --unload 1 --table curve.tsv h.f64 >flowed.nrrd
bemcontact --pressure 200MPa --estar 100GPa --hardness 0 flowed.nrrd >again.nrrd
is "a record pressed again without a hardness states none" \
	"$(key hardness again.nrrd)$(key plastic_area again.nrrd)$(key flow_depth again.nrrd)" ""
is "a record pressed again has the boundary of before" "$(key boundary again.nrrd)" periodic
bemcontact --pressure 200MPa --estar 100GPa same.nrrd >again.nrrd
is "a record pressed again without a coating states none" "$(key coating again.nrrd)" ""
fails "multi-level sums of a periodic record" 2 'the record is periodic' \
	bemcontact --pressure 1Pa --estar 1GPa --multiply mlms periodic.nrrd
# Partial slip: Cattaneo and Mindlin are in tests/unit/slip.c
slip="bemcontact --raw 96x96 --pixel 0.010416666666666666m --young 1.82GPa --load 0.02GN -u 0.5"
$slip --tangential 0.005GN --fields shear,pressure ball.f64 >slip.nrrd
near "the sum of the shear is the tangential load" "$(records -o text --field shear slip.nrrd | tr '\t' '\n' | awk '
	/^[-0-9]/ { s += $1 } END { print s / 96 / 96 / 1e9 }')" 0.005 1e-10
near "half of the friction moves a ball by 1 - 0.5^(2/3) of the displacement at full friction" "$(awk "BEGIN {
	print $(key tangential_displacement slip.nrrd) / (0.5 * 1.7 / 1.4 * $(key indentation slip.nrrd)) }")" 0.370039 2e-4
ok "the stick area is smaller than the contact area" [ "$(awk "BEGIN { print ($(key stick_area slip.nrrd) < $(key area slip.nrrd)) }")" = 1 ]
# Products of decimal numbers that are rounded up and down.
for pair in '0.02GN 0.5 0.01' '0.007GN 0.7 0.0049' '0.013GN 0.3 0.0039' '0.011GN 0.1 0.0011'; do
	# shellcheck disable=SC2086 # words
	set -- $pair
	$slip --load "$1" -u "$2" --tangential "$3GN" ball.f64 >slip.nrrd
	is "all of the contact slips at $2 of $1" "$? $(key stick_area slip.nrrd)" "0 0"
done
fails "a thousandth of a billionth more than friction bears" 1 'friction bears' $slip --tangential 0.010000000000011GN ball.f64
fails "more than friction bears" 1 'friction bears 1e+07 N' $slip --tangential 0.02GN ball.f64
# Plane strain: the compliances are equal; antiplane shear: 1 / (1 - nu).
perl -e 'print pack "d<*", map { 1e-6 * cos($_ * 0.0245436926) } 0..255' >slide.f64
for g in 256x1 1x256; do
	bemcontact --raw $g --pixel 1um -E 210GPa --boundary periodic --pressure 100MPa -u 0.3 --tangential 7.68mN slide.f64 >slip.nrrd
	key tangential_displacement slip.nrrd
done >moved
near "ridges along the tangential load move farther than those across it" \
	"$(awk '{ d[NR] = $1 } END { printf "%.9f", d[2] / d[1] }' moved)" 1.4285714 1e-6
near "ridges that slide across have moved mu times the indentation" \
	"$(awk -v d="$(key indentation slip.nrrd)" 'NR == 1 { print $1 / (0.3 * d) }' moved)" 1 1e-9
fails "shear without a tangential load" 2 'requires --tangential' \
	bemcontact --pressure 1Pa --estar 1GPa --fields shear
fails "a tangential load without friction" 2 'need one another' \
	bemcontact --pressure 1Pa --young 1GPa --tangential 1N
fails "partial slip of unknown bodies" 2 'want the materials' \
	bemcontact --pressure 1Pa --estar 1GPa --tangential 1N -u 0.1
fails "partial slip of bodies that couple" 2 'same (1 - 2 nu)' \
	bemcontact --pressure 1Pa --young 1GPa,2GPa --tangential 1N -u 0.1
fails "partial slip where material flows" 2 'want no --hardness' \
	bemcontact --pressure 1Pa --young 1GPa --tangential 1N -u 0.1 --hardness 1GPa
fails "partial slip of a coated body" 2 'tangential excludes --coating' bemcontact --pressure 1Pa --young 1GPa \
	--tangential 1N -u 0.1 --boundary periodic --coating 1um --coating-young 2GPa

# Unloading: stiffness and energy are in tests/unit/slip.c
$ball --hardness 0.12Pa --sweep 2 --unload 4 --table curve.tsv --fields height,residual,pressure ball.f64 >flowed.nrrd
is "each step of loading and unloading has a row" "$(column load curve.tsv | awk '{ printf "%.4f ", $1 }')" \
	"0.0100 0.0200 0.0150 0.0100 0.0050 0.0000 "
ok "the bodies separate at a larger approach than at first contact" [ "$(column approach curve.tsv | awk '
	{ a[NR] = $1 } END { print (a[4] > a[1] && a[6] > 0) }')" = 1 ]
is "there is no plastic flow during unloading" "$(column plastic_area curve.tsv | tail -n +3 | tr '\n' ' ')" "0 0 0 0 "
for f in height residual; do
	records -o text --field $f flowed.nrrd | tr '\t' '\n' | grep '^[-0-9]' >$f.txt
done
near "the residual depth is the plastic depth" "$(key flow_depth flowed.nrrd)" "$(paste height.txt residual.txt |
	awk '{ d = $1 - $2; if (d > m) m = d } END { print m }')" 1e-7
fails "unloading without a table" 2 'unload requires --table' bemcontact --pressure 1Pa --estar 1GPa --unload 3
# A ball of 1 mm at a place of a free grid of 41 x 31 cells of 2 by 3 um, from X to Y cells.
ball() {
	perl -e 'for my $y (0 .. 30) { for my $x (0 .. 40) {
		print pack "d<", -(($x - $ARGV[0])**2 * 4e-12 + ($y - $ARGV[1])**2 * 9e-12) / 2e-3 } }' "$1" "$2" >ball.f64
	shift 2
	bemcontact --raw 41x31 --pixel 2umx3um --estar 100GPa --load 0.2N "$@" ball.f64 >ball.nrrd 2>err
}
status=0
ball 20 15 --table ball.tsv || status=$?
is "a contact within a free grid has no load at its edge" "$status $(key edge_load ball.nrrd) $(column edge_load ball.tsv) $(cat err)" "0 0 0 "
ball 37 15 --table ball.tsv || status=$?
is "load at the edge gives a warning" "$status $(grep -c 'ball.f64: 1 contacts .* cells, worst [0-9]* % (.*): use a larger area' err)" "0 1"
is "the record and the table state it" "$(key edge_load ball.nrrd)" "$(column edge_load ball.tsv)"
ok "it is between 5 and 50 %" awk -v e="$(key edge_load ball.nrrd)" 'BEGIN { exit !(e > 0.05 && e < 0.5) }'
ball 60 15 || status=$?
is "status 3 where the edge carries most of the load" "$status $(grep -c 'worst 100 %' err)" "3 1"
status=0
ball 60 15 --boundary periodic || status=$?
is "a periodic surface has no edge" "$status $(key edge_load ball.nrrd) $(cat err)" "0 0 "
head -c 10168 /dev/zero >flat.f64
bemcontact --raw 41x31 --pixel 1um --boundary periodic --estar 100GPa --pressure 1MPa flat.f64 2>err >flat.nrrd || status=$?
is "nor has a flat one in full contact" "$status $(key area flat.nrrd) $(key edge_load flat.nrrd) $(cat err)" "0 1 0 "
done_testing

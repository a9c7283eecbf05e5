#!/bin/sh
# debrisgen: a sliding pair of rough bodies, each worn by its own yield or by Archard's law
. "$(dirname "$0")/tap.sh"

rows() { awk '!/^#/ && !/^realisation/' "$1"; }
total() { column "$1" "$2" | awk '{ s += $1 } END { printf "%.17g", s }'; }
mean() { records "$1" | awk -v n="${2:-1}" '$3 == "height" && ++k == n { print $11 }'; }
ratio() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.17g", a / b }'; }

flat="roughgen --points 48 --length 0.5mm --sq 0"
$flat >flat.nrrd
roughgen --points 48 --length 0.5mm --sq 0.4um --corr 40um --seed 1 >a.nrrd
roughgen --points 48 --length 0.5mm --sq 0.4um --corr 40um --seed 2 >b.nrrd
press="--young 210GPa --pressure 20MPa --boundary periodic"
wear="debrisgen --yield 355MPa --friction 0.3 $press"
bemcontact $press a.nrrd >start.nrrd

# Particles and surfaces are as doubtful as the counterface.
printf '# doubtful: bad balls\ndiameter\n1e-9\n' |
	abrade --gap 1um --hardness 2GPa --friction 0.1 --motion groove --surface flat.nrrd >poor.nrrd 2>err
$wear --steps 2 --counterface poor.nrrd --slide 0.125mm --counter-surface other.nrrd start.nrrd >poor 2>err
is "what a doubtful counterface wears is doubtful" \
	"$? $(grep -c '^# doubtful: realisation 0: .*bad balls' poor) $(grep -c 'poor.nrrd: doubtful by its own account: bad balls' err) $(
		strings other.nrrd | grep -c '^doubtful:=.*bad balls')" "3 1 1 2"
# A flat counterface changes nothing, wherever it slides.
$wear --steps 2 --summary none.tsv start.nrrd >none 2>err
$wear --steps 2 --counterface flat.nrrd --slide 0.125mm --summary flat.tsv start.nrrd >flat 2>err
near "a flat counterface gives the volume of two steps without one" \
	"$(ratio "$(total volume flat.tsv)" "$(total volume none.tsv)")" 1 1e-5
is "a flat counterface gives as many particles as none" "$(rows flat | wc -l)" "$(rows none | wc -l)"

# It goes round: whole sides bring it back, and part of a side does not.
for d in 0.5mm 0 0.125mm; do
	$wear --steps 2 --counterface b.nrrd --slide $d --amplification 2 --summary s.tsv a.nrrd >p 2>err
	total volume s.tsv >volume.$d
done
is "sliding by the side of the grid changes nothing" "$(cat volume.0.5mm)" "$(cat volume.0)"
ok "sliding by a quarter of the side changes the contact" \
	awk -v a="$(cat volume.0.125mm)" -v b="$(cat volume.0)" 'BEGIN { d = a / b - 1; exit !(d * d > 1e-4) }'
near "distances are sliding distances times the amplification" "$(column distance s.tsv | tail -1)" 5e-4 1e-18

# Both are worn, each in its own frame, and heights lose what the table says.
$wear --steps 3 --counterface b.nrrd --slide 0.125mm --wears both --summary s.tsv --surface wa.nrrd \
	--counter-surface wb.nrrd a.nrrd >p 2>err
near "the first body loses its volume" "$(echo "$(mean a.nrrd) $(mean wa.nrrd 3)" |
	awk '{ printf "%.12g", ($1 - $2) * 0.25e-6 * 1e15 }')" "$(ratio "$(total volume_first s.tsv)" 1e-15)" 1e-4
near "the second body loses its volume" "$(echo "$(mean b.nrrd) $(mean wb.nrrd 3)" |
	awk '{ printf "%.12g", ($1 - $2) * 0.25e-6 * 1e15 }')" "$(ratio "$(total volume_second s.tsv)" 1e-15)" 1e-4
for body in first:1 second:2; do
	near "particles of the ${body%:*} body have the volume it lost" \
		"$(rows p | awk -v b="${body#*:}" '$3 == b { v += $6 } END { printf "%.12g", v * 1e15 }')" \
		"$(ratio "$(total volume_${body%:*} s.tsv)" 1e-15)" 1e-8
done
near "the volume is the sum for both bodies" "$(total volume s.tsv)" \
	"$(echo "$(total volume_first s.tsv) $(total volume_second s.tsv)" | awk '{ printf "%.17g", $1 + $2 }')" 1e-24
records --pick 3 -o nrrd wb.nrrd >wb2.nrrd
near "a worn counterface is valid input" "$(records --pick 3 -o nrrd wa.nrrd |
	$wear --counterface wb2.nrrd --slide 0.125mm --summary t.tsv 2>err >p; column step t.tsv)" 4 0

# Without friction the bodies are alike: they change places, and so do their losses.  Each
# yields by its own strength.
alike="debrisgen --yield 200MPa --removal potential $press --wears both --slide 0"
$alike --counterface b.nrrd --summary ab.tsv a.nrrd >p 2>err
$alike --counterface a.nrrd --summary ba.tsv b.nrrd >p 2>err
near "exchanging the bodies exchanges their losses" \
	"$(ratio "$(total volume_first ab.tsv)" "$(total volume_second ba.tsv)")" 1 1e-9
debrisgen --yield 200MPa,400MPa --removal potential $press --wears both --slide 0 \
	--counterface b.nrrd --summary s.tsv a.nrrd >p 2>err
is "the first body loses the volume of its own yield stress" "$(total volume_first s.tsv)" "$(total volume_first ab.tsv)"
ok "the second body, twice as strong, loses less" awk -v a="$(total volume_second s.tsv)" \
	-v b="$(total volume_second ab.tsv)" 'BEGIN { exit !(a > 0 && a < 0.6 * b) }'

# Fresh: a window over a surface that is longer.
roughgen --points 120x48 --length 1.25mmx0.5mm --sq 0.4um --corr 40um --seed 3 >long.nrrd
fresh="$wear --counterface long.nrrd --renew fresh --slide 0.25mm"
$fresh --steps 4 --wears second --summary s.tsv --counter-surface wl.nrrd a.nrrd >p 2>err
near "--renew fresh: the long surface loses the volume, and the first body none" \
	"$(echo "$(mean long.nrrd) $(mean wl.nrrd 4)" | awk '{ printf "%.12g", ($1 - $2) * 1.25e-3 * 0.5e-3 * 1e15 }')" \
	"$(ratio "$(total volume s.tsv)" 1e-15)" 1e-4
fails "a fresh surface that ends before the last step" 1 "end before step 5" $fresh --steps 5 a.nrrd

# Archard's coefficient: volume times hardness over load and distance, its mean over the
# steps and their interval.
near "the wear coefficient is V H / (F s)" "$(column wear_coefficient s.tsv | head -1)" \
	"$(column volume s.tsv | awk 'NR == 1 { printf "%.17g", $1 * 3 * 355e6 / (20e6 * 0.25e-6 * 0.25e-3) }')" 1e-12
column wear_coefficient s.tsv | awk '{ s += $1; q[NR] = $1 } END { m = s / NR
	for (i = 1; i <= NR; i++) v += (q[i] - m) ^ 2
	k = exp(3.18244630528 * sqrt(v / (NR - 1) / NR) / m)
	printf "%.9g\n%.9g\n%.9g\n", m, m / k, m * k }' >want
is "the mean over four steps, and the 95 % interval of its logarithm by Student" \
	"$(for c in mean low high; do column wear_coefficient_$c s.tsv | tail -1; done |
	awk '{ printf "%.9g\n", $1 }')" "$(cat want)"
is "one step has no interval" "$(column wear_coefficient_low s.tsv | head -1)" nan

# Archard's law: k p ds.
archard="debrisgen --law archard $press"
$archard --wear-rate 2e-15,1e-15 --wears both --counterface b.nrrd --slide 0.125mm --steps 3 \
	--summary s.tsv --surface wa.nrrd a.nrrd >p 2>err
near "Archard: the first body loses V = k F s" "$(ratio "$(total volume_first s.tsv)" \
	"$(awk 'BEGIN { printf "%.17g", 2e-15 * 20e6 * 0.25e-6 * 3 * 0.125e-3 }')")" 1 1e-12
near "Archard: the second body loses volume by its own rate" \
	"$(ratio "$(total volume_second s.tsv)" "$(total volume_first s.tsv)")" 0.5 1e-12
is "Archard: there are no particles" "$(rows p)" ""

# A ball on a flat wears down to a flat of radius (4 R V / pi)^(1/4), plus what the edge still
# gives way: ratios of an independent calculation, 1.071 and 1.030 after 40 and 120 parts.
roughgen --points 80 --length 1mm --sq 0 --crown 25um |
	bemcontact --load 50N --estar 115.4GPa >ball.nrrd
for v in 40:1.071 120:1.030; do
	distance=$(awk -v n="${v%:*}" 'BEGIN { print n * 0.8 * 4 * 12.5e-6 / (sqrt(2) * 3.14159265 * 115.4e9) / 1e-13 }')
	debrisgen --law archard --wear-rate 1e-13 --estar 115.4GPa --load 50N \
		--amplification "$(awk -v s="$distance" 'BEGIN { print s / 1e-3 }')" --summary s.tsv \
		--surface w.nrrd ball.nrrd >p 2>err
	records -o table w.nrrd | awk -F '\t' '!/^[#r]/ && $NF > 0 { n++ } END { print n }' >cells
	near "worn ball: the radius of contact is (4 R V / pi)^(1/4) after ${v%:*} parts" \
		"$(awk -v v="$(total volume s.tsv)" '{ print sqrt($1 * 12.5e-6 ^ 2 / 3.14159265) / (4 * 0.01 * v / 3.14159265) ^ 0.25 }' cells)" \
		"${v#*:}" 0.02
done
# In other parts of the distance other cells wear most.
$archard --wear-rate 1e-12 --amplification 1 --summary s.tsv --surface w.nrrd start.nrrd >p
for f in start w; do
	records -o text --field height $f.nrrd | tr '\t' '\n' | grep '^[-0-9]' >$f.txt
done
near "Archard: the depth of many parts is what the deepest cell has lost, um" "$(column depth s.tsv | awk '{ print 1e6 * $1 }')" \
	"$(paste start.txt w.txt | awk '{ d = 1e6 * ($1 - $2); if (d > m) m = d } END { print m }')" 1e-5

# Worn into pits the pair leaves the theory of small slopes.
$wear --steps 6 --counterface b.nrrd --slide 0.125mm --wears both a.nrrd 2>told >p
ok "slopes beyond the theory give a warning" grep -q "rms slope .* above 0.2, the limit .* --hardness" told

# A ball of 5 mm is pressed 60 um from the border of a free grid, nearly the radius of the contact.
# Friction drags the first body towards +x and the second towards -x, so the near border cuts
# off the particle of the second one, the far border that of the first.
ball() { # SIDE: of the grid
	perl -e 'binmode STDOUT; my $d = 0.5e-3 / 48;
		print "NRRD0004\ntype: double\nendian: little\nencoding: raw\ndimension: 3\n",
			"sizes: 1 48 48\nspacings: 1 $d $d\nfields:=height m\n\n";
		for my $y (0 .. 47) { for my $x (0 .. 47) { my $from = $ARGV[0] eq "far" ? 47 - $x : $x;
			print pack "d<", -(($d * ($from + 0.5) - 60e-6) ** 2 + ($d * ($y - 23.5)) ** 2) / 10e-3 } }' "$1"
}
pressed="--friction 0.3 --young 210GPa --load 10N --boundary free --counterface flat.nrrd --slide 0"
for side in near far; do
	ball $side >side.nrrd
	for worn in first second both; do
		case $side,$worn in
		near,first | far,second)
			# shellcheck disable=SC2086 # words
			debrisgen --yield 355MPa --wears $worn $pressed side.nrrd >p 2>err
			is "the $side border leaves the $worn body whole" "$? $(rows p | wc -l) $(cat err)" "0 1 "
			;;
		*)
			# shellcheck disable=SC2086
			fails "the $side border cuts off wear of $worn" 3 'cut off at the border .* up to 21 % more volume' \
				debrisgen --yield 355MPa --wears $worn $pressed side.nrrd
			;;
		esac
	done
done
# By Archard's law the bodies wear where they are loaded, and nowhere else.
# shellcheck disable=SC2086
debrisgen --law archard --wear-rate 1e-15 $pressed side.nrrd >p 2>err
is "Archard's law cuts nothing off" "$? $(cat err)" "0 "

fails "a slide that is no whole number of cells" 2 "want a multiple of the cell size" $wear --counterface b.nrrd --slide 7um a.nrrd
fails "a worn counterface without a counterface" 2 '\--counter-surface requires --counterface' \
	$wear --counter-surface worn.nrrd start.nrrd
fails "a slide without a counterface" 2 "requires --counterface" $wear --slide 0.125mm a.nrrd
fails "the wear of a missing second body" 2 "requires --counterface" $wear --wears both start.nrrd
cat b.nrrd b.nrrd >two.nrrd
roughgen --points 48 --length 0.5mm --sq 0.4um --corr 40um --count 3 >three.nrrd
fails "two counterfaces for three surfaces" 1 "2 records are fewer" sh -c "$wear --counterface two.nrrd three.nrrd >p"
fails "a counterface of another size" 1 "120x48 cells over 48x48: want as many" $wear --counterface long.nrrd a.nrrd
roughgen --points 48 --length 1mm --sq 0.4um >wide.nrrd
fails "a counterface of another spacing" 1 "spacings of" $wear --counterface wide.nrrd a.nrrd
fails "Archard's law without a rate" 2 "requires --wear-rate" debrisgen --law archard start.nrrd
fails "a rate that takes days" 2 "would take .* contacts" debrisgen --law archard --wear-rate 1e-5 start.nrrd
fails "a rate without Archard's law" 2 "requires --law archard" $wear --wear-rate 1e-15 start.nrrd
fails "no load" 2 "carries no load" debrisgen --yield 355MPa --young 210GPa --counterface b.nrrd a.nrrd
done_testing

#!/bin/sh
# debrisgen: removal sets, steps, worn surfaces, stress fields, refusals
. "$(dirname "$0")/tap.sh"

# rows FILE: a table without its comments and header
rows() {
	awk '!/^#/ && !/^realisation/' "$1"
}

summary() {
	column "$1" summary.tsv
}

# lost: cells of 7.8125 um that the volume of the summary is
lost() {
	summary volume | awk '{ printf "%.0f", $1 / 7.8125e-6 ^ 3 }'
}

# A paraboloid of radius 5 mm on 1 mm x 1 mm: smooth, so the counts hang on nothing but
# pressure, stress and rule.  Cells of the thesis were counted with independent code for
# cells of constant pressure: 21884 by columns, 21868 and 21910 for a yield 0.1 % off, 30074
# in all, 21986 by the middle.
roughgen -n 128 -L 1mm --sq 0 --crown 50um | bemcontact -F 50N -E 210GPa >ball.nrrd
wear="debrisgen -Y 355MPa -u 0.3"
cube="--depth-step 7.8125um"
near "ball: the largest pressure is that of the reference solution" "$(records ball.nrrd | awk '$3 == "pressure" { print $12 }')" 1725.5455e6 1e3
$wear $cube --summary summary.tsv -S stats.tsv ball.nrrd >t.tsv
near "ball: the column rule removes the reference number of cells" "$(lost)" 21884 20
near "ball: the particle has the worn volume" "$(column volume t.tsv)" "$(summary volume)" 1e-24
near "ball: 31 layers fail" "$(summary depth)" 242.1875e-6 1e-12
is "ball: the number of layers searched is counted" "$(column layers stats.tsv)" 32
near "ball: the diameter is that of the sphere of equal volume" "$(column diameter t.tsv)" 271.1228108e-6 0.1e-6
near "ball: friction shifts the particle towards the front" "$(column x t.tsv)" 503.367186e-6 0.05e-6
near "ball: the particle is centred across the sliding direction" "$(column y t.tsv)" 500e-6 1e-12
$wear $cube --removal potential --summary summary.tsv ball.nrrd >t.tsv
near "ball: the potential rule removes the reference number of cells" "$(lost)" 30074 20
$wear $cube --layer mid --summary summary.tsv ball.nrrd >t.tsv
near "ball: the stress at mid height removes the reference number of cells" "$(lost)" 21986 100
# One part in a thousand of yield: no more than the outermost cells.
debrisgen -Y 355.355MPa -u 0.3 $cube --summary summary.tsv ball.nrrd >t.tsv
near "ball: a yield stress 0.1 % higher removes fewer cells" "$(lost)" 21868 20
debrisgen -Y 354.645MPa -u 0.3 $cube --summary summary.tsv ball.nrrd >t.tsv
near "ball: a yield stress 0.1 % lower removes more cells" "$(lost)" 21910 100
debrisgen -Y 355MPa $cube --layer mid --removal potential --summary summary.tsv ball.nrrd >t.tsv
near "ball without friction: the potential rule at mid height removes the reference number of cells" "$(lost)" 27400 20

# The depth that is interpolated is that of cells of a sixteenth of the spacing, in half as
# many layers as cells of the spacing need; friction-free, the surface loses next to nothing.
roughgen -n 48 -L 1mm --sq 0 --crown 50um | bemcontact -F 50N -E 210GPa >small.nrrd
$wear --depth-step 1.3um --summary summary.tsv small.nrrd >t.tsv
fine=$(summary volume)
$wear --summary summary.tsv small.nrrd >t.tsv
near "ball: the interpolated depth is that of fine cells" \
	"$(summary volume | awk -v f="$fine" '{ print $1 / f }')" 1 0.005
$wear --summary summary.tsv -S stats.tsv ball.nrrd >ball.tsv
is "ball: the number of depths searched is small" "$(column layers stats.tsv)" 18
near "ball: the particle with interpolated depth has the worn volume" \
	"$(column volume ball.tsv | awk -v v="$(summary volume)" '{ print $1 / v }')" 1 1e-14
near "ball: the diameter belongs to the volume" "$(column diameter ball.tsv)" \
	"$(summary volume | awk '{ printf "%.17g", (6 * $1 / 3.14159265358979324) ^ (1 / 3) }')" 1e-17
$wear --full-sum --summary full.tsv ball.nrrd >full
near "ball: the full sum removes the same volume" \
	"$(column volume full.tsv | awk -v v="$(summary volume)" '{ print $1 / v }')" 1 1e-5
debrisgen -Y 355MPa -u 0.3 --criterion tresca --summary summary.tsv ball.nrrd >t.tsv
mises=$(column volume full.tsv)
debrisgen -Y 307.439MPa -u 0.3 --summary low.tsv ball.nrrd >t.tsv
ok "ball: Tresca removes more than von Mises and less than von Mises at sqrt(3)/2 of the yield stress" \
	awk -v t="$(summary volume)" -v m="$mises" -v l="$(column volume low.tsv)" \
	'BEGIN { exit !(t > 1.02 * m && t < l) }'
debrisgen -Y 355MPa --summary summary.tsv ball.nrrd >t.tsv
ok "ball without friction: the surface loses less than 1e-3 of the volume with friction" \
	awk -v v="$(summary volume)" -v m="$mises" 'BEGIN { exit !(v < 1e-3 * m) }'

# A point load F fails the volume c (F / yield)^1.5, c = 0.26692 without friction and
# 0.28665 with 0.3 (by quadrature of Boussinesq's and Cerruti's solutions); depths that are
# interpolated see it within 0.6 %.
roughgen -n 129 -L 129um --sq 0 --crown 1mm | bemcontact -F 1mN --estar 1000TPa >point.nrrd
for c in 0:0.26692 0.3:0.28665; do
	debrisgen -Y 169.5kPa -u ${c%:*} --removal potential --summary summary.tsv point.nrrd >t.tsv
	near "point load, friction ${c%:*}: the failed volume is that of the closed solution" \
		"$(summary volume | awk '{ print $1 / (1e-3 / 169.5e3) ^ 1.5 }')" ${c#*:} 0.0016
done

# Shear along y is shear along x, turned.
$wear --shear y ball.nrrd >t.tsv
near "shear along y rotates the particle" "$(column y t.tsv)" "$(column x ball.tsv)" 1e-15

# The same step on coarser grids: what they give is what scenes of their own give, and the
# extrapolation follows from the three volumes.  Two contacts solved to 1e-8 differ by some 1e-9 in volume.
roughgen -n 64 -L 0.5mm -q 0.4um -l 60um --crown 4um -s 5 | bemcontact -F 20N -E 210GPa >grid.nrrd
$wear --richardson --summary summary.tsv grid.nrrd >t.tsv
roughgen --resample 32 grid.nrrd | bemcontact -F 20N -E 210GPa | $wear --summary half.tsv >t.tsv
near "--richardson states the volume at twice the spacing" "$(column volume half.tsv)" "$(summary volume_2h)" 1e-21
is "--richardson states the particles at twice the spacing" "$(column particles half.tsv)" "$(summary particles_2h)"
# Cells of the correlation length: the volumes of some surfaces say nothing of their error.
roughgen -n 32 -L 0.5mm -q 0.4um -l 16um --crown 4um -s 1 -c 6 | bemcontact -F 10N -E 210GPa >coarse.nrrd
$wear --richardson --summary summary.tsv coarse.nrrd >t.tsv 2>said
awk -F '\t' '/^#/ { next } !n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
	$c["order"] == "nan" { none++; bad += $c["volume_extrapolated"] != "nan" || $c["volume_grid_error"] != "nan"; next }
	{ some++; v = $c["volume"]; half = $c["volume_2h"]; p = log(($c["volume_4h"] - half) / (half - v)) / log(2)
		w = v - (half - v) / (2 ^ p - 1); d = $c["volume_grid_error"]; d -= w > v ? w - v : v - w
		bad += (p - $c["order"]) ^ 2 > 1e-12 || ($c["volume_extrapolated"] / w - 1) ^ 2 > 1e-12 || (d / w) ^ 2 > 1e-12 }
	END { print (none > 0), (some > 0), bad + 0 }' summary.tsv >orders
is "the volume is extrapolated with the order of the three volumes, or not without" "$(cat orders)" "1 1 0"
ok "and a warning says so" grep -q 'no order of convergence' said
fails "--richardson on a grid that cannot be halved twice" 2 "want multiples of 4" \
	$wear --richardson point.nrrd

# Steps inside and one after another.
roughgen -n 64 -L 0.5mm -q 8um -l 50um --crown 32um -c 2 >rough.nrrd
contact="bemcontact -F 20N -E 210GPa"
$contact rough.nrrd >start.nrrd
$wear --steps 3 -F 20N -E 210GPa --summary all.tsv --surface all.nrrd start.nrrd >inside.tsv 2>warning
$wear --surface worn1.nrrd --summary s1.tsv start.nrrd >1.tsv
$contact worn1.nrrd | $wear --surface worn2.nrrd --summary s2.tsv >2.tsv
$contact worn2.nrrd | $wear --surface worn3.nrrd --summary s3.tsv >3.tsv 2>warning
cat 1.tsv 2.tsv 3.tsv >loop.tsv
rows inside.tsv | sort -s -n -k1,2 >a
rows loop.tsv | sort -s -n -k1,2 >b
ok "three steps produce particles" test "$(wc -l <a)" -gt 6
same "a loop of bemcontact and debrisgen gives the same particles" a b
cat s1.tsv s2.tsv s3.tsv >s.tsv
# The coefficient's mean and interval are those of the steps of one run.
rows all.tsv | cut -f 1-17 | sort -s -n -k1,2 >a
rows s.tsv | cut -f 1-17 | sort -s -n -k1,2 >b
same "the loop gives the same summary" a b
records --pick 3 -o text all.nrrd >a
records --pick 1 -o text worn3.nrrd >b
same "the loop gives the same worn surface" a b
records -o nrrd start.nrrd >again.nrrd
$wear --steps 3 -E 210GPa --summary again.tsv again.nrrd >t.tsv 2>warning
# Its mean pressure has been rounded: contacts are the same within their tolerance.
column volume again.tsv >a
column volume all.tsv | paste a - >volumes
ok "the load is that of the input" awk '{ d = $1 / $2 - 1; if (d * d > 1e-10) exit 1 } END { exit NR != 6 }' volumes
$wear --steps 3 -F 20N -E 210GPa -j 2 start.nrrd >t.tsv 2>warning
same "the number of threads does not change the result" t.tsv inside.tsv
$wear --steps 3 -F 20N -E 210GPa --solver pk --tolerance 1e-12 --summary pk.tsv start.nrrd >t.tsv 2>warning
$wear --steps 3 -F 20N -E 210GPa --tolerance 1e-12 --summary bccg.tsv start.nrrd >t.tsv 2>warning
near "both contact solvers give the same worn volume" \
	"$(column volume pk.tsv | awk '{ s += 1e12 * $1 } END { print s }')" \
	"$(column volume bccg.tsv | awk '{ s += 1e12 * $1 } END { print s }')" 1e-9
records --pick 2 -o nrrd start.nrrd | $wear --steps 3 -F 20N -E 210GPa >t.tsv 2>warning
rows inside.tsv | awk '$1 == 1' >a
rows t.tsv >b
same "previous records do not change the result" a b

# The commands in the headers, one for each surface, rebuild what they stand in.
replay() {
	grep -a "^$2" "$1" | sed "s/^$2//" >cmds
	while read -r line; do
		# through a pipe: /dev/fd/3 would open a file anew
		sh -c "$line" 2>warning </dev/null | cat
	done <cmds | records --join
}
replay worn2.nrrd cmd:= >a
same "the commands of worn surfaces reproduce them" a worn2.nrrd
replay s3.tsv "# cmd: " >t.tsv
rows t.tsv >a
rows s3.tsv >b
same "the command of a summary reproduces it" a b
replay 3.tsv "# cmd: " >t.tsv
rows t.tsv >a
rows 3.tsv >b
same "the command of the particles reproduces them" a b

# The worn surface is the old one less the removed volume.
mean() { records "$1" | awk '$2 == 0 && $3 == "height" { print $11; exit }'; }
near "the volume is the loss of the surface" \
	"$(echo "$(mean start.nrrd) $(mean worn1.nrrd)" | awk '{ print ($1 - $2) * 0.25e-6 * 1e12 }')" \
	"$(column volume s1.tsv | awk '{ print $1 * 1e12; exit }')" 1e-9
is "the distance includes the amplification" \
	"$(debrisgen -Y 355MPa --amplification 0.72 --summary /dev/fd/3 start.nrrd 3>&1 >t.tsv | awk '!/^[#r]/ { print $3; exit }')" \
	"0.00035999999999999997"

# A step slides by the side along the shear.
roughgen -n 32x64 -L 0.2mmx0.6mm -q 8um -l 50um | bemcontact -F 5N -E 210GPa >oblong.nrrd
for side in x:0.0002 y:0.0006; do
	$wear --shear ${side%:*} --summary summary.tsv oblong.nrrd >t.tsv 2>warning
	near "shear along ${side%:*}: the distance is that side of the grid" "$(summary distance)" ${side#*:} 1e-18
done

# What the summary says of particles and of the surface they left.
near "the mean diameter is that of several particles" "$(column mean_diameter s1.tsv | head -1)" \
	"$(awk '$1 == "0" { s += $7; n++ } END { printf "%.17g", (n > 1 ? s / n : 0) }' 1.tsv)" 1e-17
roughgen worn1.nrrd | sed -n 's/^sq:=//p' >sq # without the crown; it was 8 um
rough=$(column relative_roughness s1.tsv | head -1)
near "the relative roughness is that of the worn surface" "$rough" "$(awk 'NR == 1 { printf "%.17g", $1 / 8e-6 }' sq)" 1e-12
ok "wear changes the relative roughness" awk -v r="$rough" 'BEGIN { exit !(r < 0.999 || r > 1.001) }'

# Steps that touch everywhere stop.
roughgen -n 32 -L 1mm --sq 1nm -l 200um | bemcontact --pressure 100MPa -E 210GPa >flat.nrrd
debrisgen --yield 1MPa --steps 5 --young 210GPa --stats stats.tsv flat.nrrd 2>err >t.tsv
is "a surface that is not worn at all gives exit status 3 and a warning" \
	"$? $(grep -c 'stopped before step 1: .* in contact, --stop-area 0.8' err)" "3 1"
is "a contact over 80 % stops the wear" "$(column steps_skipped stats.tsv)" 5
is "a contact over 80 % gives no particles" "$(rows t.tsv)" ""

# Stress fields.
debrisgen -Y 355MPa -u 0.3 --stress stress.nrrd --fields von_mises,principal,hydrostatic,tensor --stress-layers 8 \
	ball.nrrd >t.tsv
is "the stress record has the requested fields and layers" "$(records stress.nrrd | awk '!/^#/ && n++ { printf "%s %s;", $3, $7 }')" \
	"von_mises 8;hydrostatic 8;principal_1 8;principal_2 8;principal_3 8;xx 8;yy 8;zz 8;xy 8;xz 8;yz 8;"
records -o table stress.nrrd | awk '!/^[#r]/ {
	i = $6 - ($10 + $11 + $12) / 3; if (i < 0) i = -i
	j = $7 + $8 + $9 - 3 * $6; if (j < 0) j = -j
	v = sqrt((($7 - $8) ^ 2 + ($8 - $9) ^ 2 + ($9 - $7) ^ 2) / 2) - $5; if (v < 0) v = -v
	if (i > bad) bad = i; if (j > bad) bad = j; if (v > bad) bad = v }
	END { print bad }' >bad
near "the invariants of the stress agree with its components" "$(cat bad)" 0 1
near "the normal stress at the surface is the pressure" "$(records stress.nrrd | awk '$3 == "zz" { print $10 }')" \
	-1725.5455e6 1e5

# The whole way from a smooth ball to the stress: radius R = 1 m pressed to the contact radius
# a = 1 mm, F = 4/3 E* a^3 / R, p0 = 2 E* a / (pi R); 129 points over 4 a.  Von Mises on the
# axis from a/2 to 3a/2 in closed form.
roughgen -n 129 -L 4mm --sq 0 --crown 4um |
	bemcontact --estar 1GPa -F "$(awk 'BEGIN { printf "%.17gN", 4 / 3 }')" 2>err >c.nrrd || cat err
debrisgen -Y 1e30 -u 0.3 --depth-step 0.05mm --stress s.nrrd --stress-layers 31 c.nrrd >t.tsv
records -o table s.nrrd | awk '!/^[#r]/ && $2 > 1.99e-3 && $2 < 2.01e-3 && $3 > 1.99e-3 && $3 < 2.01e-3 && $4 > 0.49e-3 {
	Z = $4 / 1e-3; t = atan2(1, Z); p0 = 2e6 / 3.14159265358979
	zz = -1 / (1 + Z * Z); rr = -1.3 * (1 - Z * t) + 1 / (2 * (1 + Z * Z))
	xz = -0.3 * (1 - 1.5 * Z * t + Z * Z / (2 * (1 + Z * Z)))
	d = $5 / p0 - sqrt((zz - rr) ^ 2 + 3 * xz ^ 2); if (d < 0) d = -d; if (d > m) m = d; n++ }
	END { print n == 21 ? m : "rows: " n }' >error
near "the von Mises stress of a Hertz contact is accurate to 2e-4 p0" "$(cat error)" 0 2e-4

# A reader of the format's own makers.
unu=$(command -v unu || command -v teem-unu)
if [ -n "$unu" ]; then
	is "teem reads the layers of stress" "$("$unu" slice -i stress.nrrd -a 0 -p 0 | "$unu" head - |
		awk '/^sizes/ { print $2, $3, $4 }')" "128 128 8"
else
	skip "teem reads the layers of stress" "no unu"
fi

# Load at the edge is reported: of 0.5 MPa and INNER MPa on one cell each, the first on the rim.
loaded() {
	perl -e 'my ($column, $row, $inner) = @ARGV; binmode STDOUT;
		print "NRRD0004\ntype: double\nendian: little\nencoding: raw\ndimension: 3\n",
			"sizes: 2 5 5\nspacings: 1e-5 1e-5 1e-5\n",
			"fields:=height m, pressure Pa\n\n";
		for my $y (0 .. 4) { for my $x (0 .. 4) { print pack "d<2", 0,
			$x == $column && $y == $row ? 5e5 : $x == 2 && $y == 2 ? $inner * 1e6 : 0 } }' "$@"
}
for cell in '0 2' '4 2' '2 0' '2 4'; do
	loaded $cell 2 | debrisgen -Y 1GPa --summary summary.tsv 2>warning >t.tsv
	near "the load at the edge is computed at $cell" "$(summary edge_load)" 0.2 1e-15
	is "load at the edge gives one warning with the remedy" "$(grep -c "worst 20 % (.*): use a larger area" warning)" 1
done
loaded 2 0 10 | debrisgen -Y 1GPa --summary summary.tsv 2>warning >t.tsv
near "a small load at the edge is computed" "$(summary edge_load)" 0.047619047619047616 1e-15
is "below 5 % of load at the edge there is no warning" "$(cat warning)" ""
status_with() { # MPa on the inner cell, 0.5 MPa on the rim
	status=0
	loaded 2 0 "$1" | debrisgen -Y 1GPa >t.tsv 2>warning || status=$?
	echo $status
}
is "status 3 where the edge carries more than half of the load" "$(status_with 0.45) $(status_with 0.55)" "3 0"
loaded 2 0 2 | debrisgen -Y 1GPa --boundary periodic --summary summary.tsv 2>warning >t.tsv
is "a periodic surface has no edge" "$(summary edge_load) $(cat warning)" "0 "

# Material that fails at the border goes on beyond it, under cells without load: 2 GPa on a
# paraboloid of radius 6 cells whose centre is CENTRE cells from the border, on 32 rows.
# patch CENTRE CELLS: on so many columns, those beyond 32 on the near side
patch() {
	perl -e 'my ($centre, $nx) = @ARGV; $centre += $nx - 32; binmode STDOUT;
		print "NRRD0004\ntype: double\nendian: little\nencoding: raw\ndimension: 3\n",
			"sizes: 2 $nx 32\nspacings: 1 1e-5 1e-5\nfields:=height m, pressure Pa\n\n";
		for my $y (0 .. 31) { for my $x (0 .. $nx - 1) {
			my $r = (($x - $centre) ** 2 + ($y - 16) ** 2) / 36;
			print pack "d<2", 0, $r < 1 ? 2e9 * sqrt(1 - $r) : 0 } }' "$@"
}
for centre in 5 6; do # the outermost cells carry 4 % of the load, and none
	patch $centre 32 >cut.nrrd
	fails "status 3 where a particle is cut off at the border, $centre cells from its centre" 3 \
		'1 steps whose particles are cut off at the border of the grid, where up to .* % more volume is lost .*: use a larger' \
		$wear --summary summary.tsv cut.nrrd
	within=$(summary volume)
	bound=$(sed -n 's/.*up to \([0-9]*\) %.*/\1/p' err)
	patch $centre 64 | $wear --summary summary.tsv >t.tsv 2>err
	is "on a larger grid the same particle is whole, $centre cells from its centre" "$? $(cat err)" "0 "
	missing=$(awk -v a="$within" -v b="$(summary volume)" 'BEGIN { print 100 * (b / a - 1) }')
	at_most "it is larger by no more than the warning says, $centre cells from its centre" "$missing" "$bound"
	at_most "it is larger, $centre cells from its centre" 0.5 "$missing"
done
# Farther away it still reaches the border, with little.
patch 7 32 | $wear --summary summary.tsv >t.tsv 2>err
is "a particle that hardly reaches the border gives no warning" "$? $(column x_low t.tsv) $(cat err)" "0 0 "
within=$(summary volume)
patch 7 64 | $wear --summary summary.tsv >t.tsv 2>err
near "it is not larger on a larger grid" "$(awk -v a="$within" -v b="$(summary volume)" 'BEGIN { print b / a }')" 1 0.005
for option in '--shear y' '--removal potential' '--depth-step 5um'; do
	# shellcheck disable=SC2086 # words
	fails "a particle is cut off with $option" 3 'cut off at the border' $wear $option cut.nrrd
done
# The exit status is lost in a pipe: the tables say it, each of its realisations.
cat cut.nrrd cut.nrrd >twice.nrrd
$wear twice.nrrd 2>err >cut.tsv
is "the table says which realisations are cut off" "$(sed -n 's/^# doubtful: //p' cut.tsv | tr '\n' ';')" \
	'realisation 0: particles are cut off at the border of the grid;realisation 1: particles are cut off at the border of the grid;'
$wear --surface worn.nrrd cut.nrrd >t.tsv 2>err
is "so does the worn surface" "$(strings worn.nrrd | grep '^doubtful:=')" \
	'doubtful:=particles are cut off at the border of the grid'
# Worn surfaces keep what their contact was solved with.
roughgen -n 32 -L 0.25mm -q 1um -l 30um -c 2 -s 4 |
	bemcontact --boundary periodic --pressure 30MPa -E 210GPa --hardness 3GPa >pair.nrrd
debrisgen -Y 355MPa --steps 2 --pressure 30MPa --surface states.nrrd pair.nrrd >inside.tsv 2>err
debrisgen -Y 355MPa --surface first.nrrd pair.nrrd >1.tsv 2>err
bemcontact --pressure 30MPa -E 210GPa first.nrrd | debrisgen -Y 355MPa >2.tsv 2>err
for f in inside 1 2; do rows $f.tsv; done | sort | uniq -c | awk '{ n[$1]++ } END { for (i in n) printf "%s ", i }' >a
is "a loop over periodic surfaces keeps boundary and hardness without options" "$(cat a)" "2 "
is "a worn surface states its contact" "$(strings first.nrrd | grep -E '^(boundary|hardness|estar):=' | sort | uniq -c | awk '{ print $1 }' | tr '\n' ' ')$(
	strings first.nrrd | grep -c '^boundary:=periodic$')" "2 2 2 2"

# Two surfaces of one number would be one of twice the volume to debrisstat.
cat pair.nrrd pair.nrrd >four.nrrd
debrisgen -Y 355MPa pair.nrrd >t.tsv 2>err
is "surfaces of different numbers give no warning" "$? $(cat err)" "0 "
debrisgen -Y 355MPa four.nrrd >t.tsv 2>err
is "two surfaces of one number are marked" "$? $(grep -c 'record 3: realisation 0, step 1, as an earlier record' err) $(grep -c . err) $(
	sed -n 's/^# doubtful: //p' t.tsv | tr '\n' ';')" \
	"3 1 1 realisation 0: more than one surface has this number;realisation 1: more than one surface has this number;"
debrisgen -Y 355MPa states.nrrd >t.tsv 2>err
is "two states of one surface are not" "$? $(cat err)" "0 "
fails "debrisstat gives status 3 for particles that are cut off" 3 'own account: realisation 0: particles are cut off .*; realisation 1: particles are cut off' \
	debrisstat cut.tsv
is "the statistics of doubtful particles are doubtful" "$(grep -c '^# doubtful: realisation 0.*; realisation 1' out)" 1
fails "debriscount gives status 3 for particles that are cut off" 3 'doubtful by its own account' debriscount --duration 1s --volume 1mL \
	cut.tsv
$wear --boundary periodic cut.nrrd >t.tsv 2>err
is "a periodic grid cuts no particle off" "$? $(cat err)" "0 "
is "the table of sound particles says nothing" "$(grep -c doubtful t.tsv)" 0

# A ridge that goes round a periodic grid has no end, and so no length.
perl -e 'binmode STDOUT; print "NRRD0004\ntype: double\nendian: little\nencoding: raw\ndimension: 3\n",
	"sizes: 2 16 16\nspacings: 1e-5 1e-5 1e-5\nfields:=height m, pressure Pa\nboundary:=periodic\n\n";
	for my $y (0 .. 15) { print pack("d<2", 0, $y == 8 ? 1e9 : 0) for 0 .. 15 }' >ridge.nrrd
for c in "tolerance 1e-6" "max-iterations 9" "solver pk" "multiply mlms"; do
	# shellcheck disable=SC2086 # words
	fails "--${c% *} of a contact that is read" 2 "--${c% *} has no effect: a single step takes the pressure" \
		debrisgen -Y 355MPa --$c ridge.nrrd
done
debrisgen --yield 355MPa --friction 0.3 ridge.nrrd >t.tsv 2>err
is "a particle that crosses a periodic grid gives exit status 3, one warning and no length" \
	"$? $(grep -c '1 of 1 particles connect to themselves' err) $(column length t.tsv) $(column x t.tsv)" "3 1 nan nan"
is "a particle that crosses a periodic grid has the columns of one period" "$(column columns t.tsv)" 16

# On periodic grids of even size a turned scene sheds the turned particles, row by row and to
# rounding: all moments, lengths and places.  The shear is along x, and along y in the exchanged scene.
# Sums on coarse points differ where the grid is moved by a part of their spacing: not those over all cells.
# shed SIZE HEIGHTS OPTION...
shed() {
	size=$1
	surface=$2
	shift 2
	bemcontact --raw "$size" --pixel 4um --boundary periodic --estar 115GPa --pressure 100MPa --tolerance 1e-12 "$surface" |
		debrisgen --yield 355MPa --friction 0.3 "$@"
}
# turned HOW SHED SIZE OPTION...: the particles of the turned heights are those in SHED, turned
turned() {
	how=$1
	upright=$2
	size=$3
	shift 3
	perl "$top/tests/turned.pl" heights "$how" 64 "$rows" <heights >turned
	shed "$size" turned "$@" >turned.tsv
	found=$(perl "$top/tests/turned.pl" particles "$how" 256e-6 "$width" "$upright" turned.tsv)
	at_most "64 x $rows periodic: the particles of the $how scene are the $how particles" "${found#* }" 1e-10
}
for rows in 64 48; do
	width=$(awk -v n=$rows 'BEGIN { print 4e-6 * n }')
	roughgen --points 64x$rows --length 256umx"$width" --sq 1um --corr 20um --seed 6 | records --output raw >heights
	shed 64x$rows heights >shed.tsv
	shed 64x$rows heights --full-sum >full.tsv
	at_most "64 x $rows periodic: there are particles to compare" 5 "$(column columns shed.tsv | wc -l)"
	turned mirrored shed.tsv 64x$rows
	turned exchanged shed.tsv ${rows}x64 --shear y
	turned moved full.tsv 64x$rows --full-sum
done

replay s.nrrd cmd:= >a
same "the command of a stress field reproduces it" a s.nrrd

fails "cells of next to no height" 1 "deeper than 2000 cells of --depth-step" $wear --depth-step 1e-3nm small.nrrd
# Whole cells: the error is of first order in their height, and goes to zero.
roughgen -n 64 -L 0.5mm --sq 0.8um --corr 50um --seed 3 --crown auto | bemcontact -F 20N -E 210GPa >peaks.nrrd
debrisgen -Y 355MPa -u 0.3 --summary exact.tsv peaks.nrrd >t.tsv
for h in 4um 2um 1um 0.5um; do
	debrisgen -Y 355MPa -u 0.3 --depth-step $h --summary cells.tsv peaks.nrrd >t.tsv
	column volume cells.tsv
done >volumes
near "whole cells are of first order in their height" \
	"$(awk '{ v[NR] = $1 } END { print log((v[1] - v[3]) / (v[2] - v[4])) / log(2) }' volumes)" 1 0.2
near "without height they remove what the default does" "$(
	awk -v exact="$(column volume exact.tsv)" '{ v[NR] = $1 } END { print (2 * v[4] - v[3]) / exact }' volumes)" 1 0.01
fails "no yield stress" 2 "--yield is missing" debrisgen
LC_ALL=C sed -e 's/^estar:=/other:=/' -e '/^stream:=/d' ball.nrrd >stripped.nrrd
fails "steps without a modulus" 2 "specify --young or --estar" debrisgen -Y 1GPa --steps 2 stripped.nrrd
$wear -E 210GPa --steps 2 ball.nrrd | grep -v '^#' >given.tsv
$wear --steps 2 ball.nrrd | grep -v '^#' >inherited.tsv
same "the modulus is that of the input unless one is given" given.tsv inherited.tsv
bemcontact --boundary periodic --pressure 50MPa -E 210GPa --coating 1um --coating-young 90GPa rough.nrrd >coated.nrrd
fails "the contact of a coated body" 1 "record 1 is the contact of a coated body" debrisgen -Y 1GPa coated.nrrd
roughgen -n 32 -L 0.5mm -q 8um -l 50um --crown 32um | bemcontact -F 5N -E 210GPa --max-iterations 1 >poor.nrrd 2>err
fails "a contact that did not converge" 3 "record 1: its contact did not converge" \
	sh -c 'debrisgen -Y 1GPa poor.nrrd >poor.tsv'
# The first step uses the contact that it reads, whatever load the options say
for row in "-F 50N|^-" "-E 210GPa|^-" "-F 500N|a mean pressure of 5e+07 Pa, not 5e+08 Pa" \
	"-E 70GPa|a contact modulus of 1.15385e+11 Pa, not 3.84615e+10 Pa" "--approach 1mm|an approach of" \
	"--hardness 0|^-" "--hardness 1GPa|a hardness of 0 Pa, not 1e+09 Pa" \
	"--boundary free|^-" "--boundary periodic|a free boundary, not a periodic one"; do
	# shellcheck disable=SC2086 # two words
	$wear --depth-step 50um ${row%%|*} ball.nrrd 2>&1 >t.tsv | grep -o 'solved with .*' >err
	like "a contact that is read, and ${row%%|*}: a warning if they differ" "$(cat err)-" "${row#*|}"
done
$wear --depth-step 50um --boundary periodic ball.nrrd >t.tsv 2>err
is "the stress of another boundary than that of the contact is marked" "$? $(grep '^# doubtful' t.tsv)" \
	"3 # doubtful: realisation 0: stress and contact have different boundaries"
fails "two loads" 2 "only one of" debrisgen -Y 1GPa -F 1N --pressure 1MPa
fails "an unknown stress field" 2 "principal|tensor" debrisgen -Y 1GPa --fields foo
fails "no pressure" 1 "pressure" debrisgen -Y 1GPa rough.nrrd
fails "a stress field as input" 1 "plane fields" debrisgen -Y 1GPa stress.nrrd
# Heights that no output takes are checked all the same
{
	printf 'NRRD0004\ntype: double\ndimension: 3\nsizes: 2 3 2\nkinds: list domain domain\n'
	printf 'spacings: nan 1e-6 1e-6\nendian: little\nencoding: raw\nfields:=height m, pressure Pa\n\n'
	for height in '\0\0' '\0\0' '\0\0' '\0\0' '\370\177' '\0\0'; do
		# shellcheck disable=SC2059 # octal digits
		printf "\0\0\0\0\0\0$height\0\0\0\0\0\0\0\0"
	done
} >missing.nrrd
for option in --steps=1 --summary=t2.tsv; do
	fails "a missing height, $option" 1 "record 1: height is nan at x 1, y 1; want finite samples" \
		debrisgen -Y 1GPa "$option" missing.nrrd
done
head -c 20000 start.nrrd >cut.nrrd
fails "a truncated record" 1 "cut.nrrd: record 1: want" debrisgen -Y 1GPa cut.nrrd
fails "material without strength" 1 "step 1: material fails deeper" debrisgen --yield 200kPa start.nrrd
done_testing

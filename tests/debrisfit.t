#!/bin/sh
# debrisfit and debrisgen --surrogate: footprints are exact, volumes within their intervals
. "$(dirname "$0")/tap.sh"

# contacts SEED COUNT: surfaces of 32 x 32 cells under load
contacts() {
	roughgen --points 32 --length 0.25mm --sq 1um --corr 10um --crown auto --seed "$1" --count "$2" |
		bemcontact --pressure 50MPa --young 210GPa
}
contacts 1 130 >fitted.nrrd
debrisfit --yield 250MPa:500MPa --friction 0:0.5 --stats stats fitted.nrrd >surrogate.tsv
is 'a surrogate is fitted' "$? $(column surfaces stats)" '0 130'

cat fitted.nrrd fitted.nrrd >twice.nrrd
fails 'surfaces that are given twice' 1 'record 131 has the pressure of record 1: want each surface once' \
	debrisfit --yield 250MPa:500MPa twice.nrrd

contacts 9 30 >hidden.nrrd
debrisgen --yield 355MPa --friction 0.3 --summary full.steps hidden.nrrd >full.tsv
debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 --stats stats \
	--summary quick.steps hidden.nrrd >quick.tsv 2>said
is 'other surfaces are estimated' "$?" 0
fails 'an audit without a surrogate' 2 '\--audit requires --surrogate' debrisgen --yield 355MPa --audit 0.5 fitted.nrrd
near 'the surrogate answers for most of the surfaces' "$(column surfaces_estimated stats)" 30 12
is 'as many particles are found on each as by the full model' "$(column particles quick.steps | cksum)" \
	"$(column particles full.steps | cksum)"
# outlines, in any order
outlines() {
	awk -F '\t' '/^#/ { next } !n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
		{ printf "%s %s %.9g %.9g %.9g %.9g\n", $c["realisation"], $c["columns"], $c["x_low"], $c["x_high"], $c["y_low"],
			$c["y_high"] }' "$1" | sort
}
outlines full.tsv >want
outlines quick.tsv >got
same 'the tables have the same cells and outlines' got want
paste full.steps quick.steps | awk -F '\t' '/^#/ { next }
	!n { for (i = 1; i <= NF; i++) { if ($i == "volume" && !v) v = i; if ($i == "volume_low") low = i
		if ($i == "volume_high") high = i; if ($i == "exact") e = i } n = 1; next }
	!$e { all++; held += $low <= $v && $v <= $high } END { print held / all }' >held
near 'intervals of 90 % hold the total volumes' "$(cat held)" 0.9 0.15
paste full.steps quick.steps | awk -F '\t' '/^#/ { next }
	!n { for (i = 1; i <= NF; i++) if ($i == "volume") c[++k] = i; n = 1; next }
	{ full += $c[1]; quick += $c[2] } END { print quick / full }' >ratio
# Particles of rougher and larger surfaces, whose direct sums are off by four times as much.
roughgen --points 96 --length 0.4mm --sq 0.6um --acf exp --corr 25um --crown auto --seed 7 --count 6 2>/dev/null |
	bemcontact --load 32N --young 300GPa >rough.nrrd 2>/dev/null
for kind in full quick; do
	[ $kind = full ] || set -- --surrogate surrogate.tsv --width 1000 --audit 0
	debrisgen --yield 2GPa --friction 0.3 "$@" rough.nrrd 2>/dev/null
done | awk -F '\t' '/^#/ { next } $1 == "realisation" { table++; for (i = 1; i <= NF; i++) c[$i] = i; next }
	{ k = $1; for (i = c["x_low"]; i <= c["y_high"]; i++) k = k sprintf(" %.9g", $i) }
	table == 1 { full[k] = $c["volume"]; next }
	k in full && !$c["exact"] { n++; held += $c["volume_low"] <= full[k] && full[k] <= $c["volume_high"] }
	END { print n, held / n }' >held
is 'hundreds of particles of rougher surfaces are estimated' "$(awk '{ print ($1 > 200) }' held)" 1
near 'intervals of 90 % hold single particles of rougher surfaces' "$(cut -d ' ' -f 2 held)" 0.92 0.07
near 'the volume of all surfaces is right within .3 %' "$(cat ratio)" 1 0.003
# Of particles of up to four cells the depth is found below each; every depth at which the
# full model looks is looked at where the stress is near yield.
small() {
	awk -F '\t' '/^#/ { next } !n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
		$c["columns"] <= 4 { printf "%s %.9g %.9g %.9g %.9g %s\n", $c["realisation"], $c["x_low"], $c["x_high"],
			$c["y_low"], $c["y_high"], $c["volume"] }' "$1" | sort
}
small full.tsv >want
small quick.tsv >got
is 'nine in ten small particles have the volume of the full model within 1 %' "$(paste -d ' ' want got | awk '
	{ n++; e = $12 / $6 - 1; right += e * e < 1e-4 } END { print (n > 30 && right > 0.9 * n) }')" 1
is 'unknown columns of an estimated particle are nan' "$(column exact quick.tsv | paste - quick.tsv 2>/dev/null | wc -l | awk '{ print ($1 > 0) }') $(
	awk -F '\t' '/^#/ { next } !n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
		!$c["exact"] && ($c["length"] != "nan" || $c["z"] != "nan") { bad++ } END { print bad + 0 }' quick.tsv)" '1 0'
is 'estimates are below their upper and above their lower ends' "$(awk -F '\t' '/^#/ { next }
	!n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
	{ rows++ }
	!($c["volume_low"] <= $c["volume"] && $c["volume"] <= $c["volume_high"]) { bad++ } END { print (rows ? bad + 0 : "no rows") }' quick.tsv)" 0

# The border of a free grid cuts particles off, estimated or not.
roughgen --points 32 --length 0.25mm --sq 1um --corr 10um --seed 6 |
	bemcontact --pressure 50MPa --young 210GPa >flat.nrrd
for kind in full quick; do
	set --
	[ $kind = full ] || set -- --surrogate surrogate.tsv --width 10 --audit 0 --stats stats
	debrisgen --yield 355MPa --friction 0.3 "$@" flat.nrrd >/dev/null 2>said
	is "status 3 where particles of the $kind model are cut off at the border" \
		"$? $(grep -c 'cut off at the border of the grid, where up to [23]. % more volume is lost' said)" '3 1'
done
is 'the volume of the surface that is cut off is estimated' "$(column surfaces_estimated stats)" 1

# A surface has the same particles alone as after others.
contacts 10 4 >four.nrrd
debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 four.nrrd 2>said |
	grep -v '^#' | awk -F '\t' '$1 == 3' >together
contacts 10 4 | records --pick 4 --output nrrd >last.nrrd
debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 last.nrrd 2>said |
	grep -v '^#' | awk -F '\t' '$1 == 3' >alone
same 'a surface has the same particles alone as after others' together alone
is 'a surface among others has particles' "$(awk 'END { print (NR > 0) }' alone)" 1

# None and one particle: a smooth ball below and above yield.
ball() { # LOAD: particles and volume, full and surrogate
	roughgen --points 32 --length 0.25mm --sq 0 --crown 8um | bemcontact --load "$1" --young 210GPa >ball.nrrd
	debrisgen --yield 355MPa --friction 0.3 --summary ball.full ball.nrrd >/dev/null 2>&1
	debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 --summary ball.quick ball.nrrd >/dev/null 2>&1
	echo "$(column particles ball.full) $(column particles ball.quick) $(column volume ball.full) $(column volume ball.quick)"
}
is 'a ball that does not yield loses nothing' "$(ball 1uN)" '0 0 0 0'
is 'the interval of a ball that does not yield has no width' "$(column volume_low ball.quick) $(column volume_high ball.quick) $(column exact ball.quick)" '0 0 1'
ball 4N >one
is 'a ball that yields loses one particle' "$(cut -d ' ' -f 1,2 one)" '1 1'
near 'the volume lost by a ball is that of the full model within a quarter' \
	"$(awk '{ print $4 / $3 }' one)" 1 0.25

# Cells three times as long as wide: the depths below them are those of the full model.
# Both surfaces lose fewer than 250 columns, all of which are measured.
for cells in 32x96 96x32; do
	roughgen --points $cells --length 0.25mmx0.25mm --sq 0.3um --corr 40um --crown 8um --seed 3 --first 1 --count 2 |
		bemcontact --load 5N --young 210GPa >oblong.nrrd
	debrisgen --yield 500MPa --friction 0.3 --summary oblong.full oblong.nrrd >/dev/null
	debrisgen --yield 500MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 --summary oblong.quick \
		oblong.nrrd >/dev/null
	is "$cells cells: both surfaces are estimated" "$(column exact oblong.quick | tr '\n' ' ')" '0 0 '
	near "$cells cells: their volumes are those of the full model" "$(column volume oblong.full >v
		column volume oblong.quick | paste v - | awk '{ e = $2 / $1 - 1; e *= e; m = e > m ? e : m } END { print sqrt(m) }')" 0 6e-4
done

# Columns that end where others would not: in a layer nearly without stress, thinner than
# two depths apart, and where the stress comes within 5e-4 of the yield stress.  All cells
# are measured; one such column was up to 2 % of the volume.  The ranges of the fit are widened.
awk -F '\t' -v OFS='\t' '/^#/ { next } $1 == "least" { $3 = -1 } $1 == "most" { $3 = 1 } { print }' surrogate.tsv >wide.tsv
while IFS='|' read -r surface contact model; do
	# shellcheck disable=SC2086 # words
	roughgen $surface --first 1 --count 1 2>/dev/null | bemcontact $contact 2>/dev/null >tie.nrrd
	# shellcheck disable=SC2086
	debrisgen $model tie.nrrd --summary tie.full >/dev/null 2>&1
	# shellcheck disable=SC2086
	debrisgen $model --surrogate wide.tsv --width 10 --audit 0 --summary tie.quick tie.nrrd >/dev/null 2>&1
	is "'$model' is estimated" "$(column exact tie.quick)" 0
	near "columns of '$model' end where those of the full model do" \
		"$(column volume tie.quick | awk -v v="$(column volume tie.full)" '{ print $1 / v }')" 1 2e-3
done <<END
-n 300x16 -L 1429.6405umx89.7989um -q 5.207um --hurst 0.55 --rolloff 187.55um --seed 66|--pressure 5.4MPa -E 345GPa|-Y 204.7MPa -u 0.545 --poisson 0.334 --shear y
-n 128 -L 214.7074um -q 0.152um -l 5.94um --seed 36|--pressure 290MPa -E 187GPa|-Y 1373.8MPa -u 0.018 --poisson 0.313 --shear y
END

# Units: lengths four times as long, stresses ten times as large.
roughgen --points 32 --length 1mm --sq 4um --corr 40um --crown auto --seed 9 --count 30 |
	bemcontact --pressure 500MPa --young 2100GPa |
	debrisgen --yield 3550MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 --summary large.steps >large.tsv 2>/dev/null
near 'scaled surfaces lose scaled volumes' "$(column volume large.steps | awk '{ v += $1 } END { print v / 64 * 1e13 }')" \
	"$(column volume quick.steps | awk '{ v += $1 } END { print v * 1e13 }')" 1e-4

# Another modulus, yield stress, friction and shear: bronze after a fit to steel.
roughgen --points 32 --length 0.25mm --sq 1um --corr 10um --crown auto --seed 9 --count 8 |
	bemcontact --pressure 20MPa --young 105GPa >bronze.nrrd
debrisgen --yield 230MPa --friction 0.1 --shear y --summary bronze.full bronze.nrrd >/dev/null 2>&1
debrisgen --yield 230MPa --friction 0.1 --shear y --surrogate surrogate.tsv --width 10 --audit 0 --summary bronze.quick --stats stats \
	bronze.nrrd >/dev/null 2>&1
is 'bronze is estimated after a fit to steel' "$(($(column surfaces_estimated stats) >= 6))" 1
near 'the volume lost by bronze is that of the full model' "$(column volume bronze.quick | awk '{ v += $1 } END { print v * 1e13 }')" \
	"$(column volume bronze.full | awk '{ v += $1 } END { print v * 1e13 }')" 0.07

# Outside the range of the fit the full model runs and says so.
contacts 5 6 >few.nrrd
debrisgen --yield 355MPa --friction 2 --surrogate surrogate.tsv --audit 0 --stats stats few.nrrd >far.tsv 2>said
debrisgen --yield 355MPa --friction 2 few.nrrd >far.full 2>/dev/null
is 'beyond the friction of the fit nothing is estimated' "$(column surfaces_estimated stats) $(column surfaces_outside stats)" '0 6'
is 'beyond the friction of the fit the volumes are those of the full model' "$(column volume far.tsv | cksum)" "$(column volume far.full | cksum)"
like 'surfaces outside the range of the fit are reported' "$(cat said)" '6 surfaces outside the range of surrogate.tsv'
bemcontact --pressure 50MPa --young 210GPa --hardness 1GPa few.nrrd >flowed.nrrd
debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 --stats stats flowed.nrrd >far.tsv 2>said
is 'contacts that flow are not estimated after a fit to elastic ones' "$(column surfaces_estimated stats) $(column surfaces_outside stats)" '0 6'
roughgen --points 32 --length 0.25mm --sq 1um --corr 10umx30um --crown auto --seed 5 --count 20 |
	bemcontact --pressure 50MPa --young 210GPa >lay.nrrd
debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 --stats stats lay.nrrd >far.tsv 2>said
is 'few contacts with a lay are estimated after a fit to isotropic ones' "$(($(column surfaces_estimated stats) <= 4))" 1
bemcontact --pressure 50MPa --young 210GPa --hardness 1TPa few.nrrd >elastic.nrrd
for h in few elastic; do
	debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0 --stats stats $h.nrrd >/dev/null 2>said
	column surfaces_estimated stats >$h.count
done
same 'a hardness that is nowhere reached changes nothing' few.count elastic.count
debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 0 --stats stats few.nrrd >/dev/null 2>said
is 'no interval is narrow enough for a width of 0' "$(column surfaces_estimated stats)" 0

# Audits: sound, and of a surrogate whose intervals are a hundred times too narrow.
debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --width 10 --audit 0.3 --stats stats hidden.nrrd >/dev/null 2>said
is 'an audit of a sound surrogate passes' $? 0
near 'the requested share of surfaces is audited' "$(column surfaces_audited stats)" 8 5
awk -F '\t' -v OFS='\t' '/^#/ { next } $1 == "total" { $3 /= 100 } { print }' surrogate.tsv >wrong.tsv
debrisgen --yield 355MPa --friction 0.3 --surrogate wrong.tsv --width 10 --audit 0.3 hidden.nrrd >rows 2>said
is 'an audit of a wrong surrogate fails with status 3' "$? $(grep -c '^# doubtful: the surrogate' rows)" '3 1'
like 'a failed audit is reported' "$(cat said)" 'audited volumes lie within their intervals'

fails 'too few surfaces' 1 'are too few' sh -c 'contacts() { roughgen --points 32 --length 0.25mm --sq 1um --corr 30um --crown auto --count 5 |
	bemcontact --pressure 50MPa --young 210GPa; }; contacts | debrisfit --yield 355MPa'
# One of the contacts is a first iterate: surrogate, table and exit statuses say so.
{
	cat fitted.nrrd
	roughgen --points 32 --length 0.25mm --sq 1um --corr 10um --crown auto --seed 77 |
		bemcontact --pressure 50MPa --young 210GPa --max-iterations 2 2>said
} >rough.nrrd
debrisfit --yield 250MPa:500MPa --friction 0:0.5 rough.nrrd >doubtful.tsv 2>said
is 'a fit with a contact that did not converge is doubtful' "$? $(sed -n 's/^# doubtful: //p' doubtful.tsv)" \
	'3 a contact did not converge'
{
	cat fitted.nrrd
	printf '# doubtful: worn\ndiameter\n1e-9\n' >free.tsv
	roughgen --points 32 --length 0.25mm --sq 1um --corr 10um --crown auto --seed 77 |
		abrade --gap 1um --hardness 2GPa --friction 0.1 --motion groove --surface - free.tsv |
		bemcontact --pressure 50MPa --young 210GPa
} >worn.nrrd 2>err
debrisfit --yield 250MPa:500MPa --friction 0:0.5 worn.nrrd >worn.tsv 2>said
is 'a fit to doubtful surfaces is doubtful' "$? $(sed -n 's/^# doubtful: //p' worn.tsv) $(grep -c 'worn.nrrd: doubtful by its own account: worn' said)" '3 worn 1'
debrisgen --yield 355MPa --friction 0.3 --surrogate doubtful.tsv --width 10 --audit 0 --summary steps.tsv hidden.nrrd >doubted.tsv 2>said
is 'particles of a doubtful surrogate have status 3' \
	"$? $(grep -c 'doubtful.tsv: doubtful by its own account: a contact did not converge' said)" '3 1'
is 'both tables say so' "$(grep -c '^# doubtful: the surrogate' doubted.tsv) $(grep -c '^# doubtful: the surrogate' steps.tsv)" '1 1'
fails 'statistics of these particles' 3 'doubtful by its own account: the surrogate' debrisstat doubted.tsv
fails 'no yield stress' 2 'want --yield' debrisfit hidden.nrrd
grep -v 'oblique' surrogate.tsv | grep -v '^#' >part.tsv
fails 'a part of a surrogate' 1 'not a complete surrogate' debrisgen --yield 355MPa --surrogate part.tsv hidden.nrrd
grep -v '^total\|^#' surrogate.tsv >part.tsv
fails 'a surrogate without totals' 1 'not a complete surrogate' debrisgen --yield 355MPa --surrogate part.tsv hidden.nrrd
{ grep -v '^#' surrogate.tsv; printf 'deviation\tsums\t0.001\n'; } >part.tsv
fails 'a surrogate of an earlier program' 1 'fit it anew with debrisfit' debrisgen --yield 355MPa --surrogate part.tsv hidden.nrrd
fails 'a level beyond the scores of the fit' 1 'give intervals of level 0.9[0-9]* at most' \
	debrisgen --yield 355MPa --friction 0.3 --surrogate surrogate.tsv --interval 0.999 hidden.nrrd
fails 'another table' 1 "no column 'kind'\|kind" debrisgen --yield 355MPa --surrogate full.tsv hidden.nrrd
fails 'depths of a surrogate' 2 'surrogate excludes --surface' debrisgen --yield 355MPa --surrogate surrogate.tsv --surface x hidden.nrrd
fails 'steps of a surrogate' 2 'one step' debrisgen --yield 355MPa --young 210GPa --surrogate surrogate.tsv --steps 2 hidden.nrrd
perl -0777 -pe 's/^stream:=.*\n//m; substr($_, -8) = pack "d<", -1e6' last.nrrd >pulled.nrrd
fails 'a pressure below zero' 1 'pressure below zero' debrisgen --yield 355MPa --surrogate surrogate.tsv pulled.nrrd
roughgen --points 32 --length 0.25mm --sq 1um --corr 30um | bemcontact --pressure 50MPa --young 210GPa --boundary periodic >periodic.nrrd
fails 'a periodic surface' 2 'is periodic' debrisgen --yield 355MPa --surrogate surrogate.tsv periodic.nrrd
fails 'a fit to a periodic surface' 1 'is periodic' debrisfit --yield 355MPa periodic.nrrd
done_testing

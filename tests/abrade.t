#!/bin/sh
# abrade: loads and depths, what is described and what is not, surfaces, refusals
. "$(dirname "$0")/tap.sh"

# cell COLUMN FILE [ROW]: in six digits
cell() {
	column "$1" "$2" | awk -v r="${3:-1}" 'NR == r { print $1 ~ /^[-0-9.]/ ? sprintf("%.6g", $1) : $1 }'
}

printf 'diameter\taspect\n10e-6\t1\n8e-6\t3\n30e-6\t1.1\n10e-6\t3\n' >four.tsv
abrade --gap 9um --hardness 2GPa,6GPa --friction 0.1 four.tsv >out.tsv
is "a sphere of 10 um in a gap of 9 um has the depth and the load of an indentation in 2 GPa" \
	"$(cell depth1 out.tsv) $(cell load out.tsv)" "7.6013e-07 0.0441299"
is "each particle moves as its shape and hardness prescribe" "$(column mode out.tsv | tr '\n' ' ')" "rolls free grooves grooves "
is "only grooving particles wear, and only the harder body wears" \
	"$(column volume1 out.tsv | tr '\n' ' ')$(column volume2 out.tsv | awk '{ printf "%s ", ($1 > 0) }')" \
	"0 0 0 0 0 0 1 1 "
abrade --gap 9um --hardness 2GPa,6GPa --friction 1.5 four.tsv >rough.tsv
is "the elongated particle also rolls if the friction is larger" "$(column mode rough.tsv | tail -n 1)" rolls
abrade --gap 9um --hardness 2GPa,6GPa --friction 0.1 --motion groove --slide 3m --cutting 20% four.tsv >slid.tsv
near "the volume is proportional to the sliding distance and the cutting share" \
	"$(cell volume2 slid.tsv 4 | awk '{ print $1 * 1e12 }')" \
	"$(cell volume2 out.tsv 4 | awk '{ print $1 * 0.6e12 }')" 1e-5
is "all particles groove with --motion groove" "$(column mode slid.tsv | tr '\n' ' ')" "grooves free grooves grooves "

abrade --load 1N --hardness 2GPa,6GPa --friction 0.1 --summary s.tsv --area 1mm2 four.tsv >loaded.tsv
near "the particles together carry the load" "$(cell load s.tsv)" 1 1e-9
near "the pressure is load over area" "$(cell pressure s.tsv)" 1e6 1
is "the computed gap gives the same result as input" "$(abrade --gap "$(column gap s.tsv)" --hardness 2GPa,6GPa \
	--friction 0.1 four.tsv | sed '/^#/d')" "$(sed '/^#/d' loaded.tsv)"
printf 'realisation\tdiameter\n1\t10e-6\n0\t20e-6\n1\t12e-6\n' >two.tsv
abrade --load 0.1N --hardness 2GPa --friction 0 --summary s.tsv two.tsv >loaded.tsv
is "each realisation has its own gap" "$(column realisation s.tsv | tr '\n' ' ')$(column load s.tsv |
	awk '{ printf "%.6f ", $1 }')" "0 1 0.100000 0.100000 "
abrade --gap 15um --hardness 2 --friction 0 two.tsv >out 2>err
is "a hardness without its unit gives a hint" "$(grep -c 'is 2GPa meant' err)" 1
fails "a body without its surface" 2 '\--body requires --surface' abrade --gap 15um --hardness 2GPa --friction 0 --body 2 two.tsv
fails "a seed where nothing is drawn" 2 '\--seed requires --iso or --surface' \
	abrade --gap 15um --hardness 2GPa --friction 0 --seed 2 two.tsv
fails "more load than they can carry" 1 'carry at most .* the surfaces touch' \
	abrade --load 1kN --hardness 2GPa --friction 0 two.tsv

abrade --gap 9um --hardness 2GPa,6GPa --abrasive-hardness 3GPa --friction 0.1 four.tsv >soft.tsv
is "particles softer than 1.2 times the harder body are embedded in the softer body" \
	"$(column mode soft.tsv | sort -u | tr '\n' ' ')" "embeds free "
abrade --gap 9um --hardness 2GPa,6GPa --abrasive-hardness 2GPa --friction 0.1 four.tsv >soft.tsv 2>err
is "particles softer than both bodies are marked by status 3 and have no volume" \
	"$? $(column mode soft.tsv | sort -u | tr '\n' ' ')$(cell load soft.tsv) $(grep -c 'yield' err)" \
	"3 free yields nan 1"
head -n 1 four.tsv >none.tsv
fails "a load on no particles" 3 'no particle carries the load' abrade --load 1N --hardness 2GPa --friction 0 none.tsv
fails "a load on particles that yield" 1 'the particles yield' \
	abrade --load 1N --hardness 2GPa,6GPa --abrasive-hardness 2GPa --friction 0.1 four.tsv
abrade --gap 1um --hardness 2GPa --friction 0.1 --motion groove four.tsv >deep.tsv 2>err
is "grooves deeper than the radius of the particle are marked" "$? $(column mode deep.tsv | sort -u) $(cell volume1 deep.tsv)" "3 buried nan"
abrade --gap 9um --hardness 2GPa --friction 0.01 --inlet 5mm four.tsv >in.tsv
is "a ball of 5 mm admits 10 um at a friction of 0.01, but not 30 um" \
	"$(column mode in.tsv | tr '\n' ' ')" "rolls free rejected grooves "

printf 'diameter\taspect\n10e-6\t1\n' >sphere.tsv
abrade --gap 9um --hardness 2GPa --friction 0.1 sphere.tsv >/dev/null 2>known
cut -f 1 sphere.tsv | abrade --gap 9um --hardness 2GPa --friction 0.1 2>err >rolls.tsv
is "that a particle rolls is reported unless its shape is known" \
	"$(column mode rolls.tsv) $(grep -c 'spheres, which roll' err) $(wc -l <known | tr -d ' ')" "rolls 1 0"
printf 'diameter\tclass\n10e-6\tnon-ferrous\n' | abrade --gap 9um --hardness 2GPa --friction 0.1 >kind.tsv 2>err
is "a non-ferrous particle is larger than its diameter, and marked" "$? $(grep -c '1 rows are non-ferrous' err)" "3 1"

# An oil of a known code: as many particles as it has, the mean beside the draw.
abrade --iso 18:16:13 --largest 70um --area 1m2 --gap 5um --hardness 2GPa,6GPa --friction 0.1 \
	--motion groove --summary s.tsv --stats st >oil.tsv
# 2500 per ml in 5 ml, less those of 4 to 5 um
near "the number of particles above 14 um is 80 per ml" "$(column diameter oil.tsv | awk '$1 > 14e-6' | wc -l)" 400 80
near "the particles drawn carry the mean load" "$(awk -v a="$(cell pressure s.tsv)" -v b="$(cell mean_pressure s.tsv)" \
	'BEGIN { print a / b }')" 1 0.2
near "the particles drawn cause the mean wear" "$(awk -v a="$(cell depth_rate2 s.tsv)" -v b="$(cell mean_depth_rate2 s.tsv)" \
	'BEGIN { print a / b }')" 1 0.2
near "particles smaller than the gap are not drawn but counted" "$(awk -v n="$(column diameter oil.tsv | wc -l)" \
	-v left="$(column particles_left_out st)" 'BEGIN { print n + left }')" 12500 60
# None of the large ones is drawn for 1 mm2, but they are part of the mean.
abrade --iso 18:16:13 --largest 70um --area 1mm2 --gap 5um --hardness 5GPa,6GPa --friction 0.1 \
	--motion groove --summary s3.tsv 2>err >rare.tsv
is "a mean that leaves out buried particles is marked, although none is drawn" \
	"$? $(column mode rare.tsv | grep -c buried) $(grep -c 'the mean wear does not include' err)" "3 0 1"
abrade --iso 18:16:13 --largest 70um --area 1m2 --load 604N --hardness 2GPa,6GPa --friction 0.1 \
	--motion groove --summary s2.tsv >oil2.tsv
near "under a load the gap is the one at which the oil carries it on average" "$(cell mean_pressure s2.tsv)" 604 1e-3
abrade --iso 18:16:13 --largest 70um --area 1m2 --gap 5um --hardness 2GPa,6GPa --friction 0.1 \
	--motion groove --count 3 >three.tsv
is "the first of three realisations equals a single realisation" \
	"$(grep '^0	' three.tsv | cksum)" "$(grep '^0	' oil.tsv | cksum)"

# Surfaces: what leaves them is what the table says.
roughgen --points 64 --length 100um --sq 0.5um --corr 10um --count 2 >h.nrrd
printf 'realisation\tdiameter\taspect\n0\t10e-6\t3\n1\t12e-6\t3\n1\t14e-6\t3\n' >p.tsv
abrade --gap 9.5um --hardness 6GPa,2GPa --friction 0.1 --slide 250um --cutting 40% --surface h.nrrd \
	--particles worn.tsv --stats st p.tsv >worn.nrrd 2>err
mean() {
	records -o list "$1" | awk -F '\t' '/^[0-9]/ { printf "%.17g\n", $11 }' | sed -n "$2p"
}
for k in 1 2; do
	lost=$(awk -v a="$(mean h.nrrd $k)" -v b="$(mean worn.nrrd $k)" 'BEGIN { printf "%.9g", (a - b) * 1e-8 * 1e18 }')
	near "realisation $k loses the volume of its particles" "$lost" \
		"$(awk -F '\t' -v r=$((k - 1)) '$1 == r && /^[0-9]/ { s += $8 } END { printf "%.9g", s * 1e18 }' worn.tsv)" 1e-6
done
is "grooves are counted" "$(column grooves_cut st)" 3
abrade --gap 9.5um --hardness 6GPa,2GPa --friction 0.1 --surface h.nrrd --body 2 p.tsv >same.nrrd
is "the body without grooves is unchanged" "$(mean same.nrrd 1)" "$(mean h.nrrd 1)"
# c(x) = 2 c(0.6 um - x), c(x) = 10 um x - x^2: x = 402.82 nm; the mean over the lowest cell of
# 0.1 um is higher by 0.3 nm at most
roughgen --points 1000 --length 100um --sq 1pm --corr 10um >flat.nrrd
printf 'diameter\n10e-6\n' |
	abrade --gap 9.4um --hardness 2GPa --friction 0.1 --motion groove --slide 50um --surface flat.nrrd >groove.nrrd
near "a groove that two bodies of equal hardness share has its depth over half the distance" \
	"$(roughgen --measure groove.nrrd | column sz /dev/stdin | awk '{ print $1 * 1e9 }')" 402.82 0.4
roughgen --points 64 --length 0.25mm --sq 4um --corr 30um --crown 16um | bemcontact --load 5N --young 210GPa |
	debrisgen --yield 355MPa --friction 0.3 --surface w.nrrd 2>err |
	abrade --load 5N --hardness 4GPa --friction 0.1 --slide 0.25mm --surface w.nrrd 2>err | roughgen --measure - >measured.tsv
rising "a surface scratched by its own debris is rougher" \
	"$(roughgen --measure w.nrrd | column sdq /dev/stdin)" "$(column sdq measured.tsv)"
printf 'diameter\tverdict\n1e-5\talone\n1e-5\tunresolved\nnan\tbubble\n1.2e-5\tmisfit\n' >duet.tsv
abrade --gap 9um --hardness 2GPa --friction 0.1 duet.tsv >out 2>err
is "what is no single particle by its verdict is left out and reported" \
	"$(column particle out | wc -l) $(grep -c 'left out\|not resolved' err)" "1 2"
is "doubtful particles are taken in" \
	"$(abrade --gap 9um --hardness 2GPa --friction 0.1 --doubtful duet.tsv 2>err | column diameter /dev/stdin | tr '\n' ' ')" "1e-05 1.2e-05 "
printf 'diameter\trealisation\n1e-5\t7\n' >seventh.tsv
printf 'diameter\tstep\n1e-5\tx\n' >bad.tsv
cat two.tsv two.tsv >twice.tsv
fails "two ensembles with the same numbers" 1 'realisation 0 stands in two parts' \
	abrade --gap 15um --hardness 2GPa --friction 0 twice.tsv
sed 's/^\([01]\)\t/2\1\t/' two.tsv >other.tsv
cat two.tsv other.tsv >four.two
is "two ensembles of other numbers are joined" \
	"$(abrade --gap 15um --hardness 2GPa --friction 0 four.two | grep -vc '^[#r]')" 6
roughgen --points 64 --length 100um --sq 0.5um --corr 10um | cat - h.nrrd >steps.nrrd
fails "two records of one realisation" 3 'steps.nrrd: 1 records are of the realisation of an earlier one' \
	abrade --gap 9.5um --hardness 6GPa,2GPa --friction 0.1 --slide 9um --surface steps.nrrd p.tsv
# The heights say why they are doubtful, to all programs that read them next.
keys() { head -c 1024 "$1" | grep -a '^doubtful:=' | cut -d = -f 2; }
printf '# doubtful: bad balls\ndiameter\taspect\n11e-6\t3\n' >poor.tsv
abrade --gap 9.5um --hardness 2GPa --friction 0.1 --slide 9um --surface h.nrrd poor.tsv >marked.nrrd 2>err
is "grooves of doubtful particles make the surface doubtful" "$? $(keys marked.nrrd)" "3 bad balls"
bemcontact --load 1N --young 210GPa --table contact.tsv marked.nrrd >contact.nrrd 2>err
is "its contact is doubtful" \
	"$? $(keys contact.nrrd) $(grep '^# doubtful' contact.tsv) $(grep -c 'marked.nrrd: doubtful by its own account: bad balls' err)" \
	"3 bad balls # doubtful: bad balls 1"
roughgen --measure marked.nrrd >measured.tsv 2>err
is "so are its areal parameters" "$? $(grep '^# doubtful' measured.tsv)" "3 # doubtful: bad balls"
roughgen --s-filter 10um marked.nrrd 2>err >smooth.nrrd
is "so are its heights when filtered" "$? $(keys smooth.nrrd)" "3 bad balls"
debrisgen --yield 1GPa --friction 0.3 --surface worn.nrrd contact.nrrd >lost.tsv 2>err
is "so are its particles and the worn surface" "$? $(grep -c '^# doubtful: realisation [01]: bad balls' lost.tsv) $(keys worn.nrrd)" \
	"3 2 bad balls"
printf 'diameter\taspect\n11e-6\t3\n' >good.tsv
abrade --gap 9.5um --hardness 2GPa --friction 0.1 --slide 9um --surface marked.nrrd --particles more.tsv good.tsv >again.nrrd 2>err
is "so is the surface after further grooves" "$? $(keys again.nrrd) $(grep '^# doubtful' more.tsv)" \
	"3 bad balls # doubtful: bad balls"
abrade --gap 9.5um --hardness 2GPa --friction 0.1 --slide 9um --surface h.nrrd good.tsv >sound.nrrd
is "a sound surface says nothing" "$? $(keys sound.nrrd)" "0 "
# Three steps of one surface: a groove is there from the step of its particle on.
roughgen --points 64 --length 100um --sq 0.5um --corr 10um --crown 2um | bemcontact --load 1N --young 210GPa |
	debrisgen --yield 1GPa --friction 0.3 --young 210GPa --steps 3 --surface steps.nrrd >/dev/null 2>&1
printf 'step\tdiameter\taspect\trealisation\n2\t11e-6\t3\t0\n1\t10e-6\t3\t0\n2\t9.9e-6\t3\t0\n' >steps.tsv
abrade --gap 9.5um --hardness 6GPa,2GPa --friction 0.1 --slide 90um --surface steps.nrrd --particles worn.tsv \
	--summary s.tsv steps.tsv >worn.nrrd 2>err
is "the steps of a surface are no doubt" "$? $(cat err)" "0 "
for k in 1 2 3; do
	near "up to step $k a surface loses the volume of its particles" \
		"$(awk -v a="$(mean steps.nrrd $((2 * k - 1)))" -v b="$(mean worn.nrrd $k)" 'BEGIN { printf "%.9g", (a - b) * 1e-8 * 1e18 }')" \
		"$(awk -F '\t' -v k=$k '$2 <= k && /^[0-9]/ { s += $9 } END { printf "%.9g", s * 1e18 }' worn.tsv)" 1e-6
done
is "the summary has a row for each step" "$(column step s.tsv | tr '\n' ' ')$(column particles s.tsv | tr '\n' ' ')" "1 2 1 2 "
abrade --load 0.1N --hardness 6GPa,2GPa --friction 0.1 --summary s.tsv steps.tsv >/dev/null
is "each step has its own gap" "$(column load s.tsv | awk '{ printf "%.6f ", $1 }')" "0.100000 0.100000 "
sed 's/^2/4/' steps.tsv >late.tsv
fails "grooves of a step that has no surface" 3 '2 grooves are left out: steps.nrrd has no record of their realisation and step' \
	abrade --gap 9.5um --hardness 6GPa,2GPa --friction 0.1 --slide 90um --surface steps.nrrd late.tsv
cat steps.nrrd steps.nrrd >steps.twice
fails "two records of one step" 3 'steps.twice: 3 records are of the realisation and step of an earlier one' \
	abrade --gap 9.5um --hardness 6GPa,2GPa --friction 0.1 --slide 90um --surface steps.twice steps.tsv
fails "a step that is no number" 1 'line 2: .*step' abrade --gap 9.5um --hardness 6GPa --friction 0.1 bad.tsv
fails "grooves of a realisation that has no surface" 3 '1 grooves are left out: h.nrrd has no record' \
	abrade --gap 9.5um --hardness 2GPa --friction 0.1 --motion groove --slide 1um --surface h.nrrd seventh.tsv
abrade --gap 9.5um --hardness 2GPa --friction 0.1 --motion groove --surface h.nrrd p.tsv >worn.nrrd 2>err
is "grooves that are longer than the surface are reported" "$(grep -c 'in the same track' err)" 1
# drawn into gaps of (25 um - 2 0.1^2 1 mm) / 1.01 = 4.95 um and more
printf 'diameter\n2.5e-5\n' >wide.tsv
abrade --load 1mN --hardness 2GPa --friction 0.1 --inlet 1mm wide.tsv >wide.out
near "a particle that a narrow gap rejects carries the load in a wide one" "$(cell load wide.out)" 1e-3 1e-9
# 10 um are drawn into gaps of (10 um - 2 0.01^2 0.5 mm) / 1.0001 = 9.899 um and more only
printf 'diameter\n1e-5\n5e-6\n' >thin.tsv
abrade --load 2mN --hardness 2GPa --friction 0.01 --inlet 0.5mm thin.tsv >thin.out 2>err
is "the gap is found in which a particle is admitted to a range of 1 %" \
	"$(column load thin.out | awk '{ printf "%.6g ", $1 }')" "0.002 0 "

p="--hardness 2GPa --friction 0.1"
fails "neither gap nor load" 2 'specify either --gap H or --load F' abrade $p four.tsv
fails "no hardness" 2 '\--hardness is missing' abrade --gap 1um --friction 0.1 four.tsv
fails "no friction" 2 '\--friction is missing' abrade --gap 1um --hardness 2GPa four.tsv
fails "a code and a table" 2 'not both' abrade --gap 1um $p --iso 18:16:13 four.tsv
fails "a code without an area" 2 'requires --area' abrade --gap 1um $p --iso 18:16:13 --largest 70um
fails "a code without a largest particle" 2 'requires --largest or --inlet' abrade --gap 1um $p --iso 18:16:13 --area 1mm2
fails "a code that grows" 2 'must not increase with size' abrade --gap 1um $p --iso 13:16:18 --area 1mm2 --largest 70um
fails "a code that does not tell the sizes above 14 um" 2 'want a lower third number' \
	abrade --gap 1um $p --iso 18:16:16 --area 1mm2 --largest 70um
abrade --gap 2um $p --iso 19:19:13 --area 1m2 --largest 50um >equal.tsv 2>err
is "particles between the gap and 4 um, which a code does not count, are reported" \
	"$? $(grep -c 'are missing' err) $(grep '^# doubtful' equal.tsv)" '3 1 # doubtful: particles between the gap and 4 um are missing'
# 5000 - 5000 (50/6)^(-log(5000/80)/log(14/6)) a millilitre in 2 ml, none of them between 4 and 6 um
near "a code of equal numbers at 4 and 6 um has none between" \
	"$(awk '!/^[#r]/ { n++; small += $3 < 5.999e-6 } END { print small ? 0 : n }' equal.tsv)" \
	"$(awk 'BEGIN { k = log(5000 / 80) / log(14 / 6); print 2 * 5000 * (1 - (50 / 6) ^ -k) }')" 400
fails "a code where a table is read" 2 'are for --iso' abrade --gap 1um $p --largest 70um four.tsv
cp h.nrrd kept.nrrd
printf 'realisation\tdiameter\n1\t1e-5\n2\t1e-5\n2\t9e-6\n' >three.tsv
fails "buried particles of two realisations" 3 ' 0 particles yield and 3 are buried' \
	abrade --gap 1um $p --motion groove three.tsv
fails "a surface that is overwritten" 2 'the same file is read and written' \
	abrade --gap 9um $p --surface kept.nrrd --particles kept.nrrd four.tsv
same "it is kept" h.nrrd kept.nrrd
fails "a table without a surface to leave standard output to" 2 '\--surface is given' abrade --gap 1um $p --particles x four.tsv
{ cat four.tsv && echo '# doubtful: pulses differ'; } >self.tsv
fails "a table that calls itself doubtful" 3 'self.tsv: doubtful by its own account: pulses differ' abrade --gap 9um $p self.tsv
abrade --gap 9um $p --summary summary self.tsv >out 2>err
is "its tables repeat why" "$(cat out summary | grep -c '^# doubtful: pulses differ')" 2
# Particles of a surrogate, and those without end on a periodic grid, have no aspect.
printf 'diameter\taspect\n10e-6\t3\n10e-6\tnan\n' >endless.tsv
abrade --gap 9um $p endless.tsv >rows.tsv 2>err
is "a particle whose aspect is unknown is a sphere, which a warning says" \
	"$? $(column mode rows.tsv | tr '\n' ' ')$(grep -c 'particles without aspect are spheres' err)" "0 grooves rolls 1"
printf 'diameter\taspect\n1e-6\t0.5\n' >flat.tsv
fails "an aspect below one" 1 'line 2: aspect is 0.5, want 1 or more' abrade --gap 1um $p flat.tsv
fails "a diameter of 10 metres" 1 'line 2: diameter is 10 m, want metres' sh -c "printf 'diameter\n10\n' | abrade --gap 1um $p"
fails "no column of diameters" 1 "no column 'diameter'" abrade --gap 1um $p st
fails "an empty stream" 1 'empty, want table' abrade --gap 1um $p
done_testing

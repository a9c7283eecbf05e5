#!/bin/sh
# Raw samples and text out of streams of fields and back in, bit for bit
. "$(dirname "$0")/tap.sh"

surfaces='roughgen --points 16x12 --length 1.6mmx1.1mm --sq 1um --corr 300um'
$surfaces --count 3 >surfaces
bemcontact --load 1N --young 210GPa,210GPa surfaces >contacts 2>/dev/null
debrisgen --yield 1MPa --friction 0.3 --steps 2 --stress-layers 3 --stress stress contacts >particles.tsv 2>/dev/null

for f in surfaces contacts stress; do
	records --output table "$f" >"$f.tsv" 2>err
	ok "a table of $f has its end" records --check "$f.tsv"
	records --output nrrd "$f.tsv" >again 2>err
	same "$f: the records of a table have the bytes of the stream" "$f" again
done
records --output table <contacts | records --output nrrd >again
same 'conversion through pipes gives the same bytes' contacts again
is 'a table of points is listed as its records are' "$(records contacts.tsv | cksum)" "$(records contacts | cksum)"
is 'converted records are counted' "$(records --output count stress.tsv)" "$(records --output count stress)"
records --output nrrd --pick 2 contacts.tsv >again
records --output nrrd --pick 2 contacts >want
same 'one converted record is picked' want again

# A key that one record alone has, such as that of a solver that gave up
roughgen --points 4 --length 1mm --sq 1um --corr 300um --count 2 | sed '0,/^seed:=/s/^seed:=1/seed:=1\nodd:=yes/' |
	sed '/^stream:=/d' >odd 2>/dev/null
records --output table odd | records --output nrrd >again
is 'a key of one record does not pass to the next' "$(grep -ac '^odd:=yes' again)" 1
# What converts samples alone, or shows them, tells that they are doubtful.
roughgen --points 4 --length 1mm --sq 1um --corr 300um | sed 's/^seed:=1/seed:=1\ndoubtful:=worn/' |
	sed '/^stream:=/d' >worn 2>/dev/null
for o in gsf raw; do
	fails "doubtful samples written as $o" 3 'worn: doubtful by its own account: worn' records --output $o worn
done
records worn >list 2>err
is 'the list of doubtful records says why' "$? $(grep '^# doubtful' list)" '3 # doubtful: worn'
is 'so do their samples as text' "$(records --output text worn | grep '^# doubtful')" '# doubtful: worn'
roughgen --points 16 --length 1mm --sq 1um --corr 200um | bemcontact --pressure 1MPa --estar 100GPa \
	--max-iterations 1 >early 2>err
for o in list gsf raw; do
	fails "pressures that did not converge, as $o" 3 'early: doubtful by its own account: a contact did not converge' \
		records --field pressure --output $o early
done
is 'nor did those written as text' "$(records --field pressure --output text early | grep '^# doubtful')" \
	'# doubtful: a contact did not converge'
ok 'heights do not depend on the contact' records --field height --output raw early

# samples FILE: those of a stream, in its order
samples() {
	records --output table "$1" | grep -v '^#' | cut -f 5-
}
names() {
	records "$1" | awk -F '\t' '/^#/ || /^record/ { next } $1 == 1 { printf "%s%s %s", n++ ? "," : "", $3, $4 }'
}
records --output raw surfaces >raw
is 'raw has 8 bytes a sample' "$(wc -c <raw)" $((16 * 12 * 3 * 8))
is 'raw heights read back' "$(samples surfaces | cksum)" \
	"$(records --raw 16x12 --pixel 0.1mm --output nrrd raw | samples - | cksum)"
records --output raw contacts >raw
records --raw 16x12 --pixel 0.1mm --fields "$(names contacts)" --output nrrd raw >back
is 'raw fields read back, with names and units' "$(samples contacts | cksum) $(names contacts)" \
	"$(samples back | cksum) $(names back)"
size=$(records stress | awk -F '\t' '$1 == 1 { print $5 "x" $6 "x" $7; exit }')
spacing=$(records --output table --pick 1 stress | grep -v '^[#r]' | awk '{ x = x ? x : 2 * $2; y = y ? y : 2 * $3 } $4 > 0 { printf "%.17gx%.17gx%.17g", x, y, $4; exit }')
records --output raw stress >raw
records --raw "$size" --pixel "$spacing" --fields "$(names stress)" --output nrrd raw >back
is 'raw layers read back' "$(samples stress | cksum)" "$(samples back | cksum)"
is 'volumes keep their depth' "$(records --output table --pick 1 stress | grep -v '^#' | cut -f 4 | uniq | cksum)" \
	"$(records --output table --pick 1 back | grep -v '^#' | cut -f 4 | uniq | cksum)"
records --output text --pick 1 surfaces >matrix
surfimport --pixel 100um --height-unit 1m matrix | samples - >back
records --pick 1 --output nrrd surfaces | samples - >want
same 'a matrix of text has all digits' want back

py=python3
$py -c 'import numpy' 2>/dev/null || py=/usr/bin/python3
if $py -c 'import numpy' 2>/dev/null; then
	records --output raw contacts >raw
	k=$(names contacts | tr ',' '\n' | grep -c .)
	is 'numpy reads raw samples and the table the same' "$(K=$k $py - <<-'END'
		import os, numpy as np
		k = int(os.environ['K'])
		r = np.fromfile('raw', '<f8').reshape(3, 12, 16, k)
		rows = [l.split('\t') for l in open('contacts.tsv') if l[0] != '#'][1:]
		t = np.array(rows, float)[:, 4:].reshape(3, 12, 16, k)
		print((r == t).all())
	END
	)" True
else
	records --output raw contacts >raw
	skip 'numpy reads raw samples and the table the same' 'no numpy'
fi

head -c 1000 raw >cut
fails 'raw samples that are cut off' 1 'want [0-9]* bytes, got' records --raw 16x12 --pixel 1um cut
fails 'names without --raw' 2 'requires --raw' records --fields 'height m' surfaces
fails 'three spacings of a plane' 2 'no layers' records --raw 4x4 --pixel 1umx1umx1um raw
fails 'two fields of one name' 1 'names of 2 fields' records --raw 16x12 --pixel 1um --fields 'a m,a m' raw
fails 'a size that no memory holds' 1 'raw' records --raw 1000000000x1000000000x1000000000 --pixel 1umx1umx1um raw
fails 'a table of particles' 1 'not of the points of fields' records --output nrrd particles.tsv
head -c -60 contacts.tsv >cut
records --output nrrd cut >out 2>err
is 'a table that is cut off gives status 1 and one line' "$? $(wc -l <err)" '1 1'
grep -v '^[#]' surfaces.tsv | sed 5d >rows
{
	sed -n '/^#/p; /^realisation/q' surfaces.tsv | grep -v '^# \(stream\|end\)'
	cat rows
} | sed '1i # stream: other' >hole
fails 'a table with a point missing' 1 'is not a regular grid' records --output nrrd hole
done_testing

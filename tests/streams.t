#!/bin/sh
# Field streams: what is read, what is refused and in which words; other tools read ours
. "$(dirname "$0")/tap.sh"

# header LINE...: an NRRD header for 4 x 3 points, lines replaced or added by argument
header() {
	{
		printf '%s\n' NRRD0004 'type: double' 'dimension: 2' 'sizes: 4 3' \
			'spacings: 1e-6 2e-6' 'endian: little' 'encoding: raw' \
			'units: m m' 'sample units: m'
		printf '%s\n' "$@"
	} | awk -F ': ' '{ k = /^NRRD/ || /^#/ ? $0 : $1; if (!(k in seen)) order[++n] = k
		seen[k] = $0 } END { for (i = 1; i <= n; i++) if (seen[order[i]] != "") print seen[order[i]]; print "" }'
}
# ramp: 12 little-endian doubles 0 1 2 ... 11
ramp() {
	for bytes in '000\000' '360\077' '000\100' '010\100' '020\100' '024\100' '030\100' \
		'034\100' '040\100' '042\100' '044\100' '046\100'; do
		printf "\\000\\000\\000\\000\\000\\000\\$bytes"
	done
}
big_endian_ramp() {
	for bytes in '000\000' '077\360' '100\000' '100\010' '100\020' '100\024' '100\030' \
		'100\034' '100\040' '100\042' '100\044' '100\046'; do
		printf "\\$bytes\\000\\000\\000\\000\\000\\000"
	done
}
cell() {
	column "$1" out | head -n 1
}

{ header ''; ramp; } >plain.nrrd
ok 'a plain two-dimensional NRRD is read' records plain.nrrd
is 'the size and spacing of a plain NRRD are read' "$(cell nx) $(cell ny) $(cell dx) $(cell dy)" '4 3 1e-06 2e-06'
is 'the samples of a plain NRRD are read' "$(cell min) $(cell mean) $(cell max)" '0 5.5 11'
# unstated WHAT FILE: the program names what has no unit
unstated() {
	records "$2" >out 2>err
	is "the unit of $1 is missing" "$? $(cat err)" "0 records: $2: no unit of $1 in the header: metres are assumed"
}
{ header 'sample units: ' 'units: '; ramp; } >none.nrrd
unstated 'spacings and heights' none.nrrd
{ header 'sample units: ' 'units: um um'; ramp; } >axes.nrrd
unstated heights axes.nrrd
{ header 'units: '; ramp; } >samples.nrrd
unstated spacings samples.nrrd
{ header 'endian: big'; big_endian_ramp; } >big.nrrd
ok 'a big-endian NRRD is read' records big.nrrd
is 'the samples of a big-endian NRRD are read' "$(cell min) $(cell mean) $(cell max)" '0 5.5 11'
{ header 'units: "um" "um"' 'spacings: 1 2'; ramp; } >um.nrrd
ok 'units of length are read' records um.nrrd
is 'units of length are converted to metres' "$(cell dx) $(cell dy)" '1e-06 2e-06'
records -o nrrd plain.nrrd >ours.nrrd
records -o nrrd ours.nrrd >again.nrrd
same 'a record that is read and written has the same bytes' ours.nrrd again.nrrd
is 'the header is a multiple of 1024 bytes' "$(($(wc -c <ours.nrrd) % 1024))" 96
ok 'a plane field is written as GSF' records -o gsf plain.nrrd
mv out plain.gsf
is 'GSF keeps the spacing' "$(records plain.gsf | grep '^1' | cut -f 8,9,12)" "$(printf '1e-06\t2e-06\t11')"
# Heights 1, 2, 3 and 4 nm on two by two samples of 0.5 um, little-endian float32.
{
	printf 'Gwyddion Simple Field 1.0\nXRes = 2\nYRes = 2\nXReal = 1\nYReal = 1\nXYUnits = um\nZUnits = nm\n\0\0\0'
	printf '\0\0\200\077\0\0\0\100\0\0\100\100\0\0\200\100'
} >units.gsf
sed 's/^ZUnits = nm$/Title = abc/' units.gsf >none.gsf
unstated heights none.gsf
is 'units of GSF are converted in every sample' "$(records -o text units.gsf |
	awk '!/^#/ { for (i = 1; i <= NF; i++) printf "%.6g ", $i }')" '1e-09 2e-09 3e-09 4e-09 '
is 'units of the sides of GSF are converted' "$(records units.gsf | grep '^1' | cut -f 8,9)" "$(printf '5e-07\t5e-07')"
ramp >plain.raw
ok 'headerless samples are read' records --raw 4x3 --pixel 2um plain.raw
is 'headerless samples have the given spacing' "$(cell dx) $(cell max)" '2e-06 11'
ok 'headerless samples have the given spacing along x and y' records --raw 4x3 --pixel 2umx3um plain.raw
is 'the spacing along y is kept' "$(cell dx) $(cell dy)" '2e-06 3e-06'
# The bytes of 4 floats of 0.5 um to 1 um, and of 4 numbers near 0.1 of the other byte order
printf '\275\067\006\065%.0s' 1 2 3 4 >float.raw
printf '\077\271\231\231\231\231\231\177%.0s' 1 2 >swapped.raw
fails 'headerless samples of float32' 1 'record 1: samples of up to .*: not little-endian float64?' records --raw 2x1 --pixel 2um float.raw
# Heights of float32 near 1, which have possible magnitudes in pairs
perl -e 'srand 3; print pack "f<*", map { rand() - 0.5 } 1 .. 200' >pairs.raw
fails 'headerless samples that are pairs of float32' 1 'record 1: the samples look like float32' records --raw 10x10 --pixel 2um pairs.raw
# Four waves of 120 samples, 82 of whose float64 differ, but most by rounding alone
perl -e 'print pack "d<*", map { 1e-6 * cos(2 * 3.14159265358979 * (4 * ($_ % 120) / 120)) } 0 .. 5999' >waves.raw
is 'waves that repeat are no pairs of float32' "$(records -o count --raw 120x50 --pixel 1um waves.raw)" 1
fails 'headerless samples of the other byte order' 1 'not little-endian float64?' records --raw 2x1 --pixel 2um swapped.raw
fails 'a pixel of no samples' 2 '--raw and --pixel go together' records --pixel 2um plain.raw
# Keys of records that other programs write
for k in 'boundary PERIODIC free or periodic' 'converged No yes or no' 'hardness 5GPa a number' 'estar 1e11x a number'; do
	set -- $k
	{ header "$1:=$2"; ramp; } >key.nrrd
	fails "a key $1 that cannot be read" 1 "record 1: key $1 is '$2', want ${k#* * }" records key.nrrd
done
cat plain.nrrd big.nrrd plain.gsf >three
is 'records of three formats may follow each other' "$(records -o count three)" 3
ok 'an empty stream has no records' sh -c 'records -o count </dev/null'
is 'an empty stream is not an error' "$(cat out)" 0
for p in 'bemcontact -F 1N --estar 1GPa' 'debrisgen -Y 1GPa' 'records -o nrrd' 'records --pretty' 'roughgen -'; do
	fails "${p%% *} needs a record" 1 "^${p%% *}: standard input: empty, want" $p
	is 'an empty stream gives no output' "$(wc -c <out)" 0
done
fails 'two records for GSF' 2 'GSF holds one plane field' sh -c 'cat plain.nrrd big.nrrd | records -o gsf'
is 'a failed program writes no record' "$(wc -c <out)" 0
is 'a record keeps keys with escapes' \
	"$({ header 'key:=a \\ b'; ramp; } | records -o nrrd | grep -a '^key')" 'key:=a \\ b'
is 'a record keeps a value that begins with a blank' \
	"$({ header 'key:= b: c' 'empty:='; ramp; } | records -o nrrd | grep -a -e ^key -e ^empty)" \
	"$(printf 'key:= b:c\nempty:=')"
ok 'the second record is selected' sh -c 'records --pick 2 -o nrrd three | records -o count'
is 'the selected record is one record' "$(cat out)" 1
fails 'picking what is not there' 1 'three: no record 4: there are 3' records --pick 4 three

# Refusals: one line each, naming the record and what was wanted.
refuse() {
	name=$1
	pattern=$2
	shift 2
	{ header "$@"; ramp; } >bad.nrrd
	fails "$name" 1 "$pattern" records bad.nrrd
}
for line in '/^sizes/' '/^type/s/type/TYPE/' 's/^endian.*/key:=1\nkey:=2/'; do
	{
		printf '%s\n' NRRD0004
		header '' | LC_ALL=C sed -n "${line}p"
		header '' | sed 1d
		ramp
	} >twice.nrrd
	fails "a field of the header that is given twice ($line)" 1 "twice.nrrd: record 1: '[a-z]*' is given twice" records twice.nrrd
done
{ header ''; ramp | head -c 50; } >short.nrrd
fails 'a truncated record' 1 'short.nrrd: record 1: want 96 bytes, got 50' records short.nrrd
fails 'a truncated record in a pipe' 1 'standard input: record 1: want 96 bytes, got 50' \
	sh -c 'cat short.nrrd | records'
cat plain.nrrd short.nrrd >second.nrrd
fails 'truncation names the record' 1 'record 2: want 96 bytes, got 50' records second.nrrd
printf 'NRRD0004\ntype: double\n' >cut.nrrd
fails 'a header cut off' 1 'record 1: the stream ends inside the header' records cut.nrrd
printf 'GIF89a\n' >gif
fails 'another format' 1 "this is a picture, want fields" records gif
{ printf 'NRRD0004\n# '; head -c 2000000 /dev/zero | tr '\0' x; } >endless
fails 'an endless header' 1 'header longer than 1048576 bytes' records endless
refuse 'a negative size' 'size -4, want a whole number' 'sizes: -4 3'
refuse 'a fractional size' 'size 4.5, want a whole number' 'sizes: 4.5 3'
refuse 'an enormous size' 'bytes of samples are too many' 'sizes: 1000000000 1000000000'
refuse 'a large size without the samples' 'want 32000000 bytes, got 96' 'sizes: 4000 1000'
refuse 'a spacing of zero' 'spacing of axis 0 is 0 m, want 1e-30 to 1e30' 'spacings: 0 1'
refuse 'a spacing that is nan' 'spacing of axis 1 is nan' 'spacings: 1 nan'
refuse 'a spacing beyond all surfaces' 'spacing of axis 1 is 1e+300 m' 'spacings: 1 1e300'
refuse 'a realisation beyond counting' "realisation: '99999999999999999999' is not" \
	'realisation:=99999999999999999999'
refuse 'no spacing' "NRRD header without 'spacings'" 'spacings: '
refuse 'a type we do not read' 'type short: want double or float' 'type: short'
refuse 'compressed samples' 'encoding gzip: want raw' 'encoding: gzip'
refuse 'an unknown byte order' "endian: 'pdp' is not understood" 'endian: pdp'
refuse 'a detached header' "NRRD field 'data file' is not supported" 'data file: x.raw'
refuse 'units of axes that have none' "NRRD field 'space units' is not supported" 'space units: "um" "um"'
refuse 'too few sizes' 'want 2 sizes and spacings, got 1 and 2' 'sizes: 4'
refuse 'five dimensions' 'dimension 5: want 2, 3 or 4' 'dimension: 5'
{ header 'sample units: um'; ramp; } >um.nrrd
{ header 'fields:=height um'; ramp; } >named.nrrd
is "heights in micrometres are converted" "$(records um.nrrd | column max /dev/stdin) $(records named.nrrd | column unit /dev/stdin)" \
	"$(records plain.nrrd | column max /dev/stdin | awk '{ print $1 * 1e-6 }') m"
refuse 'heights that are no lengths' "height is in 'V', want m" 'fields:=height V'
refuse 'a unit for one axis of two' 'want a unit for each of 2 axes, got 1' 'units: "um"'
refuse 'a unit that is no length' "unit 's' of axis 0 is not a length" 'units: "s" "s"'
refuse 'more names than fields' 'want the names of 1 fields' 'fields:=height m, pressure Pa'
{ cat plain.nrrd; header 'fields:=gap m'; ramp; } >gap.nrrd
fails 'one table of records with different fields' 1 \
	'gap.nrrd: record 2 has fields gap, the first one height' records -o table gap.nrrd
{ header ''; ramp | head -c 88; printf '\234\165\000\210\074\344\067\176'; } >huge.nrrd # 1e300
fails 'heights that overflow' 1 'record 1: height 1e+300 m is too large' roughgen --measure huge.nrrd

# What is read is not written, and nothing is written twice.
roughgen -n 16 -q 1nm -L 1um | bemcontact -F 1uN -E 1GPa >contact.nrrd
cp contact.nrrd kept.nrrd
wear='debrisgen -Y 1GPa'
fails 'an output that is the input' 2 'contact.nrrd: the same file is read and written' \
	$wear --surface contact.nrrd contact.nrrd
fails 'standard input as an output' 2 'contact.nrrd: the same file is read and written' \
	sh -c "$wear --summary ./contact.nrrd <contact.nrrd"
fails 'counters that are written to an input' 2 'contact.nrrd: the same file is read and written' \
	$wear -S contact.nrrd contact.nrrd
ln -s contact.nrrd link
fails 'an input under another name as an output' 2 'link: the same file is read and written' $wear --stress link contact.nrrd
same 'a refused output leaves the input unchanged' contact.nrrd kept.nrrd
fails 'two outputs that are one file' 2 'x: the same file is written twice' \
	$wear --surface x --summary x contact.nrrd
fails 'an output that is standard output' 2 'x: the same file is written twice' \
	sh -c "$wear --summary x contact.nrrd >x"
fails 'an output without a name' 2 '^debrisgen: -: an output requires a file name' \
	$wear --surface - contact.nrrd
fails 'counters without a name' 2 '^debrisgen: -: an output requires' $wear -S - contact.nrrd
ok '/dev/null may be named twice as output' $wear --surface /dev/null --summary /dev/null contact.nrrd
seq 1000 >old
ok 'an old file exists' $wear --summary old -S old.stats contact.nrrd
is 'an old file is overwritten' "$(grep -c '^[0-9]' old)" 1
cp old old.stats
ok 'old counters exist' $wear -S old.stats contact.nrrd
is 'old counters are overwritten' "$(wc -l <old.stats)" 2

fails 'no room left on the device' 1 'standard output: No space left' \
	sh -c 'records -o nrrd plain.nrrd >/dev/full'

# Standard input, output and error that are closed
fails 'standard output closed' 1 'standard output: Bad file descriptor' sh -c 'records plain.nrrd >&-'
fails 'standard input closed' 1 'standard input: Bad file descriptor' sh -c 'records <&-'
ok 'a program runs with standard error closed' sh -c "$wear --summary closed.tsv --steps 2 contact.nrrd 2>&-"
ok 'no message is written to an output file' records --check closed.tsv
fails 'standard output closed beside a side output' 1 'Bad file descriptor' \
	sh -c "$wear --summary closed.tsv contact.nrrd >&-"
fails 'counters that are standard output' 2 'x: the same file is written twice' sh -c 'records --output count -S x plain.nrrd >x'
cp plain.nrrd same.nrrd
fails 'standard output that is the input' 2 'same.nrrd: the same file is read and written' \
	sh -c 'records --output text same.nrrd 1<>same.nrrd'
same 'a refused output leaves the file unchanged' plain.nrrd same.nrrd

# Text from outside stays within its line.
fails 'a newline in a value' 1 "realisation: 'a.nall is well' is not understood" \
	sh -c "printf 'NRRD0004\\nrealisation:=a\\\\nall is well\\n\\n' | records"
fails 'control characters' 1 'type .x1b.31mred: want' sh -c "printf 'NRRD0004\\ntype: \\033[31mred\\n\\n' | records"
fails 'a name of two lines' 1 "^records: 'a.nb': No such file" records "$(printf 'a\nb')"
is 'a header line cannot be forged' "$({ header 'key:=a\nsizes: 1 1 1'; ramp; } | records --output nrrd | grep -ac '^sizes')" 1
{ header $(seq -f 'key%g:=1' 1001); ramp; } >keys.nrrd
fails 'more than 1000 keys' 1 'more than 1000 keys' records keys.nrrd
{ header 'k1:=1' 'k2:=2'; ramp; } >keys.nrrd
fails 'more keys than a lowered limit' 1 'more than 1 keys' env WEARPIPE_LIMITS=keys=1 records keys.nrrd
fails 'a record above a lowered limit' 1 'bytes of samples are too many' env WEARPIPE_LIMITS=bytes=4 records keys.nrrd
fails 'a header above a lowered limit' 1 'header' env WEARPIPE_LIMITS=header=30 records keys.nrrd

# Other tools, where they are installed
if /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
	is 'numpy reads a record' "$(/usr/bin/python3 -c "
import numpy as np
h, = np.fromfile('ours.nrrd', '<f8', offset=1024).reshape(3, 4, 1).transpose(2, 0, 1)
print(h[2, 3], h[1, 0])")" '11.0 4.0'
	cat ours.nrrd ours.nrrd >two.nrrd
	is 'numpy reads an ensemble' "$(/usr/bin/python3 -c "
import numpy as np
a = np.fromfile('two.nrrd', [('hdr', 'S1024'), ('a', '<f8', (3, 4, 1))])['a']
print(a.shape, a[1, 2, 3, 0])")" '(2, 3, 4, 1) 11.0'
else
	skip 'numpy reads a record' 'no numpy'
	skip 'numpy reads an ensemble' 'no numpy'
fi
if command -v gnuplot >/dev/null; then
	gnuplot -e "set table 'gp.txt'; plot 'ours.nrrd' binary skip=1024 array=(4,3) format='%double' endian=little using 1 with image" 2>err
	is 'gnuplot reads a record' "$(awk '!/^#/ && NF >= 3 { m = $3 > m ? $3 : m; n++ } END { print n, m }' gp.txt)" '12 11'
else
	skip 'gnuplot reads a record' 'no gnuplot'
fi
if command -v octave >/dev/null; then
	is 'Octave reads a record' "$(octave --no-gui --norc --eval "f=fopen('ours.nrrd');fseek(f,1024,0);e=reshape(fread(f,inf,'double'),1,4,3);printf('%g %g',e(1,4,3),e(1,1,2))" 2>/dev/null)" '11 4'
else
	skip 'Octave reads a record' 'no octave'
fi
if command -v teem-unu >/dev/null; then
	is 'teem reads a record' "$(teem-unu minmax ours.nrrd | awk '{ print $2 }' | tr '\n' ' ')" '0 11 '
else
	skip 'teem reads a record' 'no teem-unu'
fi
done_testing

#!/bin/sh
# surfimport and surfunzip: measured heights in the formats of instruments, and what is wrong
# with them
. "$(dirname "$0")/tap.sh"

# heights FILE: all samples of a stream in metres to 12 digits, separated by blanks.  A unit
# that is multiplied with a whole number rounds in the last digit.
heights() {
	records -o text "$1" | awk '!/^#/ { for (i = 1; i <= NF; i++) {
		out = out (out == "" ? "" : " ") ($i == "nan" ? $i : sprintf("%.12g", $i)) } }
		END { print out }'
}
# list COLUMN FILE
list() {
	records "$2" >list.tsv
	column "$1" list.tsv
}

# Matrices of text.
printf '1\t2\t3\n4\tnan\t6\n' >tab.txt
surfimport --pixel 1umx2um --height-unit 1um tab.txt >a.nrrd
is "a matrix of text is read" "$(heights a.nrrd)" "1e-06 2e-06 3e-06 4e-06 nan 6e-06"
is "a matrix of text has the given spacing" "$(list dx a.nrrd) $(list dy a.nrrd)" "1e-06 2e-06"
printf '1,5;2;3\r\n4;;6\r\n' >comma.csv
surfimport --pixel 1um --height-unit 1m comma.csv >b.nrrd
is "semicolons and decimal commas are read" "$(heights b.nrrd)" "1.5 2 3 4 nan 6"
printf ';;\n1;2;3\n;;\n4;5;' >empty.csv
surfimport --pixel 1um --height-unit 1m empty.csv >b.nrrd 2>err
is "rows of empty cells are rows of missing samples" "$(heights b.nrrd)" "nan nan nan 1 2 3 nan nan nan 4 5 nan"
is "a last line without newline is reported" "$(grep -c 'line 4: no newline at the end' err)" 1
printf 'Height;;\n;;\n1;2;3\n' >titled.csv
is "a row of empty cells below a heading is none" \
	"$(surfimport --pixel 1um --height-unit 1m titled.csv | heights /dev/stdin)" "1 2 3"
printf '1,5,2\n4,BAD,6\n' >plain.csv
surfimport --pixel 1um --height-unit 1m plain.csv >b.nrrd
is "commas are read as separators" "$(heights b.nrrd)" "1 5 2 4 nan 6"
printf '# by hand\nheights of a plate\n 1.5   -2e-3 \n4 6 \n' >blank.txt
surfimport --pixel 1um --height-unit 1m blank.txt >b.nrrd
is "blanks, comments and a heading are read" "$(heights b.nrrd)" "1.5 -0.002 4 6"
printf '# by A, on a Monday; 2 rows\n1,2\n3,4\n' >comment.csv
surfimport --pixel 1um --height-unit 1m comment.csv >b.nrrd 2>err
is "a comment with separators is no row" "$(heights b.nrrd)" "1 2 3 4"
printf '# Channel: Topography\n# Width: 6.00 \302\265m\n# Height: 3.00 \302\265m\n# Value units: nm\n1\t2\t3\n4\t5\t6\n' >gwyddion.txt
surfimport gwyddion.txt >b.nrrd
is "the spacing and unit of a matrix from Gwyddion are read" "$(heights b.nrrd) $(list dx b.nrrd) $(list dy b.nrrd)" \
	"1e-09 2e-09 3e-09 4e-09 5e-09 6e-09 2e-06 1.5e-06"
fails "a spacing other than that of Gwyddion" 1 'not --pixel' surfimport --pixel 2um gwyddion.txt
fails "a unit of heights other than that of Gwyddion" 1 'not --height-unit' surfimport --height-unit 1m gwyddion.txt
sed 's/units: nm/units: V/' gwyddion.txt >volt.txt
fails "a matrix of volts" 1 "line 4: 'V' is not a unit of length" surfimport volt.txt
printf '1,5 2,25\n4,0 6,5\n' >german.txt
surfimport --pixel 1um --height-unit 1m german.txt >b.nrrd
is "decimal commas separated by blanks are read" "$(heights b.nrrd)" "1.5 2.25 4 6.5"
printf '\377\3761\0,\0002\0\n\0003\0,\0004\0\n\0' >utf16.csv
surfimport --pixel 1um --height-unit 1m utf16.csv >b.nrrd
is "UTF-16 with a byte order mark is read" "$(heights b.nrrd)" "1 2 3 4"
surfimport --pixel 1um --height-unit 1m --missing 99 <<-'END' >b.nrrd
	1 99
	3 4
END
is "--missing marks a number as missing" "$(heights b.nrrd)" "1 nan 3 4"
printf 'X_(microns),height [nm]\n10,1\n12,2\n14,3\n' >profile.csv
surfimport --profile profile.csv >p.nrrd
is "the units of a profile are those of its headings" "$(heights p.nrrd) $(list dx p.nrrd) $(list ny p.nrrd)" \
	"1e-09 2e-09 3e-09 2e-06 1"
printf 'x (mm), height (nm)\n10\t1\n12\t2\n14\t3\n' >profile.csv
surfimport --profile profile.csv >p.nrrd
is "headings need not have the separator of the rows" "$(heights p.nrrd) $(list dx p.nrrd)" "1e-09 2e-09 3e-09 0.002"
printf 'x [mm] height [nm]\n10\t1\n12\t2\n14\t3\n' >profile.csv
fails "units of headings that cannot be divided" 1 'does not state the unit' surfimport --profile profile.csv
roughgen --measure --fill a.nrrd >m.tsv
is "roughgen reads the result" "$(column sz m.tsv)" 5e-06

# Binary files, made byte by byte.
le16() { for v in "$@"; do printf "\\$(printf %03o $((v & 255)))\\$(printf %03o $((v >> 8 & 255)))"; done; }
le32() { for v in "$@"; do le16 $((v & 65535)) $((v >> 16 & 65535)); done; }
zeros() { head -c "$1" /dev/zero; }
{
	printf '\223NUMPY\001\000'
	le16 70
	printf "%-69s\n" "{'descr': '<i2', 'fortran_order': False, 'shape': (2, 3), }"
	le16 1 2 3 4 5 65535
} >i.npy
surfimport --pixel 1um --height-unit 1um i.npy >b.nrrd
is "npy with integers is read" "$(heights b.nrrd)" "1e-06 2e-06 3e-06 4e-06 5e-06 -1e-06"
sed "s/False/True /" i.npy >f.npy
surfimport --pixel 1umx2um --height-unit 1um f.npy >b.nrrd
is "npy in Fortran order is read" "$(heights b.nrrd) $(list dy b.nrrd)" "1e-06 3e-06 5e-06 2e-06 4e-06 -1e-06 2e-06"
{
	printf 'bISO-1.0%10s%12s%12s' x 010120200000 010120200000
	le16 3 2
	# 1e-6, 2e-6, 1e-9 and 0 as doubles
	printf '\215\355\265\240\367\306\260\076\215\355\265\240\367\306\300\076\225\326\046\350\013\056\021\076'
	zeros 8
	printf '\0\005\0'
	le16 10 20 30 40 32768 60
} >b.sdf
surfimport b.sdf >b.nrrd
is "binary SDF with a missing sample is read" "$(heights b.nrrd) $(list dx b.nrrd) $(list dy b.nrrd)" \
	"1e-08 2e-08 3e-08 4e-08 nan 6e-08 1e-06 2e-06"
# 1, -9999.9 as float32
printf '\000\000\200\077\232\077\034\306' >single.f32
surfimport --format raw --size 2x1 --type float32 --pixel 1um --height-unit 1m --missing -9999.9 single.f32 >b.nrrd
is "a missing sample is rounded as the samples are" "$(heights b.nrrd)" "1 nan"
cat >a.sdf <<-'END'
	aISO-1.0
	ManufacID = x
	NumPoints = 2
	NumProfiles = 2
	Xscale = 1e-6
	Yscale = 2e-6
	Zscale = 1e-6
	*
	1 2
	BAD 4
	*
	a trailer
END
surfimport a.sdf >b.nrrd
is "text SDF is read" "$(heights b.nrrd) $(list dy b.nrrd)" "1e-06 2e-06 nan 4e-06 2e-06"
{
	printf 'DIGITAL SURF'
	le16 0 1 1 2
	printf '%60s' ''
	zeros 6 # to byte 86
	le16 1 0
	zeros 8
	le16 32
	le32 5 60 3 2 6
	# 2, 4 and 0.5 as floats
	printf '\0\0\0\100\0\0\200\100\0\0\000\077'
	printf '%48s' ''
	printf '%-16s%-16s%-16s' um um nm
	zeros 246 # to byte 474
	zeros 38
	le32 10 20 30 40 3 60
} >s.sur
surfimport s.sur >b.nrrd
is "Digital Surf with a missing sample is read" "$(heights b.nrrd) $(list dx b.nrrd) $(list dy b.nrrd)" \
	"5e-09 1e-08 1.5e-08 2e-08 nan 3e-08 2e-06 4e-06"
tag() { { printf %s "$1" && zeros $((20 - ${#1})) && printf %s "$2" && zeros $((30 - ${#2})) && printf '\r\n'; }; }
{
	printf 'AliconaImaging\0\r\n'
	tag Version 1
	tag TagCount 6
	tag PixelSizeXMeter 1e-6
	tag PixelSizeYMeter 3e-6
	tag DepthImageOffset 433
	tag Cols 3
	tag Rows 2
	tag InvalidPixelValue 0.5
	# 1, 2, 0.5 and 4 bytes of padding, 3, 4, 5 m
	printf '\0\0\200\077\0\0\0\100\0\0\0\077XXXX\0\0\100\100\0\0\200\100\0\0\240\100XXXX'
} >a.al3d
surfimport a.al3d >b.nrrd
is "Alicona with padded rows and a missing sample is read" "$(heights b.nrrd) $(list dy b.nrrd)" "1 2 nan 3 4 5 3e-06"
sed 's/DepthImageOffset\(....\)433/DepthImageOffset\1999/' a.al3d >far.al3d
fails "heights beyond the end of an Alicona file" 1 'from byte 999 on, but the file has' surfimport far.al3d
le16 256 512 >r.bin
surfimport --format raw --size 2x1 --type uint16 --pixel 1um --height-unit 1m r.bin >b.nrrd
is "headerless samples are read" "$(heights b.nrrd)" "256 512"
surfimport --format raw --size 1x1 --type int16 --big-endian --skip 2 --pixel 1um --height-unit 1m r.bin >b.nrrd
is "big-endian samples after a header are read" "$(heights b.nrrd)" "2"
same "the recorded command reproduces the file" b.nrrd "$(sh -c "$(sed -n 's/^cmd:=//p' b.nrrd)" >again; echo again)"

if command -v unzip >/dev/null && command -v xmllint >/dev/null && command -v zip >/dev/null; then
	mkdir -p bindata
	surfimport --pixel 1um --height-unit 1m <<-'END' | records -o text | grep -v '^#' >/dev/null
		1 2
	END
	le16 1 2 3 4 5 65535 >bindata/data.bin
	x3p() { # TYPE INCREMENT MD5
		cat >main.xml <<-END
			<?xml version="1.0"?>
			<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2"><Record1><FeatureType>SUR</FeatureType>
			<Axes><CX><AxisType>I</AxisType><DataType>D</DataType><Increment>1e-6</Increment></CX>
			<CY><AxisType>I</AxisType><DataType>D</DataType><Increment>2.0E-6</Increment></CY>
			<CZ><AxisType>A</AxisType><DataType>$1</DataType><Increment>$2</Increment></CZ></Axes></Record1>
			<Record3><MatrixDimension><SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ></MatrixDimension>
			<DataLink><PointDataLink>bindata/data.bin</PointDataLink>
			<MD5ChecksumPointData>$3</MD5ChecksumPointData></DataLink></Record3></p:ISO5436_2>
		END
		rm -f "a b.x3p"
		zip -q "a b.x3p" main.xml bindata/data.bin
	}
	x3p I 1e-9 "$(md5sum <bindata/data.bin | cut -d ' ' -f 1)"
	surfunzip "a b.x3p" >b.nrrd
	is "x3p with integers is read" "$(heights b.nrrd) $(list dx b.nrrd) $(list dy b.nrrd)" \
		"1e-09 2e-09 3e-09 4e-09 5e-09 -1e-09 1e-06 2e-06"
	# NRRD doubles backslashes in its header
	same "the recorded command reproduces an x3p, with or without a blank in its name" b.nrrd \
		"$(sh -c "$(sed -n -e 's/\\\\/\\/g' -e 's/^cmd:=//p' b.nrrd)" >again; echo again)"
	# names with what unzip takes for a pattern, and blanks around the text of an element
	cp bindata/data.bin 'bindata/data[1].bin'
	sed -e 's/data.bin/data[1].bin/' -e 's/<SizeX>3/<SizeX> 3 /' main.xml >blanks.xml
	mv blanks.xml main.xml
	zip -q 'a b[1].x3p' main.xml 'bindata/data[1].bin'
	surfunzip 'a b[1].x3p' >c.nrrd
	is "x3p with brackets and blanks is read" "$(heights c.nrrd)" "$(heights b.nrrd)"
	same "the recorded command reproduces it" c.nrrd \
		"$(sh -c "$(sed -n -e 's/\\\\/\\/g' -e 's/^cmd:=//p' c.nrrd)" >again; echo again)"
	x3p I 1e-9 00000000000000000000000000000000
	fails "x3p that is damaged" 1 'md5 differs' surfunzip "a b.x3p"
	printf '\000\000\200\077\000\000\000\100\000\000\100\100\000\000\200\100\000\000\240\100\000\000\300\100' >bindata/data.bin
	for scale in 1 1e-6 ''; do
		x3p F "$scale" ''
		surfunzip "a b.x3p" 2>err >c.nrrd
		echo "$(heights c.nrrd) $(grep -c 'an increment of 1e-6, which is not applied' err)"
	done >floats
	is "floats of an x3p are metres, and a warning says that an increment is not applied" "$(tr '\n' ';' <floats)" \
		"1 2 3 4 5 6 0;1 2 3 4 5 6 1;1 2 3 4 5 6 0;"
	x3p D 1 ""
	fails "x3p with too few samples" 1 'want 48 bytes, got 24' surfunzip "a b.x3p"
	printf '\0\0\200\077\044\044\164\111' >LAYER_0.raw # 1, 1000002.25
	printf '\0\0\200\077\020\044\164\111' >LAYER_0.raw # 1, 1000001
	printf '<xml><GENERAL><IMAGE_SIZE_X>2</IMAGE_SIZE_X><IMAGE_SIZE_Y>1</IMAGE_SIZE_Y><FOV_X>0.5</FOV_X><FOV_Y>0.5</FOV_Y></GENERAL></xml>' >index.xml
	zip -q s.plux index.xml LAYER_0.raw
	surfunzip s.plux >b.nrrd
	is "plux with a missing sample is read" "$(heights b.nrrd) $(list dx b.nrrd)" "1e-06 nan 5e-07"
	fails "a container is named to surfimport's user" 1 'surfunzip reads .x3p' surfimport s.plux
	fails "a text as a container" 1 'is no zip container' surfunzip tab.txt
	zip -q other.zip tab.txt
	fails "a container of something else" 1 'neither main.xml' surfunzip other.zip
	fails "no file" 2 'want a file' surfunzip
	fails "an unknown option" 2 'no such option' surfunzip --nothing x
else
	skip "surfunzip can be tested" "no unzip, xmllint or zip"
fi

# Real files, where they are.
data=$top/../shared/data/formats
if [ -e "$data/sur-3.sur" ]; then
	surfimport "$data/sur-3.sur" >b.nrrd
	is "a .sur of an instrument is read" "$(list nx b.nrrd) $(list ny b.nrrd) $(list dx b.nrrd | cut -c 1-9)" "512 512 0.0002955"
	surfimport "$data/sdf-1.sdf" >b.nrrd
	is "a softgauge in SDF is read" "$(list nx b.nrrd) $(list ny b.nrrd) $(list max b.nrrd)" "7 4 1e-06"
	for k in 2 3; do
		surfimport --profile "$data/csv-$k.csv" >b.nrrd
		is "profile $k of an instrument is read with the units of its headings" \
			"$(list nx b.nrrd) $(list dx b.nrrd | cut -c 1-6) $(list max b.nrrd | cut -c 1-7)" "8 8.3333 -1.4274"
	done
else
	skip "files of instruments can be tested" "no ../shared/data/formats"
fi

fails "no spacing" 1 'specify --pixel' surfimport --height-unit 1m tab.txt
fails "no unit" 1 'specify --height-unit' surfimport --pixel 1um tab.txt
fails "a spacing that the file contradicts" 1 'not --pixel' surfimport --pixel 5um a.sdf
printf '1 2\n3\n' >short.txt
fails "a short row" 1 'line 2: want 2 heights, got 1' surfimport --pixel 1um --height-unit 1m short.txt
printf '1 2\n3 x\n' >word.txt
fails "a word among heights" 1 'line 2: not a row of numbers: 3 x' surfimport --pixel 1um --height-unit 1m word.txt
printf '1 0x10\n' >hexadecimal.txt
fails "a hexadecimal number" 1 'no row of numbers' surfimport --pixel 1um --height-unit 1m hexadecimal.txt
printf '1,5;2;3\n1.234;5;6\n' >thousands.csv
fails "thousands separators among decimal commas" 1 'line 2: not a row of numbers: 1.234;5;6' \
	surfimport --pixel 1um --height-unit 1m thousands.csv
printf '1.234,5;2;3\n4;5;6\n' >thousands.csv
fails "thousands separators in the first row" 1 'line 1: not a row of numbers: 1.234,5' \
	surfimport --pixel 1um --height-unit 1m thousands.csv
printf 'n = 3\n1 2 3\n' | surfimport --pixel 1um --height-unit 1m >b.nrrd
is "a heading with a number is a heading" "$(heights b.nrrd)" "1 2 3"
fails "empty text" 1 'no row of numbers' surfimport --pixel 1um --height-unit 1m
printf 'nan nan\n' >gone.txt
fails "every height missing" 1 'every height is missing' surfimport --pixel 1um --height-unit 1m gone.txt
printf '0,1\n1,2\n5,3\n' >uneven.csv
fails "places at unequal steps" 1 'equally spaced' surfimport --profile --height-unit 1um uneven.csv
# Bytes that are neither text nor zeros: a row or a column that the header does not count.
for f in b.sdf s.sur; do
	{ cat $f && printf '\0\001\002\0'; } >more
	fails "more samples than the header of $f counts" 1 'more: more than the .* samples of its header' surfimport more
	{ cat $f && printf '\r\n*\r\nOperator = Tom\r\n' && zeros 9; } >more
	ok "text and zeros may follow the samples of $f" surfimport more
done
head -c 100 s.sur >cut.sur
fails "a header that is cut off" 1 'want 512 bytes of a .sur header' surfimport cut.sur
head -c 530 s.sur >cut.sur
fails "samples that are cut off" 1 'bytes of samples, got 530' surfimport cut.sur
printf '\001\002\0\003' >noise
fails "bytes that are no format" 1 'neither text nor' surfimport noise
fails "raw without a size" 2 'requires --size' surfimport --format raw noise
fails "a size without raw" 2 'are for --format raw' surfimport --size 2x2 noise
roughgen -n 4 >n.nrrd
fails "a stream of ours" 1 'roughgen reads it' surfimport n.nrrd

# Files that say one thing and hold another.
altered() {
	sed "$3" a.sdf >altered.sdf
	fails "$1" 1 "$2" surfimport altered.sdf
}
altered "an SDF file with more heights than points" "more than 2 heights: 'BAD" 's/NumProfiles = 2/NumProfiles = 1/'
altered "heights with decimal commas" 'more than 4 heights' 's/^1 2/1,5 2,5/'
altered "a word for a height" "'abc' among the heights" 's/BAD/abc/'
altered "a hexadecimal height" "'0x10' among the heights" 's/BAD/0x10/'
altered "a height beyond double precision" "'1e400' among the heights" 's/BAD/1e400/'
printf %s "$(sed '/^BAD/q' a.sdf)" >cut.sdf
surfimport cut.sdf >/dev/null 2>err
is "a last height without newline is reported" "$(cat err)" \
	"surfimport: cut.sdf: no newline at the end: the last height may be truncated"
altered "an inverted scale" 'units of -1e-06 m, want a positive' 's/Zscale = /Zscale = -/'
altered "a scale of nothing" 'units of 0 m, want a positive' 's/Zscale = 1e-6/Zscale = 0/'
altered "half a point" '2.5 x 2 samples' 's/NumPoints = 2/NumPoints = 2.5/'
altered "a scale that is no number" "Xscale is 'one', want a number" 's/Xscale = 1e-6/Xscale = one/'
altered "compressed text" 'compressed' 's/^Zscale/Compression = 1\nZscale/'
cat i.npy i.npy >two.npy
fails "two arrays in a file" 1 'more than the 3 x 2 samples' surfimport --pixel 1um --height-unit 1um two.npy
sed 's/<i2/|i1/' i.npy | head -c 86 >bytes.npy
surfimport --pixel 1um --height-unit 1um bytes.npy >b.nrrd
is "integers of one byte are read" "$(heights b.nrrd)" "1e-06 0 2e-06 0 3e-06 0"
{
	printf '\223NUMPY\001\000'
	le16 70
	printf "%-69s\n" "{'descr': '<i8', 'fortran_order': False, 'shape': (1, 2), }"
	le32 5 0 4294967293 4294967295
} >long.npy
surfimport --pixel 1um --height-unit 1um long.npy >b.nrrd
is "integers of eight bytes are read" "$(heights b.nrrd)" "5e-06 -3e-06"
awk 'BEGIN { for (i = 0; i < 9; i++) print i * 0.5, i % 3 }' >places.txt
fails "positions and heights for a matrix" 1 'positions and heights, are not a matrix: --profile' \
	surfimport --pixel 1um --height-unit 1um places.txt
for last in 4 8; do
	sed -n "2,${last}p" places.txt >few.txt
	fails "$((last - 1)) positions and heights for a matrix" 1 'positions and heights, are not a matrix: --profile' \
		surfimport --pixel 1um --height-unit 1um few.txt
done
printf '0.1 1.3\n0.7 1.1\n0.9 1.2\n' >two.txt
ok "a matrix of two columns has no positions" surfimport --pixel 1um --height-unit 1um two.txt
awk 'BEGIN { for (i = 0; i < 4; i++) for (j = 0; j < 5; j++) print 0.3 * i, 7 + 0.1 * j, 10 * i + j }' >points.txt
sort -k 3 -r points.txt >mixed.txt
for list in points mixed; do
	{ printf 'X [um]\ty [um]\tz [m]\n' && tr ' ' '\t' <$list.txt; } >named.txt
	surfimport named.txt >b.nrrd
	is "points x, y, z fill a grid in any order: $list" "$? $(list nx b.nrrd) $(list ny b.nrrd) $(heights b.nrrd)" \
		"0 4 5 $(sort -k 2,2n -k 1,1n points.txt | cut -d ' ' -f 3 | paste -s -d ' ')"
	near "their positions tell the spacing along x" "$(list dx b.nrrd)" 3e-7 1e-9
	near "and along y" "$(list dy b.nrrd)" 1e-7 1e-9
done
awk '{ print $2 "\t" $1 "\t" $3 }' points.txt >turned.txt
awk '{ print $3 "\t" $1 "\t" $2 }' points.txt >last.txt
for list in 'turned:y [um]\tX [um]\tz [m]' 'last:Height [m]\tX [um]\ty [um]'; do
	{ printf "${list#*:}\n" && cat "${list%:*}.txt"; } >columns.txt
	surfimport columns.txt >c.nrrd
	is "columns are found by their names: ${list%:*}" "$? $(list nx c.nrrd) $(list dx c.nrrd) $(heights c.nrrd)" \
		"0 4 $(list dx b.nrrd) $(heights b.nrrd)"
done
{ printf 'n\tX\ty\tz\n' && awk '{ print NR "\t" $1 "\t" $2 "\t" $3 }' points.txt; } >columns.txt
fails "a column before the points" 1 '4 columns look like points' surfimport --pixel 3umx1um --height-unit 1m columns.txt
printf 'n;a;x;y\n1;2;3\n2;2;4\n1;3;5\n2;3;6\n' >columns.txt
fails "a heading that names more columns than there are" 1 'want a heading of these names' \
	surfimport --pixel 1um --height-unit 1um columns.txt
# A Gwyddion text of 4 x 4 heights that ends after three rows
printf '# Width: 4.00 um\n# Height: 4.00 um\n# Value units: m\n1 2 3 5\n4 5 6 8\n7 8 9 9\n' >cut.txt
surfimport cut.txt >cut.nrrd 2>err
is "rows of another spacing than columns are told" "$? $(cat err)" \
	"0 surfimport: cut.txt: heights are 1e-06 m apart along x and 1.33333e-06 m along y: are all rows there?"
surfimport --pixel 1umx1.3333um cut.txt >cut.nrrd 2>err
is "unless --pixel confirms them" "$? $(wc -l <err)" "0 0"
# An Arc/Info grid that is cut off, and one whose rows are wrapped
printf 'ncols 3\nnrows 3\nNODATA_value -9999\n1 2 3\n4 5 6\n' >cut.asc
fails "a grid with fewer rows than its heading states" 1 'want 3 x 3 heights, as ncols and nrows state, got 3 x 2' \
	surfimport --pixel 1um --height-unit 1m cut.asc
printf 'NCOLS 6\nNROWS 1\n1 2 3\n4 5 6\n' >wrapped.asc
fails "a grid with shorter rows than its heading states" 1 'want 6 x 1 heights, as ncols and nrows state, got 3 x 2' \
	surfimport --pixel 1um --height-unit 1m wrapped.asc
printf 'ncols 3\r\nNODATA_value  -9999 \r\n1 2 3\r\n4 -9999 6\r\n' | surfimport --pixel 1um --height-unit 1m >c.nrrd
is "the heading of an Arc/Info grid tells the number of missing samples" "$(heights c.nrrd)" '1 2 3 4 nan 6'
surfimport --pixel 6umx2um --height-unit 1m mixed.txt >c.nrrd
is "positions without a unit take --pixel" "$? $(list dx c.nrrd) $(heights c.nrrd)" "0 6e-06 $(heights b.nrrd)"
fails "a pixel of another shape than that of the points" 1 'apart, which no unit makes --pixel' \
	surfimport --pixel 1um --height-unit 1um mixed.txt
sed 1d mixed.txt >part.txt
fails "a point that is absent" 1 '19 points x, y, z of a grid of 4 x 5: want all of them' \
	surfimport --pixel 1um --height-unit 1um part.txt
perl -e '$h = "{\x27descr\x27: \x27<f8\x27, \x27fortran_order\x27: False, \x27shape\x27: (20, 3), }";
	print "\x93NUMPY\1\0" . pack("v", length $h) . $h . pack("d<*", map { split } <>)' mixed.txt >points.npy
fails "points in an array" 1 'rows look like points x, y, z: want a matrix' surfimport --pixel 1um --height-unit 1um points.npy
for list in points named; do
	awk '{ print $0 "\t5" }' $list.txt | tr ' ' '\t' >more.txt
	fails "points with another column: $list" 1 '4 columns look like points x, y, z and more' \
		surfimport --pixel 1um --height-unit 1um more.txt
done
sed 2p named.txt >twice.txt
fails "a point that is given twice" 1 'points x, y, z that fill no grid' surfimport twice.txt
awk 'BEGIN { for (i = 0; i < 20; i++) print (i * 7) % 19.3, (i * 11) % 17.9, i }' >scattered.txt
surfimport --pixel 1um --height-unit 1um scattered.txt 2>err >b.nrrd
is "scattered points without a heading cannot be told from heights" "$? $(list nx b.nrrd)" "0 3"
like "a warning states what they are read as" "$(cat err)" 'three columns are read as heights'
awk 'BEGIN { for (i = 0; i < 20; i++) print i, (i * i) % 19, i }' >points.txt
fails "points along no grid" 1 'three columns look like points x, y, z that fill no grid' \
	surfimport --pixel 1um --height-unit 1um points.txt
awk 'BEGIN { for (i = -1; i < 4; i++) for (j = -1; j < 4; j++)
	printf "%s%s", i < 0 ? j : j < 0 ? i / 2 : i * j, j < 3 ? " " : "\n" }' >frame.txt
fails "positions above and beside the heights" 1 'first row and column are equally spaced' \
	surfimport --pixel 1um --height-unit 1um frame.txt
awk 'BEGIN { for (i = 0; i < 5; i++) print i, i + 1, i + 2, i + 3, i + 4 }' >plane.txt
ok "a tilted plane has no positions" surfimport --pixel 1um --height-unit 1um plane.txt
awk 'BEGIN { for (i = 0; i < 9; i++) print i / 4, i * i % 5, i * i % 7, i * i % 3 }' >beside.txt
fails "positions beside the heights alone" 1 'first column is equally spaced' \
	surfimport --pixel 1um --height-unit 1um beside.txt
awk 'BEGIN { for (j = 0; j < 4; j++) for (i = 0; i < 9; i++)
	printf "%s%s", j ? i * i % (9 - j) : i / 4, i < 8 ? " " : "\n" }' >above.txt
fails "positions above the heights alone" 1 'first row is equally spaced' \
	surfimport --pixel 1um --height-unit 1um above.txt
tail -n 4 beside.txt >few.txt
ok "few equally spaced heights are no positions" surfimport --pixel 1um --height-unit 1um few.txt
sort -r -n places.txt >back.txt
surfimport --profile --pixel 2mm --height-unit 1um places.txt >b.nrrd
surfimport --profile --pixel 2mm --height-unit 1um back.txt >c.nrrd
is "a spacing is given for positions without a unit" "$(list nx b.nrrd) $(list dx b.nrrd)" "9 0.002"
fails "positions without a unit" 1 'does not state the spacing: specify --pixel' \
	surfimport --profile --height-unit 1um places.txt
is "a profile measured backwards is turned" "$(heights c.nrrd)" "$(heights b.nrrd)"
fails "a unit for a length" 2 'height-unit um: did you mean 1um?' surfimport --height-unit um tab.txt
printf '1 2\n3 4\n\n5 6\n7 9\n' >blocks.txt
fails "two matrices" 1 'line 3: an empty line between rows: want a single matrix' \
	surfimport --pixel 1um --height-unit 1um blocks.txt
printf '\n1 2\n7 4\n# the end\n5 7\n\n\n' >spaced.txt
ok "empty lines around the rows are none between them" surfimport --pixel 1um --height-unit 1um spaced.txt
printf '1 2\r\r\n7 4\r\r\n5 7\r\r\n' >spaced.txt
surfimport --pixel 1um --height-unit 1m spaced.txt >b.nrrd
is "rows may be two lines apart" "$? $(heights b.nrrd)" "0 1 2 7 4 5 7"
# A comma that separates decimals separates no heights.
for rows in '1,05,2,5\n3,5,4,25\n' '-0,5,2,5\n3,1,4,2\n' '1,000.5,2,250\n3,100.25,4,750\n'; do
	printf '%b' "$rows" >commas.txt
	fails "decimals for heights: $rows" 1 'commas separate decimals or thousands, and heights as well' \
		surfimport --pixel 1um --height-unit 1um commas.txt
done
awk 'BEGIN { for (i = 0; i < 10; i++) printf "%d,5,%d,25\n", -i - 1, -2 * i - 1 }' >commas.txt
fails "decimals for heights: no second cell is negative" 1 'commas separate decimals' \
	surfimport --pixel 1um --height-unit 1um commas.txt
for rows in '12,0,3,40\n-5,10,0,7\n' '005,010,100,020\n001,002,003,004\n' '1.5,2,0.5,5\n-1,2,-0,4\n' \
	'1,05,3\n2,07,4\n'; do
	printf '%b' "$rows" >commas.txt
	ok "heights between commas: $rows" surfimport --pixel 1um --height-unit 1um commas.txt
done
# What would be left out as a heading, or is of another type.
torn() {
	printf '%b' "$2" >torn.txt
	fails "$1" 1 "line 1: not a row of numbers" surfimport --pixel 1um --height-unit 1um torn.txt
}
torn 'a first row with one cell of two that is no number' '1x 2\n3 4\n'
torn 'a first row with a minus sign of another alphabet' '\0342\0210\0222\0061 2\n3 4\n'
torn 'a first row with words behind it' '1 2 # left\n3 4\n'
printf 'left right\n1 2\n3 4\n' >headed.txt
is 'a heading of words is left out' "$(surfimport --pixel 1um --height-unit 1um headed.txt | records | grep '^1' | cut -f 5,6)" "2	2"
perl -e 'print pack "d<*", map { 1e-6 * sin $_ } 0 .. 99' >doubles
for type in 'float64 --big-endian' int64 'float32 --size 20x10'; do
	# shellcheck disable=SC2086 # words
	fails "heights of another type: $type" 1 'heights of up to .* m: want another type, byte order or unit' \
		surfimport --format raw --size 10x10 --pixel 1um --height-unit 1m --type $type doubles
done
perl -e 'print pack "d<*", 0 .. 99' >whole
fails "whole numbers of the other byte order" 1 'heights of up to .* m: want another type, byte order or unit' \
	surfimport --format raw --size 10x10 --pixel 1um --height-unit 1um --big-endian whole
# Four points of a grid are no matrix of three columns, whatever their order; heights that
# repeat in a column are.
for rows in '0 0 1\n1 0 4\n0 1 2\n1 1 7\n' '5;0;1\n5;2;4\n0;2;2\n0;0;7\n5;1;3\n0;1;4\n'; do
	# shellcheck disable=SC2059
	printf "$rows" >points.txt
	fails "points of a grid are refused: $rows" 1 "look like points x, y, z" \
		surfimport --pixel 1um --height-unit 1um points.txt
done
printf 'x y z\n0 0 1\n1 0 4\n0 1 2\n1 1 7\n' >points.txt
surfimport --pixel 1um --height-unit 1m points.txt >b.nrrd
is "with a heading that names them they are points" "$? $(heights b.nrrd)" "0 1 4 2 7"
printf '0 0 1\n1 0 4\n1 0 2\n0 2 7\n' >heights.txt
surfimport --pixel 1um --height-unit 1m heights.txt >b.nrrd
is "heights that repeat are a matrix" "$(heights b.nrrd)" "0 0 1 1 0 4 1 0 2 0 2 7"
printf '0 5\n1 6\n' >two.txt
surfimport --pixel 1um --height-unit 1m two.txt >b.nrrd 2>err
is "two rows of two columns are heights" "$? $(heights b.nrrd)" "0 0 5 1 6"
like "a warning states it" "$(cat err)" "two rows of two columns are read as heights: --profile"
printf 'x/um z/m\n0 5\n1 6\n' >two.txt
surfimport --profile two.txt >b.nrrd 2>err
is "with --profile they are a profile" "$? $(heights b.nrrd) $(cat err)" "0 5 6 "

printf '# doubtful: the contact did not converge\n1 2 3\n2 3 5\n' >doubt.txt
surfimport --pixel 1um --height-unit 1um doubt.txt >b.nrrd 2>err
is "text that states that it is doubtful has status 3" "$?" 3
like "and a warning" "$(cat err)" "did not converge"
roughgen --measure b.nrrd >/dev/null 2>err
is "and the heights are doubtful" "$?" 3
printf '#doubtful: one\r\n# doubtful:\r\n1 2 3\r\n2 3 5\r\n#  doubtful:  two\r\n# doubtful: one\r\n' >doubt.txt
surfimport --pixel 1um --height-unit 1um doubt.txt >b.nrrd 2>err
is "all reasons are taken over, each once" "$? $(cat err)" \
	"3 surfimport: doubt.txt: doubtful by its own account: one; two"
printf '1e400 2\n3 4\n5 7\n' >huge.txt
fails "a height beyond double precision is no missing one" 1 "line 1: not a row of numbers" \
	surfimport --pixel 1um --height-unit 1m huge.txt
done_testing

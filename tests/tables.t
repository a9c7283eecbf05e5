#!/bin/sh
# Tables: what is read, what is refused and in which words
. "$(dirname "$0")/tap.sh"

# read_series: what aopf takes from a series, its columns t and y
read_series() {
	aopf "$@" >out 2>err && column t out | tr '\n' ' ' && column y out | tr '\n' ' '
}
printf 't\ty\n0\t1\n1\t2\n2\t4\n' >plain
is 'a table is read' "$(read_series plain)" '0 1 2 1 2 4 '
printf '# key: value\n# more\nextra\ty\tt\nx\t1\t0\n\nx\t2\t1\nx\t4\t2\n' >shuffled
is 'columns are found by name; other columns and empty lines are ignored' "$(read_series shuffled)" '0 1 2 1 2 4 '
printf 't y\n0  1\n1 2 \n2 4\n' >blanks
is 'cells separated by blanks are read' "$(read_series blanks)" '0 1 2 1 2 4 '
printf '# columns: t\ty\n0\t1\n1\t2\n2\t4\n' >bare
is 'names are read from a comment if there is no header' "$(read_series bare)" '0 1 2 1 2 4 '
printf 't\ty\r\n0\t1\r\n1\t2\r\n2\t4\r\n' >dos
is 'lines with DOS endings are read' "$(read_series dos)" '0 1 2 1 2 4 '
{ cat plain; printf '# cmd: other\nt\ty\n3\t5\n'; } >two
is 'a table after a table is read' "$(read_series two)" '0 1 2 3 1 2 4 5 '
printf '1\n2\n1\n3\n1\n' | aopf >out
is 'rows equal to the first are kept if there is no header' "$(column y out | tr '\n' ' ')" '1 2 1 3 1 '
is 'rows equal to the first keep their times' "$(column t out | tr '\n' ' ')" '0 1 2 3 4 '
printf '\357\273\277y\tt\n1\t0\n2\t1\n4\t2\n' >marked
is 'a byte order mark is ignored' "$(read_series marked)" '0 1 2 1 2 4 '
aopf plain >stream
sed 's/$/\r/' stream >stream.dos
{ printf '\357\273\277'; cat stream; } >stream.marked
ok 'a stream with DOS endings is whole' records --check stream.dos
ok 'a stream with a byte order mark is whole' records --check stream.marked
sed 's/^\(.\)\(.*\)4/\1\25/' stream.dos >stream.bad
fails 'a changed cell of a stream with DOS endings' 1 'damaged or edited' records --check stream.bad
printf 't\ty\n0\t1\n1\tnan\n2\tNA\n3\t\n4\t4\n' >missing
is 'three spellings of a missing value are read' "$(read_series missing)" '0 1 2 3 4 1 nan nan nan 4 '

printf '# units: s m mm\nt\ty\n0\t1\n1\t2\n2\t4\n' >units
fails 'units of columns that were cut off' 1 "has more units than there are columns, 2" aopf units
fails 'y beside others, without t, is no series' 1 "no column 't'" sh -c "printf 'x\ty\n0\t1\n' | aopf"
refuse() {
	# shellcheck disable=SC2059 # the escapes are the table
	printf "$3" >bad
	fails "$1" 1 "$2" aopf bad
}
refuse 'a missing column' "bad: no column 'y'" 't\tx\n0\t1\n'
refuse 'a column twice' "bad: two columns 'y'" 't\ty\ty\n0\t1\t2\n'
refuse 'a cell that is no number' "bad: line 3: y: 'two' is not a number" 't\ty\n0\t1\n1\ttwo\n'
refuse 'a hexadecimal number' "bad: line 3: y: '0x10' is not a number" 't\ty\n0\t1\n1\t0x10\n'
refuse 'a number with a unit' "bad: line 3: y: '2um' is not a number" 't\ty\n0\t1\n1\t2um\n'
refuse 'too few cells' 'bad: line 3: want 2 cells, got 1' 't\ty\n0\t1\n1\n'
refuse 'too many cells' 'bad: line 3: want 2 cells, got 3' 't\ty\n0\t1\n1\t2\t3\n'
refuse 'a cell too many behind one column' 'bad: line 3: want 1 cells, got 2' 'y\n1\n2\t3\n'
refuse 'commas' "bad: no column .y. among .*: 'sigconvert --output table' makes a table of it" 't,y\n0,1\n1,2\n'
refuse 'commas and blanks' "bad: no column .y. among .*: 'sigconvert --output table' makes" 't, y, z\n0, 1, 2\n'
refuse 'a last line cut off' 'bad: line 3: no newline at the end: the table is truncated' 't\ty\n0\t1\n1\t2'
refuse 'a NUL byte' 'bad: line 3: NUL byte' 't\ty\n0\t1\n1\t\0002\n'

# Text that is passed on under one header has one unit.
printf 'diameter\tt\n1e-4\t1\n' >si
printf '# units: um s\ndiameter\tt\n100\t1\n' >um
sed 's/um/mm/' um >mm
fails 'tables of other units are not joined' 1 "records: mm: units 'mm s', want 'um s' as in the table before" records --join um mm
fails 'nor is one without units, which are then those of SI' 1 "records: si: units '', want 'um s'" records --join um si
for p in --join --pretty; do
	fails "$p: units that change within a table" 1 'input: line 4: the units change' sh -c "cat um mm | records $p"
	fails "$p: units that end within a table" 1 "input: line 5: the header before has no '# units'" \
		sh -c "cat um si | records $p"
	fails "$p: units that begin within a table" 1 'input: line 3: the units change' sh -c "cat si um | records $p"
done
is 'tables of equal units are joined' "$(records --join um um | column diameter /dev/stdin | tr '\n' ' ')" '100 100 '

# Lines that say why a table is doubtful: all that differ are quoted, in their order, and passed on.
reasons() {
	printf 't\ty\n0\t1\n'
	printf '# doubtful: %s\n1\t2\n' "$1"
	shift
	for why; do printf '# doubtful: %s\n' "$why"; done
	printf '2\t4\n'
}
reasons a b a c >three
status=0
aopf --threshold 9 three >out 2>err || status=$?
is 'of several reasons for doubt all that differ are quoted' "$status $(cat err)" '3 aopf: three: doubtful by its own account: a; b; c'
is 'they are passed on as one' "$(grep '^# doubtful' out)" '# doubtful: a; b; c'
reasons $(seq 1 1500) >many
aopf --threshold 9 many 2>err >out || status=$?
is 'of many reasons eight are quoted, up to a thousand are counted' "$(cat err)" \
	'aopf: many: doubtful by its own account: 1; 2; 3; 4; 5; 6; 7; 8; and at least 992 more reasons'
printf '# doubtful:\nt\ty\n0\t1\n1\t2\n' >none
aopf --threshold 9 none >out 2>err
is 'a reason without a word is none' "$? $(grep -c doubtful out err | tr '\n' ' ')" '0 out:0 err:0 '
printf 'time1\tdiameter\n1\tnan\n# doubtful: pulses differ\n' >both
wear-volume --period 1s both >out 2>err || status=$?
is 'reasons of a program stand beside those of its input' "$(sed -n 's/^# doubtful: //p' out | tr '\n' ';')" \
	'rows without a diameter;pulses differ;'

# Other tools, as the manual of the streams has them, where they are installed: the mean of
# a column of a table of two realisations, whose provenance stands in its middle.
printf '# cmd: a\n# units: 1 m3\nstep\tvolume\n1\t2\n# cmd: b\n2\t4\n' >ours
by() {
	tool=$1
	want=$2
	shift 2
	if command -v "$tool" >/dev/null; then
		is "$tool reads a table" "$("$@" 2>/dev/null | tail -n 1 | tr -d '\r')" "$want"
	else
		skip "$tool reads a table" "no $tool"
	fi
}
by datamash 3 sh -c 'datamash -C -H mean volume <ours'
by mlr 'volume_mean=3' mlr --itsv --odkvp --pass-comments-with '#' stats1 -a mean -f volume ours
by Rscript '[1] 3' Rscript -e "d <- read.delim('ours', comment.char = '#'); print(mean(d\$volume))"
by gnuplot ' 2  4  i' sh -c "gnuplot -e \"set table; plot 'ours' using 'step':'volume'\" | grep ' i' "
if /usr/bin/python3 -c 'import pandas' 2>/dev/null; then
	is 'pandas reads a table' "$(/usr/bin/python3 -c "
import pandas
print(pandas.read_csv('ours', sep='\t', comment='#')['volume'].mean())")" 3.0
else
	skip 'pandas reads a table' 'no pandas'
fi
done_testing

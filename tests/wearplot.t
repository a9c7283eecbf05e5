#!/bin/sh
# wearplot: a picture of every kind of stream, and what it refuses
. "$(dirname "$0")/tap.sh"

if ! command -v gnuplot >/dev/null; then
	skip 'wearplot can be tested' 'no gnuplot'
	done_testing
fi
# picture NAME PATTERN OPTION...: an SVG whose text matches
picture() {
	name=$1 pattern=$2
	shift 2
	if ! wearplot "$@" >p.svg 2>err; then
		fail "$name" "$(cat err)"
	elif ! tr -d '\n' <p.svg | sed 's/<[^>]*>//g' | grep -q -e "$pattern"; then
		fail "$name" "no text '$pattern' in the picture"
	elif ! tail -n 2 p.svg | grep -q "</svg>"; then
		fail "$name" 'the picture is not whole'
	else
		pass "$name"
	fi
}
roughgen -n 32 -L 1mm -c 2 | bemcontact --pressure 50MPa -E 210GPa >contact.nrrd
picture 'a field is drawn with its unit and a scale bar' 'height, um.*0.2 mm' contact.nrrd
picture 'the field asked for is drawn' 'pressure, GPa' --field pressure --record 2 contact.nrrd
picture 'a relief has a height axis' 'height, um' --relief contact.nrrd
sensorsim --uniform 50um:150um --number 20 --duration 2s --truth truth.tsv >signal.au
picture 'a signal has a trace for every channel' 'channel 1.*channel 2' signal.au
picture 'particles are marked' 'particles' --found truth.tsv --from=0.5 --to=0.6 signal.au
wearplot --from 0.5 --to 0.6 --output a.png signal.au
is 'a name that ends in .png gives a PNG' "$(head -c 4 a.png | tail -c 3)" PNG

# No pulse of one frame is lost in the envelope of a long record.
perl -e 'print ".snd", pack("N5", 24, 0xffffffff, 7, 10000, 1);
	print pack("d>", $_ == 54321 ? 3 : 0) for 0 .. 99999' >spike.au
picture 'an envelope keeps a spike of 3 V in one frame' '[^0-9]0[^0-9]*2[^0-9]*4[^0-9]*0[^0-9]*1[^0-9]' spike.au

perl -e 'print ".snd", pack("N5", 24, 0xffffffff, 7, 1000, 1);
	print pack("d>", $_ == 7 ? 9**9**9 : $_ == 8 ? -sin(9**9**9) : 1) for 0 .. 99' >holes.au
picture 'a signal with holes is drawn' 'channel 1' holes.au
is 'its frames without numbers are counted' "$(cat err)" 'wearplot: holes.au: 2 frames are no numbers and left out'

printf 't\ty\n0\t1\n3600\t2\n7200\t3\n' >series.tsv
picture 'a series is drawn over time' 'observed' series.tsv
printf 't\ty\n0\t1\n3600\tnan\n7200\t3\n10800\tNA\nt\ty\n14400\t4\n' >gaps.tsv
picture 'a series with gaps is drawn' 'observed' gaps.tsv
is 'rows that are left out are counted' "$(cat err)" 'wearplot: gaps.tsv: 2 of 5 rows have no y and are left out'
printf 't\ty\n0\t1\n3600\thigh\n7200\t3\n' >words.tsv
fails 'a word among numbers is refused' 1 "words.tsv: line 3: y: 'high' is not a number" wearplot words.tsv
printf 't\ty\n0\t1\n3600\t2mm\n7200\t3\n' >words.tsv
fails 'a number with a unit is refused' 1 "words.tsv: line 3: y: '2mm' is not a number" wearplot words.tsv
printf 'diameter\n1e-5\nnan\nlarge\n' >words.tsv
fails 'a word among diameters is refused' 1 "words.tsv: line 4: diameter: 'large' is not a number" wearplot words.tsv
printf 'diameter\n1e-5\nnan\n2e-5\n' >gaps.tsv
picture 'particles without diameter are left out' 'diameter, um' gaps.tsv
is 'and counted' "$(cat err)" 'wearplot: gaps.tsv: 1 of 3 rows have no diameter and are left out'
picture 'a series is drawn with its threshold' 'threshold' --end 5 series.tsv
printf '# units: h L/min\nt\ty\n0\t1\n3600\t2\n7200\t3\n' >hours.tsv
picture 'hours stay hours' 'y, L/min.*time, h' hours.tsv
is 'the axis reaches the last value' "$(tr -d '\n' <p.svg | sed 's/<[^>]*>/ /g' | grep -c ' 8000 ')" 1
printf '# units: s m3\nt\ty\n0\t0\n36000\t4e-11\n72000\t9e-11\n' >volume.tsv
picture 'a volume is shown in cubic millimetres' '0.09.*y, mm3.*time, h' --end 9e-11 volume.tsv
printf '# units: s m3/s\nt\ty\n0\t1e-5\n7200\t5e-5\n' >flow.tsv
picture 'a flow is shown in litres a minute' 'y, L/min' flow.tsv
printf 't\tq05\tq50\tq95\n0\t8\t10\t12\n1\t7\t9\t11\n' >life.tsv
picture 'lives have a band, a median and the truth' 'band.*median.*true' --truth 10 life.tsv
printf 'error\tseconds\n1e-3\t1\n1e-4\t2\n' >cost.tsv
picture 'error against time' 'processor time' cost.tsv
printf 'diameter\tverdict\n1e-4\talone\n2e-4\tmisfit\n' >found.tsv
picture 'particles by size' 'diameter, um' found.tsv
is 'doubtful particles are not counted' "$(printf 'diameter\tverdict\n2e-4\tmisfit\n3e-4\tmisfit\n' |
	wearplot 2>&1)" 'wearplot: standard input: no particle with a diameter'

printf '# units: um 1\ndiameter\tverdict\n100\talone\n200\talone\n' >um.tsv
printf 'diameter\tverdict\n1e-4\talone\n2e-4\talone\n' >m.tsv
wearplot m.tsv >m.svg
wearplot um.tsv >um.svg
same 'diameters are drawn in micrometres, whatever their unit' m.svg um.svg
sed '1s/um/in/' um.tsv >in.tsv
fails 'a unit that is no length is refused' 1 "in.tsv: column 'diameter' is in 'in', want m" wearplot in.tsv
# What readers of tables accept, and spreadsheets write: a byte order mark, DOS line ends, blanks.
printf '# units: m 1\ndiameter\tverdict\n1e-4\talone\n2e-4\tmisfit\n' >tabs.tsv
{ printf '\357\273\277'; sed 's/$/\r/' tabs.tsv; } >dos.tsv
tr '\t' ' ' <tabs.tsv >blanks.tsv
for f in tabs dos blanks; do
	wearplot $f.tsv >$f.svg
done
same 'doubtful particles are not counted with DOS line ends' tabs.svg dos.svg
same 'cells separated by blanks are drawn' tabs.svg blanks.svg
printf '#units:\tum\t1 \ndiameter\tverdict\n100\talone\n200\tmisfit\n' >blank.tsv
wearplot blank.tsv >blank.svg
same 'units between other blanks are read' tabs.svg blank.svg
fails 'units that change within a table' 1 'input: line 5: the units change' sh -c 'cat um.tsv tabs.tsv | wearplot'
fails 'units that end within a table' 1 "input: line 5: this header has no '# units'" sh -c 'cat um.tsv found.tsv | wearplot'
fails 'units that begin within a table' 1 'input: line 4: the units change' sh -c 'cat found.tsv um.tsv | wearplot'
printf 'time1\tdiameter\n0.1\t1e-4\n' >still.tsv
fails 'particles without amplitudes in a signal' 1 "still.tsv: no column 'amplitude'" wearplot --found still.tsv signal.au
fails 'particles without diameters beside others' 1 "series.tsv: no column 'diameter'" wearplot --found series.tsv m.tsv
printf 'time1\ttime2\tamplitude\n0.1\t0.12\t0.1\nnan\tnan\t0.1\n' >lost.tsv
wearplot --found lost.tsv signal.au >lost.svg 2>err
sed '$d' lost.tsv >first.tsv
wearplot --found first.tsv signal.au >first.svg
same 'particles without times are not marked' first.svg lost.svg
# 0.4 Hz, of which the header has 1; a level of 2.5 V, at which the end mark, near 0 V, is none
perl -e 'print "time\tu\n"; printf "%g\t%g\n", 2.5 * $_, 2.5 + 0.001 * ($_ % 2) for 0 .. 99' | sigconvert --rate 0.4 >slow.au
wearplot slow.au | tr -d '\n' | sed 's/<[^>]*>/ /g' >text
is 'a rate below one per second has its times' "$(grep -c ' 250 .*time, s' text)" 1
is 'the end mark is not drawn' "$(tr -s ' \t' '  ' <text | grep -c ' 0 2 4 .*channel 1')" 0
if [ -c /dev/full ]; then
	fails 'a full disk is refused' 1 'standard output: cannot be written' sh -c 'wearplot slow.au >/dev/full'
	ln -s /dev/full full.svg
	fails 'a full disk is refused' 1 'full.svg: cannot be written' wearplot --output full.svg slow.au
fi
fails 'an unknown table is refused by its columns' 1 'no picture for the columns a b' \
	sh -c 'printf "a\tb\n1\t2\n" | wearplot'
fails 'an empty stream' 1 'standard input: empty' wearplot
head -c 3000 signal.au >torn.au
fails 'a signal that was cut off' 1 '^wearplot: torn.au: ' wearplot torn.au
sed '$d' truth.tsv >torn.tsv
fails 'a table that was cut off' 1 '^wearplot: torn.tsv: ' wearplot torn.tsv
fails 'particles that were cut off' 1 '^wearplot: torn.tsv: ' wearplot --found torn.tsv signal.au
fails 'a missing file' 1 'none.tsv: cannot be read' wearplot none.tsv
fails 'a missing field' 1 'want a field of this list: height, pressure' wearplot --field gap contact.nrrd
# What is doubtful is drawn, and marked.
sed 's/^seed:=1/seed:=1\ndoubtful:=worn/; /^stream:=/d' contact.nrrd >worn.nrrd 2>/dev/null
printf '# doubtful: pulses differ\ndiameter\ttime1\tamplitude\n1e-4\t1\t0.1\n1e-4\t1.1\t0.1\n' >poor.tsv
sensorsim --duration 2s poor.tsv >poor.au 2>/dev/null
for f in worn.nrrd poor.tsv poor.au; do
	wearplot --title new --output p.svg $f 2>err
	is "$f is drawn and marked as doubtful" \
		"$? $(grep -c 'new - doubtful' p.svg) $(grep -c "$f: doubtful by its own account: [pw]" err)" '3 1 1'
done
wearplot --found poor.tsv --output p.svg signal.au 2>err
is 'so are doubtful particles in a signal' \
	"$? $(grep -c 'particles are doubtful' p.svg) $(grep -c 'poor.tsv: doubtful' err)" '3 1 1'
printf 'time1\ttime2\tamplitude\n0.1\t0.12\t0.1\n0.2\t0.22\tnan\n' >some.tsv
wearplot --found some.tsv --output p.svg signal.au 2>err
is 'rows without an amplitude are reported once' "$(cat err)" \
	"wearplot: some.tsv: 1 of 2 rows have no amplitude and are left out"
fails 'a missing record' 1 'contact.nrrd' wearplot --record 3 contact.nrrd
fails 'another ending' 2 'ends in .svg or .png' wearplot --output x.gif contact.nrrd
fails 'a size without a height' 2 'want WxH' wearplot --size 900 contact.nrrd
fails 'an unknown option' 2 'no such option' wearplot --colour contact.nrrd
fails 'a time that is no number' 2 'from abc: want a number' wearplot --from abc signal.au
fails 'a time before the record' 2 'from -5: want a time from 0 on' wearplot --from -5 signal.au
fails 'a stretch of no length' 2 'want a time after' wearplot --from 1 --to 1 signal.au
fails 'a record that ends before' 1 'ends before' wearplot --from 100 signal.au
is '--version states the version' "$(wearplot -V)" "wearplot (wearpipe) $(sed -n 's/^VERSION = //p' "$top/Makefile")"
done_testing

#!/bin/sh
# sigconvert: recordings of other programs in and out, exact where the format is
. "$(dirname "$0")/tap.sh"

# samples FILE: all samples of a signal, separated by blanks
samples() {
	sigconvert --output text "$1" | grep -v '^[#t]' | cut -f 2- | tr '\t\n' '  ' | sed 's/ $//'
}
# rows FILE: what of a text there is beside its header
rows() {
	grep -v '^#' "$1" | cksum
}

sensorsim --uniform 50um:150um --number 3 --duration 0.3s --noise 1mV >a.au
sigconvert --output text a.au >a.tsv
sigconvert a.tsv >b.au
sigconvert --output text b.au >b.tsv
is "text reads back to the last bit" "$(rows a.tsv)" "$(rows b.tsv)"
is "rate and channels are kept" "$(sed -n 's/^# rate: //p' b.tsv) $(grep ^time b.tsv)" \
	"10000 $(printf 'time\tchannel1\tchannel2')"
sigconvert --output raw a.au >a.raw
is "raw has 8 bytes per sample" "$(wc -c <a.raw)" 48000
sigconvert --from raw --rate 10kHz --channels 2 --output text a.raw >c.tsv
is "raw reads back to the last bit" "$(rows a.tsv)" "$(rows c.tsv)"
# Samples of another byte order, and integers; od prints the bytes of each float64 or int16
od -An -v -tu1 -w8 a.raw | awk '{ for (i = 8; i > 0; i--) printf "%c%03o", 92, $i; print "" }' | while read -r bytes; do
	# shellcheck disable=SC2059 # a format of octal bytes
	printf "$bytes"
done >swapped.raw
sigconvert --output text a.au | awk -F '\t' '/^[0-9]/ { for (i = 2; i <= 3; i++) { v = int($i * 30000); if (v < 0) v += 65536
	printf "%c%03o%c%03o\n", 92, v % 256, 92, int(v / 256) } }' | while read -r bytes; do
	# shellcheck disable=SC2059
	printf "$bytes"
done >integers.raw
for type in swapped integers; do
	sigconvert --from raw --rate 10kHz --channels 2 $type.raw 2>err >out.au
	is "raw samples that are $type are refused" "$? $(grep -c 'not little-endian float64?' err)" "1 1"
	fails "the signal of samples that are $type has no end" 1 'has no end' records --check out.au
done
# float32 as a sound card delivers them; float64 that are 0 but for one sample in fifty,
# or that were float32 before, whose last bits are 0, are none
perl -e 'srand 3; print pack "f<*", map { rand() - 0.5 } 1 .. 2000' >single.raw
sigconvert --from raw --rate 10kHz --channels 2 single.raw 2>err >out
is "raw samples of float32 are refused" "$? $(grep -c 'look like float32' err)" "1 1"
perl -e 'srand 3; print pack "d<*", map { $_ % 50 ? 0 : rand() - 0.5 } 1 .. 10000' >sparse.raw
ok "rare pulses of float64 are not float32" sigconvert --from raw --rate 10kHz --channels 2 sparse.raw
perl -e 'srand 3; print pack "d<*", map { unpack "f", pack "f", rand() - 0.5 } 1 .. 2000' >wide.raw
ok "float64 of 24 significant bits are not float32" sigconvert --from raw --rate 10kHz --channels 2 wide.raw
is "the header records the pipeline" "$(sed -n 's/^# cmd: .*| //p' a.tsv)" "sigconvert --output text"

printf 'Time [ms];Flow [L/min];"u1 [mV]";u2 (V)\r\n0,0;60;1500,5;2\r\n0,5;61;-20;nan\r\n1,0;60;3;4\r\n' >daq.csv
sigconvert --columns 'u1;u2' daq.csv >d.au
is "columns are read by name, with units and decimal commas" "$(samples d.au)" "1.5005 2 -0.02 nan 0.003 4"
is "the times determine the rate" "$(sigconvert --output text d.au | sed -n 's/^# rate: //p')" 2000
sigconvert --columns 2 --scale 0.5 daq.csv >d.au
is "a column is read by number and scaled" "$(samples d.au)" "30 30.5 30"
printf 'made by hand\na,b\n1.5,2\n3,4\n' >plain.csv
sigconvert --skip-lines 1 --rate 100Hz plain.csv >d.au
is "the rate can be given if there are no times" "$(samples d.au)" "1.5 2 3 4"
printf 'a b\n1 2\n3 4\n' | sigconvert --from text --rate 100Hz >d.au
is "cells separated by blanks are read from a pipe" "$(samples d.au)" "1 2 3 4"

# The rate that times tell is the one of fewest digits that they allow.
# told STEP DIGITS ROWS: the rate learned from times printed with so many digits
told() {
	awk -v step="$1" -v digits="$2" -v n="$3" 'BEGIN { print "t\tu"
		for (i = 0; i < n; i++) printf "%.*f\t%d\n", digits, i * step, i }' >times.tsv
	sigconvert --output text times.tsv 2>err | sed -n 's/^# rate: //p'
}
is "a step of 0.3 s gives the rate" "$(told 0.3 1 20)" "3.3333333333333335"
is "times of nine digits give 44100 Hz" "$(told 2.2675736961451248e-05 9 300)" 44100
is "times of six digits give 44.1 Hz" "$(told 0.022675736961451248 6 500)" 44.1
is "exact times give 10007 Hz" "$(told 9.993004896572399e-05 15 300)" 10007
is "times in whole milliseconds give 10 kHz" "$(told 1e-4 3 3000)" 10000
is "a step of a minute gives the rate" "$(told 60 0 10)" 0.016666666666666666
is "regular times cause no warning" "$(cat err)" ''
for unit in min h d; do
	seq 0 24 | awk -v u=$unit 'BEGIN { print "Time [" u "];y" } { print $1 ";1" }' |
		sigconvert --output channels 2>err | column rate /dev/stdin | awk '{ printf "%.9g ", 1 / $1 }'
done >steps
is "steps of a minute, an hour and a day are found" "$(cat steps)" "60 3600 86400 "
is "thirds of an hour are found" "$(printf 'Time [h];y\n0.00;1\n0.33;2\n0.67;2\n1.00;2\n1.33;3\n' |
	sigconvert --output channels 2>err | column rate /dev/stdin | awk '{ printf "%.9g", 1 / $1 }')" 1200
told 2.2675736961451248e-05 3 200 >out
like "times of few digits give a warning" "$(cat err)" 'determine the rate of 40000 Hz only to a relative 0.2: set it by --rate'
awk 'BEGIN { print "t\tu"; srand(3); for (i = 0; i < 1000; i++) print i / 100 + 0.001 * rand() "\t" i }' >jitter.tsv
is "times that jitter by a tenth of a step give the rate" "$(sigconvert --output text jitter.tsv | sed -n 's/^# rate: //p')" 100
printf 'T [C];t;u\n20;0;1\n21;1;2\n22;2;3\n' >warm.csv
is "a column t is the time beside a temperature T" "$(sigconvert --output channels warm.csv | column high /dev/stdin | tr '\n' ' ')" "22 3 "
printf 't;u\n0;1\n' >single.csv
fails "one row" 1 'the time of one row tells no rate' sigconvert single.csv
printf 't;u\n0;1\n1;2' >torn.csv
sigconvert torn.csv >out 2>err
is "a last line without newline is reported" "$(cat err)" \
	"sigconvert: torn.csv: line 3: no newline at the end: the last row may be truncated"
printf 't;u;u\n0;1;5\n1;2;6\n' >twice.csv
fails "a heading of two columns" 1 "columns 2 and 3 are called 'u': choose one by its number" sigconvert --columns u twice.csv
printf 'Rate [Hz];u [V]\n12,5;1\n12,5;2\n' >rated.csv
is "a column tells the rate" "$(sigconvert --output text rated.csv | sed -n 's/^# rate: //p')" 12.5
printf 'Rate;u\n12,5;1\n12;2\n' >rated.csv
fails "a rate that changes" 1 'line 3: rate 12 after 12.5' sigconvert rated.csv

# A rate that is no whole number, and the moment of the first sample, pass every format.
sigconvert --rate 44.1Hz --start 2026-11-22T03:04:05.250+01:00 plain.csv --skip-lines 1 >f.au
is "a fraction of a hertz and the start are kept" \
	"$(sigconvert --output text f.au | sed -n -e 's/^# rate: //p' -e 's/^# start: //p' | tr '\n' ' ')" \
	"44.1 2026-11-22T03:04:05.250+01:00 "
sigconvert --output text f.au | sigconvert | sigconvert --output text >g.tsv
is "text and pipes keep the start and the rate" "$(sed -n -e 's/^# rate: //p' -e 's/^# start: //p' g.tsv | tr '\n' ' ')" \
	"44.1 2026-11-22T03:04:05.250+01:00 "
printf 'When,u\n2026-11-22 23:59:59.500,1\n2026-11-23 00:00:00.000,2\n2026-11-23 00:00:00.500,3\n' >when.csv
sigconvert --time When when.csv >w.au
is "moments are times and give the start" \
	"$(sigconvert --output text w.au | sed -n -e 's/^# rate: //p' -e 's/^# start: //p' | tr '\n' ' ')$(samples w.au)" \
	"2 2026-11-22T23:59:59.5 1 2 3"
printf 't,u\n2024-02-29T00:30:00+01:00,1\n2024-02-28T23:30:01Z,2\n2024-02-28T23:30:02Z,3\n' >zones.csv
is "leap days and time zones are converted" "$(sigconvert --output text zones.csv | sed -n -e 's/^# rate: //p' -e 's/^# start: //p' | tr '\n' ' ')" \
	"1 2024-02-29T00:30:00+01:00 "
for moment in 2026-02-29T00:00 2026-13-01T00:00 2026-01-01T24:00 2026-01-01 22.11.2026; do
	fails "a start of $moment" 2 'expected a moment like' sigconvert --start $moment a.au
done
fails "two starts" 2 'began at 2026-11-22T23:59:59.5' sigconvert --start 2026-11-22T00:00 w.au
sensorsim --uniform 50um:150um --number 3 --duration 2s --rate 1234.5Hz | sigconvert --start 2026-11-22T03:00Z >s.au
bpfilter --order 20 --band 20:200 s.au | tee b.au | duet --pulse-duration 10ms >found.tsv 2>err
wear-volume --period 100ms found.tsv >volume.tsv 2>err
is "the start passes bpfilter, duet and wear-volume" \
	"$(sed -n 's/^# start: //p' found.tsv volume.tsv | tr '\n' ' ')" "2026-11-22T03:00Z 2026-11-22T03:00Z "
is "the rate passes bpfilter" "$(sigconvert --output text b.au | sed -n 's/^# rate: //p')" 1234.5

# What is written as text has an end that its reader checks; numpy reads it as it is.
head -c -40 a.tsv >torn.tsv
fails "text that is cut off" 1 'torn.tsv' sigconvert torn.tsv
sigconvert --from text --columns channel2 a.tsv >d.au
is "a column of text written by sigconvert is read" "$(samples d.au | cut -d ' ' -f 1-3)" "$(grep -v '^[#t]' a.tsv | cut -f 3 | head -n 3 | tr '\n' ' ' | sed 's/ $//')"
py=python3
$py -c 'import numpy' 2>/dev/null || py=/usr/bin/python3
if $py -c 'import numpy' 2>/dev/null; then
	is "numpy reads raw, text and a signal of fractional rate" "$($py - <<-'END'
		import numpy as np
		a = np.loadtxt('a.tsv', skiprows=sum(l[0] == '#' for l in open('a.tsv')))
		t = np.genfromtxt('a.tsv', names=True, comments='#', skip_header=sum(1 for l in open('a.tsv') if l[0] == '#') - 1)
		r = np.fromfile('a.raw').reshape(-1, 2)
		b = open('f.au', 'rb').read()
		x = np.frombuffer(b, '>f8', offset=int.from_bytes(b[4:8], 'big')).reshape(-1, 2)[:-1]
		print((a[:, 1:] == r).all(), len(t) == len(a), x.ravel().tolist())
	END
	)" "True True [1.5, 2.0, 3.0, 4.0]"
else
	skip "numpy reads raw, text and a signal of fractional rate" "no numpy"
fi
# Noise of 1 mV with runs of four at the top of channel 1; channel 2 does not move.
sensorsim --uniform 10um:11um --number 1 --duration 2s --noise 1mV | sigconvert --output text | grep -v '^#' |
	awk -F '\t' -v OFS='\t' '/^[0-9]/ { if ((NR + 500) % 1000 < 4) $2 = 0.02; $3 = 0.5 } { print }' |
	sigconvert --from text | sigconvert --output channels >channels.tsv
is "samples at the end of the range are counted" "$(column rails channels.tsv | tr '\n' ' ')" '80 20000 '
is "the largest sample of each channel is stated" "$(column high channels.tsv | tr '\n' ' ')" '0.02 0.5 '
near "the noise of quiet sections is estimated to 6 %" "$(column level channels.tsv | head -n 1)" 9.4e-4 3e-5
is "the noise of a dead channel is estimated" "$(column level channels.tsv | tail -n 1)" 0

if sigconvert --output wav a.au >a.wav 2>err; then
	sleep 1
	sigconvert --output wav a.au >later.wav
	same "WAV does not tell the time of day" a.wav later.wav
	sigconvert --output text a.wav >w.tsv
	is "WAV in float64 reads back to the last bit" "$(rows a.tsv)" "$(rows w.tsv)"
	sigconvert --from sound --output text <a.wav >w.tsv
	is "WAV reads back through a pipe" "$(rows a.tsv)" "$(rows w.tsv)"
	sigconvert --output flac --scale 0.1 a.au >a.flac
	sigconvert --output text --scale 10 a.flac >f.tsv
	near "FLAC has 24 bits" "$(grep -v '^#' f.tsv >f; grep -v '^#' a.tsv | paste - f | awk '/^[0-9]/ { d = $2 - $5; d = d < 0 ? -d : d; m = d > m ? d : m }
		END { printf "%.9f", m }')" 0 1.2e-6
	printf 't\tu\n0\t0.5\n0.001\t2\n0.002\t-3\n' | sigconvert --from text --output flac --stats st >clip.flac 2>err
	is "clipping is counted, reported and gives status 3" "$? $(column samples_clipped st) $(grep -c 'clipped' err)" "3 2 1"
	is "clipping cuts at full scale" "$(samples clip.flac | awk '{ printf "%.3f %.3f %.3f", $1, $2, $3 }')" "0.500 1.000 -1.000"
	fails "WAV of a fractional rate" 1 ' 44.1 Hz: WAV and FLAC require a whole number' sigconvert --output wav f.au
	head -c 20 a.wav >cut.wav
	fails "a WAV that is cut off" 1 'cut.wav' sigconvert cut.wav
	sigconvert --output wav a.tsv >whole.wav
	head -c "$(($(wc -c <whole.wav) - 100))" whole.wav >cut.wav
	fails "a WAV without its last samples" 1 'cut.wav: want [0-9]* bytes of samples, got [0-9]*' sigconvert cut.wav
	# sound FORMAT BYTES ANNOUNCED: two channels of 24 bits, silent
	sound() {
		perl -e 'my ($format, $n, $told) = @ARGV; my $x = "\0" x $n;
			my $fmt = "fmt " . pack("VvvVVvv", 16, 1, 2, 1000, 6000, 6, 24);
			print $format eq "aiff"
				? "FORM" . pack("N", $told + 46) . "AIFFCOMM" .
					pack("NnNnnNN", 18, 2, $told / 6, 24, 0x4008, 0xfa000000, 0) .
					"SSND" . pack("NNN", $told + 8, 0, 0) . $x
				: $format eq "rf64"
				? "RF64" . pack("V", 0xffffffff) . "WAVEds64" .
					pack("VQ<Q<Q<V", 28, $told + 72, $told, $told / 6, 0) .
					$fmt . "data" . pack("V", 0xffffffff) . $x
				: "RIFF" . pack("V", 36 + $told) . "WAVE" . $fmt . "data" . pack("V", $told) . $x' "$@"
	}
	for format in wav aiff rf64; do
		sound $format 3000 3000 >whole.$format
		sigconvert -o channels whole.$format >channels.tsv 2>err
		is "a recording as $format is read whole" "$? $(column frames channels.tsv | head -n 1)" "0 500"
		sound $format 2400 3000 >cut.$format
		fails "a recording as $format that is cut off between frames" 1 'want 3000 bytes of samples, got 2400' sigconvert cut.$format
	done
	# sox announces this length where it cannot seek
	streamed=$((0x7ffff000 / 6 * 6))
	sound wav 3000 $streamed | sigconvert -o channels >channels.tsv 2>err
	is "a stream of unknown length is read to its end" "$? $(column frames channels.tsv | head -n 1)" "0 500"
	sound wav 2996 $streamed >cut.wav
	fails "a stream of unknown length that ends inside a frame" 1 'want 2996 bytes of samples, got 2994' sigconvert cut.wav
	if sox -n -r 8000 whole.ogg synth 1 noise 2>err; then
		head -c "$(($(wc -c <whole.ogg) - 1))" whole.ogg >cut.ogg
		fails "an Ogg stream that is cut off" 1 'before its end mark' sigconvert cut.ogg
	else
		skip "an Ogg stream that is cut off" "no sox"
	fi
	# other FORMAT BYTES: one channel, whose header announces 3000 bytes
	other() {
		perl -e 'my ($format, $n) = @ARGV; my $x = "\0" x $n;
			sub v5 { my ($columns, $name, $data) = @_;
				my $a = pack("V8", 6, 8, 6, 0, 5, 8, 1, $columns) .
					pack("V2", 1, length $name) . $name .
					"\0" x (-length($name) % 8) . $data;
				pack("V2", 14, length $a) . $a }
			print $format eq "dns" ? "dns." . pack("V5", 24, 3000, 6, 1000, 1) . $x
				: $format eq "mat4"
				? pack("V5 Z11 d<", 0, 1, 1, 0, 11, "samplerate", 1000) .
					pack("V5 Z9", 0, 1, 375, 0, 9, "wavedata") . $x
				: $format eq "mat5"
				? pack("a124 v a2", "MATLAB 5.0 MAT-file", 0x100, "IM") .
					v5(1, "samplerate", pack("v4", 4, 2, 1000)) .
					v5(375, "wavedata", pack("V2", 9, 3000) . $x)
				: $format eq "voc"
				? "Creative Voice File\x1a" . pack("v3", 26, 0x114, 0x111f) .
					pack("V V C2 v V", 9 | 3012 << 8, 1000, 16, 1, 4, 0) . $x . "\0"
				: "RIFF" . pack("V", 7644) . "WAVEfmt " .
					pack("VvvVVvv", 16, 1, 1, 1000, 2000, 2, 16) .
					("LIST" . pack("Va8Va4", 16, "INFOINAM", 4, "name")) x 192 .
					"data" . pack("V", 3000) . $x' "$@"
	}
	for format in dns mat4 mat5 voc; do
		other $format 3000 >whole.$format
		sigconvert --from sound -o channels whole.$format >channels.tsv 2>err
		is "a recording as $format is read whole and said to be" "$? $(column frames channels.tsv | tail -n 1)$(cat err)" \
			"0 $(case $format in dns) echo 750 ;; voc) echo 1500 ;; *) echo 375 ;; esac)"
		other $format 2400 >cut.$format
		fails "a recording as $format that is cut off" 1 "cut.$format: \(want 3000 bytes\|the recording is truncated\)" \
			sigconvert --from sound cut.$format
	done
	for format in dns mat5 voc; do
		ok "a recording as $format is recognised" sigconvert whole.$format
	done
	# The notes of libsndfile end before the size of the samples.
	other wav 2400 >long.wav
	fails "a recording whose size is unknown" 3 'long.wav: whether the recording is truncated is unknown' \
		sh -c 'sigconvert -o raw long.wav >out.raw'
	is "the signal says so" "$(sigconvert long.wav 2>err | sigconvert --output text | grep doubtful)" \
		'# doubtful: whether the recording is truncated is unknown'
	sensorsim --uniform 50um:150um --number 5 --duration 3s --noise 1mV | sigconvert --output flac 2>err >whole.flac
	head -c "$(($(wc -c <whole.flac) / 2))" whole.flac >cut.flac
	fails "a FLAC file that is cut off" 1 'cut.flac: ' sigconvert --output raw cut.flac
	fails "noise that is no sound" 1 'tsv: ' sigconvert --from sound a.tsv
else
	skip "WAV and FLAC can be tested" "built without libsndfile"
fi

fails "no rate and no times" 1 'specify --rate' sigconvert --skip-lines 1 plain.csv
fails "a missing column" 1 "no column 'x'" sigconvert --columns x daq.csv
fails "no headings" 1 'want a line of headings' sigconvert --skip-lines 2 plain.csv
printf '0.12;x0.3\n0.2;0.3\n' >torn.csv
fails "a torn first row is no heading" 1 "line 1: want a line of headings, got '0.12;x0.3'" sigconvert --rate 1Hz torn.csv
printf 't\tu\n0\t1\n1\t2\n2\t3\n5\t4\n' >gap.tsv
fails "samples that are missing" 1 'line 5: time 5 s, want 3 s' sigconvert --rate 1Hz gap.tsv
printf 't\tu\n0\t1\n1\tx\n' >word.tsv
fails "a word among samples" 1 'line 3: u: .x. is not a number' sigconvert word.tsv
printf 't\tu\n0\tinf\n1\t1e400\n' >huge.tsv
fails "a sample beyond double precision" 1 "line 3: u: '1e400' is not a number" sigconvert huge.tsv
printf 't\tu\n0\t1\n1\n' >short.tsv
fails "a short row" 1 'line 3: want 2 cells, got 1' sigconvert short.tsv
printf 'Time [kg]\tu\n0\t1\n1\t1\n' >kg.tsv
fails "times in kilograms" 1 "times in 'kg', want s, min, h or d" sigconvert --time Time kg.tsv
fails "raw without a rate" 2 'requires --rate and --channels' sigconvert --from raw a.raw
fails "channels of what is not raw" 2 'requires --from raw' sigconvert --channels 2 a.au
fails "a column of a signal" 2 '\--columns is for text' sigconvert --columns u a.au
fails "a rate that the signal states" 2 '\--rate is for text' sigconvert --rate 100Hz a.au
fails "half a frame of raw" 1 'a.raw' sh -c 'head -c 40 a.raw >h; mv h a.raw; sigconvert --from raw --rate 1 --channels 2 a.raw'
printf 'Day;u\n22.11.2026 03:04;1\n22.11.2026 03:05;2\n' >day.csv
fails "a date that is not in ISO 8601" 1 "line 2: '22.11.2026 03:04' is not a time, want a number or a moment like" \
	sigconvert --time Day day.csv

# Tables: rows at any times, with the units of the headings, for aopf and rwl.
# body FILE: a table without its first, command and last line
body() {
	grep -v -e '^# stream' -e '^# cmd' -e '^# end' "$1" | tr '\t\n' ' |'
}
printf '\357\273\277Time [h];Flow, main [l/min];Temp (C);Remark\r\n0,0;1,50;40;new\r\n20,5;1,52;;ok\r\n40;1,54;41,5;ok\r\n60;1,58;42;ok\r\n80;1,60;42;ok\r\n' >pump.csv
sigconvert --output table --columns 'Flow, main' pump.csv >pump.tsv
is "a CSV of unequal times becomes a series" "$(body pump.tsv)" \
	'# units: h l/min|t y|0 1.5|20.5 1.52|40 1.54|60 1.58|80 1.6|'
sigconvert --output table --columns 'flow, main;temp' pump.csv >two.tsv
is "several columns keep their names, in lower case" "$(body two.tsv)" \
	'# units: h l/min C|t flow,_main temp|0 1.5 40|20.5 1.52 nan|40 1.54 41.5|60 1.58 42|80 1.6 42|'
sigconvert --output table --columns 'leakage=2;unit=Remark' pump.csv >named.tsv
is "columns are renamed, and units are text" "$(body named.tsv | cut -d '|' -f 2-4)" 't leakage unit|0 1.5 new|20.5 1.52 ok'
printf 'When,Flow\n2026-11-22 23:00,1\n2026-11-23 00:00:30,2\n' | sigconvert --output table --time When >when.tsv
is "moments become seconds, and the first is the start" "$(body when.tsv)" \
	'# units: s 1|# start: 2026-11-22T23:00:00|t y|0 1|3630 2|'
printf 'Diameter [um]\n50\n60\n80\n90\n' | sigconvert --output table >sizes.tsv
near "a table without times is converted by its reader" \
	"$(debriscount --classes 10um,70um sizes.tsv >counts.tsv && column number counts.tsv | tr -d '\n')" 22 0
aopf --threshold 2.8 --mission 100h pump.tsv >life.tsv
is "aopf keeps the units" "$(sed -n 's/^# units: //p' life.tsv)" 'h l/min l/min l/min l/min 1 1 h h h 1 1'
sigconvert --output table --columns 'leakage=flow, main' pump.csv | rwl --wear-rate filter - >rest.tsv 2>err
printf 't leakage\n0 1.5\n20.5 1.52\n40 1.54\n60 1.58\n80 1.6\n' |
	rwl --wear-rate filter --time-unit h --state-unit L/min - >want.tsv 2>err
is "rwl converts the units of a table" "$(body rest.tsv)" "$(body want.tsv)"
fails "a column of words" 1 "line 2: Remark: 'new' is not a number" sigconvert --output table pump.csv
fails "a missing column is named with those of the table" 1 "no column 'Leak' among 'Time' 'Flow, main' 'Temp' 'Remark'" \
	sigconvert --output table --columns Leak pump.csv
printf 'Time,Flow\n0,1.234,5\n' >thousand.csv
fails "a separator of thousands" 1 'line 2: want 2 cells, got 3' sigconvert --output table thousand.csv
printf 'Time;Flow\n0;999.5\n1;1,234\n' >thousand.csv
fails "a separator of thousands among decimal points" 1 "line 3: '1,234': decimal points and commas in one file" sigconvert thousand.csv
printf 'Time;Flow\n0;1.234,5\n' >thousand.csv
fails "a separator of thousands in a CSV with semicolons" 1 "line 2: Flow: '1.234,5' is not a number" sigconvert --output table thousand.csv
printf 'Time;Flow\n' >empty.csv
printf 'Date,"Flow, return [L/min]",Unit\n2026-02-27,"1.5","Pump 7, left"\n2026-03-01,1.6,"called ""B"""\n' >quoted.csv
is "dates without a time, and quoted cells with separators and quotes, are read" \
	"$(sigconvert --output table --time Date --columns 'flow=Flow, return;unit=Unit' quoted.csv | grep -v '^# [sce].*:.*[^0]$' | tr '\t\n' ' |')" \
	'# units: s L/min 1|# start: 2026-02-27T00:00:00|t flow unit|0 1.5 Pump 7, left|172800 1.6 called "B"|'
printf 'time,"flow, return"\n0,"1,5"\n' >decimal.csv
fails "a quoted number with a comma, between commas" 1 "flow, return: '1,5' is not a number" sigconvert --output table decimal.csv
printf 'time,y\n0,"1\n' >open.csv
fails "a quoted cell without an end" 1 'line 2: a quoted cell has no end in this line' sigconvert --output table open.csv
printf 'time,y\n0,"1"5\n' >behind.csv
fails "text behind a quoted cell" 1 'line 2: text behind a quoted cell' sigconvert --output table behind.csv
fails "a date that is not the time" 1 "Date: '2026-02-27' is not a number: specify --time" sigconvert --output table quoted.csv
printf 'Time;Flow\n0;1\n2026-11-22 23:00;2\n' >mixed.csv
fails "a date below a number of seconds" 1 "line 3: '2026-11-22 23:00' is not a time" sigconvert --output table mixed.csv
printf 'time [s];T [K];u\n0;1;2\n1;3;4\n' >twice.csv
fails "a second column 't' beside the times" 1 "column 'T' would be called 't' as the times are" sigconvert --output table twice.csv
sigconvert --output table --columns 'kelvin=T;u' twice.csv >renamed.tsv
is "a column renamed no longer collides with the times" "$(body renamed.tsv)" '# units: s K 1|t kelvin u|0 1 2|1 3 4|'
printf 'time [s];1;2\n0;1;2\n1;3;4\n2;5;6\n' >numbered.csv
is "columns may be called by numbers" "$(sigconvert --rate 1Hz numbered.csv | records --check | grep -c 'frames 3, whole')" 1
printf 'time;A;a\n0;1;2\n' >same.csv
fails "two columns that differ by capitals" 1 "two columns are called 'a'" sigconvert --output table same.csv
printf 'time [2s],u [0mV]\n0,1\n1,3\n' >digit.csv
fails "a unit of time that begins with a digit" 1 "times in '2s', want s, min, h or d" sigconvert digit.csv
fails "headings alone" 1 'no row below the headings' sigconvert --output table empty.csv
fails "a rate for a table" 2 'table converts text: no --rate' sigconvert --output table --rate 1Hz pump.csv
for twice in 0 1; do
	awk -v twice=$twice 'BEGIN { print "time u"; for (i = 0; i < 600; i++) {
		if (i != 400 || twice) printf "%.3f %d\n", i / 1000, i
		if (i == 400 && twice) printf "%.3f %d\n", i / 1000, i } }' >whole.txt
	fails "one sample too $(test $twice = 0 && echo few || echo many) among times of one digit a sample" 1 \
		'line 40[23]: time 0.40*1* s, want 0.40*1* s' sigconvert whole.txt
done
# A doubt stated behind the rows, or twice before them, reaches every output or the status.
# ended FILE: gives a table the end line that its own message asks for.
ended() {
	n=$(grep -c '^[0-9]' "$1")
	sum=$(sigconvert "$1" 2>&1 >/dev/null | sed -n 's/.* and \([0-9a-f]*\): damaged.*/\1/p')
	sed "s/^# end: .*/# end: $n rows, crc32 $sum/" "$1"
}
{
	sed '$d' a.tsv
	printf '# doubtful: the amplifier drifted\n# end: 1 rows, crc32 00000000\n'
} >edited.tsv
ended edited.tsv >late.tsv
{
	sed -n '1,/^# rate/p' a.tsv
	printf '# doubtful: hum\n# doubtful: offset\n'
	sed '1,/^# rate/d;$d' a.tsv
	echo '# end: 1 rows, crc32 00000000'
} >edited.tsv
ended edited.tsv >early.tsv
for output in au raw channels; do
	fails "a late doubt is told with --output $output" 3 'doubtful by its own account: the amplifier drifted' \
		sh -c "sigconvert --output $output late.tsv >out.$output"
done
like "the table of channels states it" "$(cat out.channels)" '# doubtful: the amplifier drifted'
ok "text states a late doubt behind the rows" sh -c 'sigconvert --output text late.tsv >out.tsv'
is "in its own words" "$(sed -n 's/^# doubtful: //p' out.tsv)" "the amplifier drifted"
ok "a signal states the doubts before the rows" sh -c 'sigconvert early.tsv >out.au'
is "text of that signal states all of them" \
	"$(sigconvert --output text out.au | sed -n 's/^# doubtful: //p')" "hum; offset"
fails "raw samples cannot state them" 3 'doubtful by its own account: hum; offset' \
	sh -c 'sigconvert --output raw out.au >out.raw'

printf 'time,a,b\n0,1,2\n1,1,1e10\n' >large.csv
fails "a scale that no double holds makes no sample infinite" 1 'frame 1: 1e+10 times --scale 1e+300 is beyond' \
	sigconvert --scale 1e300 --output text large.csv
done_testing

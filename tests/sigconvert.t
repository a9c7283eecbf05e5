#!/bin/sh
# sigconvert: recordings of other programs in and out, exact where the format is
. "$(dirname "$0")/tap.sh"

# samples FILE: all samples of a signal, parted by blanks
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
is "rate and channels are kept" "$(sed -n 's/^# rate: //p' b.tsv) $(head -n 4 b.tsv | grep ^time)" \
	"10000 $(printf 'time\tchannel1\tchannel2')"
sigconvert --output raw a.au >a.raw
is "raw has 8 bytes a sample" "$(wc -c <a.raw)" 48000
sigconvert --from raw --rate 10kHz --channels 2 --output text a.raw >c.tsv
is "raw reads back to the last bit" "$(rows a.tsv)" "$(rows c.tsv)"
is "the header holds the pipeline" "$(sed -n 's/^# cmd: .*| //p' a.tsv)" "sigconvert --output text"

printf 'Time [ms];Flow [L/min];"u1 [mV]";u2 (V)\r\n0,0;60;1500,5;2\r\n0,5;61;-20;nan\r\n1,0;60;3;4\r\n' >daq.csv
sigconvert --columns 'u1;u2' daq.csv >d.au
is "columns by name, units and decimal commas" "$(samples d.au)" "1.5005 2 -0.02 nan 0.003 4"
is "the times tell the rate" "$(sigconvert --output text d.au | sed -n 's/^# rate: //p')" 2000
sigconvert --columns 2 --scale 0.5 daq.csv >d.au
is "a column by number, scaled" "$(samples d.au)" "30 30.5 30"
printf 'made by hand\na,b\n1.5,2\n3,4\n' >plain.csv
sigconvert --skip-lines 1 --rate 100Hz plain.csv >d.au
is "no times: the rate is told" "$(samples d.au)" "1.5 2 3 4"
printf 'a b\n1 2\n3 4\n' | sigconvert --from text --rate 100Hz >d.au
is "blanks, from a pipe" "$(samples d.au)" "1 2 3 4"

# Noise of 1 mV with runs of four at the top of channel 1; channel 2 does not move.
sensorsim --uniform 10um:11um --number 1 --duration 2s --noise 1mV | sigconvert --output text |
	awk -F '\t' -v OFS='\t' '/^[0-9]/ { if (NR % 1000 < 4) $2 = 0.02; $3 = 0.5 } { print }' |
	sigconvert --from text | sigconvert --output channels >channels.tsv
is "samples at the end of the range" "$(column rails channels.tsv | tr '\n' ' ')" '80 20000 '
is "and that end" "$(column high channels.tsv | tr '\n' ' ')" '0.02 0.5 '
near "the noise of the quiet stretches, less 6 %" "$(column level channels.tsv | head -n 1)" 9.4e-4 3e-5
is "that of a dead channel" "$(column level channels.tsv | tail -n 1)" 0

if sigconvert --output wav a.au >a.wav 2>err; then
	sigconvert --output text a.wav >w.tsv
	is "WAV in float64 reads back to the last bit" "$(rows a.tsv)" "$(rows w.tsv)"
	sigconvert --from sound --output text <a.wav >w.tsv
	is "also through a pipe" "$(rows a.tsv)" "$(rows w.tsv)"
	sigconvert --output flac --scale 0.1 a.au >a.flac
	sigconvert --output text --scale 10 a.flac >f.tsv
	near "FLAC has 24 bits" "$(paste a.tsv f.tsv | awk '/^[0-9]/ { d = $2 - $5; d = d < 0 ? -d : d; m = d > m ? d : m }
		END { printf "%.9f", m }')" 0 1.2e-6
	printf 't\tu\n0\t0.5\n0.001\t2\n0.002\t-3\n' | sigconvert --from text --output flac --stats st >clip.flac 2>err
	is "clipping is counted, said and marked: status 3" "$? $(column samples_clipped st) $(grep -c 'clipped' err)" "3 2 1"
	is "and cuts at full scale" "$(samples clip.flac | awk '{ printf "%.3f %.3f %.3f", $1, $2, $3 }')" "0.500 1.000 -1.000"
	head -c 20 a.wav >cut.wav
	fails "a WAV that is cut off" 1 'cut.wav' sigconvert cut.wav
	fails "noise that is no sound" 1 'tsv: ' sigconvert --from sound a.tsv
else
	skip "WAV and FLAC" "built without libsndfile"
fi

fails "no rate and no times" 1 'specify --rate' sigconvert --skip-lines 1 plain.csv
fails "a column that is not there" 1 "no column 'x'" sigconvert --columns x daq.csv
fails "no headings" 1 'want a line of headings' sigconvert --skip-lines 2 plain.csv
printf 't\tu\n0\t1\n1\t2\n2\t3\n5\t4\n' >gap.tsv
fails "samples that are missing" 1 'line 5: time 5 s, want 3 s' sigconvert --rate 1Hz gap.tsv
printf 't\tu\n0\t1\n0.3\t2\n0.6\t3\n' >odd.tsv
fails "a rate that is not whole" 1 'not an integer' sigconvert odd.tsv
printf 't\tu\n0\t1\n1\tx\n' >word.tsv
fails "a word among samples" 1 'line 3: not a number' sigconvert word.tsv
printf 't\tu\n0\t1\n1\n' >short.tsv
fails "a short row" 1 'line 3: want 2 cells, got 1' sigconvert short.tsv
printf 'Time [kg]\tu\n0\t1\n1\t1\n' >kg.tsv
fails "times in kilograms" 1 'want a unit of time' sigconvert --time Time kg.tsv
fails "raw without a rate" 2 'requires --rate and --channels' sigconvert --from raw a.raw
fails "channels of what is not raw" 2 'requires --from raw' sigconvert --channels 2 a.au
fails "half a frame of raw" 1 'a.raw' sh -c 'head -c 40 a.raw >h; mv h a.raw; sigconvert --from raw --rate 1 --channels 2 a.raw'
done_testing

#!/bin/sh
# bpfilter: taps, response, streaming, delay, bad input
. "${0%/*}/tap.sh"
. "$top/tests/au.sh"

impulse() {
	awk -v n="$1" -v at="$2" 'BEGIN { for (i = 0; i < n; i++) print i == at ? 1 : 0 }'
}

# response: the filter of the thesis at 10 kHz
bpfilter --response >response.tsv
for want in 0:-24.5 20:-17.4 50:-6.3 70:-2.2 100:0 130:-2.1 150:-6.2 200:-30.5 2000:-61.9; do
	got=$(awk -F '\t' -v f="${want%:*}" '$1 == f { print $3 }' response.tsv)
	near "the level at ${want%:*} Hz is that of the window method" "$got" "${want#*:}" 0.05
done
got=$(bpfilter --response --no-scale | awk -F '\t' '$1 == 100 { print $3 }')
near "without scaling the level at the centre is -4.57 dB" "$got" -4.57 0.005
got=$(bpfilter --response --order 800 | awk -F '\t' '$1 == 50 { print $3 }')
near "order 800 reaches -48 dB at 50 Hz" "$got" -48 0.5
got=$(bpfilter --response --zero-phase | awk -F '\t' '$1 == 80 || $1 == 120 { s += ($4 < 0 ? -$4 : $4) } END { print s }')
near "the phase in the band is zero without the delay" "$got" 0 1e-9

rm -f err
for rate in 10kHz 48kHz; do
	bpfilter --taps --rate $rate >taps 2>>err
done
is "too few taps for the rate are reported: the band-pass passes 0 Hz" "$(cat err)" \
	"bpfilter: --order 200 is too low for the band at a rate of 48000 Hz: the gain at 0 Hz is 1.1 times that in the band"

# an impulse gives the taps, causal and with the delay taken out
bpfilter --taps | column tap /dev/stdin >taps
impulse 500 50 | au 10000 1 >impulse.au
bpfilter impulse.au >h.au
frames h.au | sed -n 51,251p >got
near "the response to an impulse is the taps" "$(worst taps got)" 0 1e-16
is "the number of frames is unchanged" "$(frames h.au | wc -l)" 500
bpfilter --zero-phase impulse.au >z.au
is "--zero-phase keeps the number of frames" "$(frames z.au | wc -l)" 500
frames z.au | sed -n 1,151p >left
frames h.au | sed -n 101,251p >right
near "--zero-phase shifts by half the order" "$(worst left right)" 0 1e-16
impulse 60 10 | au 10000 1 | bpfilter --zero-phase >short.au
is "--zero-phase accepts a record shorter than the filter" "$(frames short.au | wc -l)" 60

# channels do not mix; the pipe's block size does not matter
awk 'BEGIN { for (i = 0; i < 5000; i++) print sin(i * i / 900), i % 37 / 37 - 0.5, 0 }' >three
au 10000 3 <three >three.au
bpfilter three.au >three.out
awk '{ print $2 }' three | au 10000 1 | bpfilter >one.out
frames three.out | awk 'NR % 3 == 2' >a
frames one.out >b
same "a channel among three is filtered as if it were alone" a b
is "a silent channel remains silent" "$(frames three.out | awk 'NR % 3 == 0 && $1 != 0' | wc -l)" 0
(
	head -c 1000 three.au
	sleep 0.05
	tail -c +1001 three.au | dd bs=777 2>/dev/null
) | bpfilter >dripped
cat three.au | bpfilter >poured
same "a slow pipe gives the same bytes" dripped poured
bpfilter -S stats three.au >/dev/null
is "silent blocks are skipped, a third of all blocks here" \
	"$(column blocks stats)/$(column blocks_left_out stats)" 6/3
bpfilter --latency 1ms three.au >prompt.au
frames three.out >a
frames prompt.au >b
near "--latency changes the result only by rounding" "$(worst a b)" 0 2e-15

# what is done is written at once where a latency is wanted
mkfifo open live
bpfilter --latency 5ms <open >live &
exec 8>open
head -c 24000 three.au >&8
is "--latency writes output before the input ends" "$(timeout 60 head -c 20000 live | wc -c)" 20000
exec 8>&-
wait

# lines: gone to the last digits where they keep their amplitude, hardly any harm to pulses
sensorsim --uniform 50um:50um --number 0 --duration 9.7 --mains 0.5,0.3,0.05 >lines.au
bpfilter -b 0:5000 --zero-phase --lines 50,150,250 lines.au >clean.au
is "--lines keeps the number of frames" "$(frames clean.au 2 | wc -l)" 97000
near "--lines removes steady lines" "$(frames clean.au | awk '{ d = $1 < 0 ? -$1 : $1
	if (d > m) m = d } END { print m }')" 0 1e-10
pulses="--uniform 50um:150um --number 200 --duration 10 --noise 10mV"
sensorsim $pulses >without.au
sensorsim $pulses --mains 0.5,0.3,0.05 | bpfilter -b 0:5000 --zero-phase --lines 50,150,250 >clean.au
frames without.au >a
frames clean.au >b
near "--lines distorts pulses by less than the tolerance" \
	"$(paste a b | awk '{ s += ($1 - $2) ^ 2 } END { print sqrt(s / NR) }')" 0 2e-3
# an offset stays; a line of 10 Hz that grows by half in 10 s is followed
awk 'BEGIN { for (i = 0; i < 10000; i++) { a = 1 + i / 20000
	print 7 + a * sin(6.283185307179586 * i / 100) } }' | au 1000 1 |
	bpfilter -b 0:500 --zero-phase --lines 10 --line-window 0.5 >grow.au
near "--lines follows a changing amplitude and keeps the offset" "$(frames grow.au |
	awk 'NR > 500 && NR < 9500 { d = $1 - 7; if (d < 0) d = -d; if (d > m) m = d } END { print m }')" 0 2e-3
for n in 0 1 10 999 1000 1001 2500; do
	awk -v n="$n" 'BEGIN { for (i = 0; i < n; i++) print sin(i / 5) }' | au 1000 1 |
		bpfilter -b 0:500 --zero-phase --lines 31.830988618 --line-window 1 >part.au
	frames part.au | awk '{ d = $1 < 0 ? -$1 : $1; if (d > m || /nan/) m = d } END { print NR, (m !~ /nan/ && m < 1e-6) }'
done >parts
is "--lines accepts records of any length" "$(tr '\n' ' ' <parts)" \
	"0 1 1 1 10 0 999 1 1000 1 1001 1 2500 1 "
fails "lines too near for the window" 2 'window of 0.1 s' bpfilter --lines 50,55 --line-window 0.1 lines.au
fails "lines out of order" 2 'in order' bpfilter --lines 150,50 lines.au
fails "a line at half the rate" 1 'half the rate' bpfilter --lines 5000 lines.au

# numpy and scipy, where they are; bands much narrower than 10 Hz magnify the last bits of
# sin() when scaled, on both sides
if python3 -c 'import scipy.signal' 2>/dev/null; then py=python3; else py=/usr/bin/python3; fi
if $py -c 'import scipy.signal' 2>/dev/null; then
	cat >compare.py <<'END'
import subprocess, sys
import numpy as np
from scipy.signal import firwin, kaiser_beta
worst = 0
for n in (2, 3, 31, 200, 1001, 20000):
    for lo, hi in ((70, 130), (0.1, 4999.9), (1000, 1010), (0, 60), (4000, 5000)):
        for w in ("hamming", "hann", "blackman", "kaiser"):
            for scale in (True, False):
                if hi == 5000 and n % 2:
                    continue
                args = ["bpfilter", "--taps", "--order", str(n), "-b", "%g:%g" % (lo, hi), "--window", w]
                out = subprocess.run(args + ([] if scale else ["--no-scale"]), check=True,
                                     capture_output=True, text=True).stdout
                h = np.array([float(l.split("\t")[1]) for l in out.split("\n")
                              if l and l[0] in "-0123456789"])
                window = ("kaiser", kaiser_beta(60)) if w == "kaiser" else w
                cut = hi if lo == 0 else lo if hi == 5000 else [lo, hi]
                g = firwin(n + 1, cut, window=window, pass_zero=lo == 0, scale=scale, fs=1e4)
                worst = max(worst, abs(h - g).max())
print(worst)
END
	near "the taps equal those of scipy.signal.firwin" "$($py compare.py)" 0 1e-14
else
	skip "the taps equal those of scipy.signal.firwin" "no scipy"
fi

# what it refuses
fails "no such file" 1 'none.au' bpfilter none.au
seq 100 >text
fails "text for a signal" 1 'text: this is text, want signal' bpfilter text
fails "edges the wrong way round" 2 'first edge' bpfilter -b 130:70 impulse.au
fails "a band of one edge" 2 'band 70: want LO:HI' bpfilter -b 70 impulse.au
fails "a file that --response does not read" 2 'have no input' bpfilter --response impulse.au
fails "a file that --taps does not read" 2 'have no input' bpfilter --taps impulse.au
fails "taps and response at once" 2 'exclude one another' bpfilter --response --taps
fails "edge above half the rate" 1 'impulse.au.*above half the rate' bpfilter -b 70:5001 impulse.au
fails "odd order with --zero-phase" 2 'even --order' bpfilter --zero-phase --order 201 impulse.au
fails "odd order for a high-pass" 2 'odd --order' bpfilter --order 201 -b 100:5000 impulse.au
awk 'NR == 4001 { $2 = "nan" } 1' three | au 10000 3 >nan.au
fails "a nan is named" 1 'nan.au: frame 4000, channel 2' bpfilter nan.au
awk 'NR == 1 { $3 = "inf" } 1' three | au 10000 3 >inf.au
fails "an infinity is named" 1 'inf.au: frame 0, channel 3' bpfilter inf.au
head -c 1001 three.au >cut.au
fails "a stream cut inside a frame" 1 'cut.au' bpfilter cut.au
fails "a full disk" 1 'o space' sh -c 'bpfilter three.au >/dev/full'

# The first frame comes out N/2 frames later.
sensorsim --uniform 50um:60um --number 1 --duration 50ms >short.au
sigconvert --output channels short.au >channels.tsv
short=$(column frames channels.tsv | head -n 1)
fails "a record that is within the filter at its end" 3 "the delay of order $((2 * short)) is longer than the $short frames" \
	sh -c "bpfilter --order $((2 * short)) --band 70:2000 short.au >out.au"
ok "one more frame than the delay" bpfilter --order $((2 * short - 2)) --band 70:2000 short.au
ok "a short record without delay" bpfilter --zero-phase --order $((2 * short)) --band 70:2000 short.au

done_testing

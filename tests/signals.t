#!/bin/sh
# Signal streams: what is read, what is refused and in which words; sox and numpy read ours
. "$(dirname "$0")/tap.sh"
. "$top/tests/au.sh"

# word N: N as four bytes, big-endian, in printf escapes
word() {
	awk -v n="$1" 'BEGIN { printf "\\%03o\\%03o\\%03o\\%03o", int(n / 16777216) % 256,
		int(n / 65536) % 256, int(n / 256) % 256, n % 256 }'
}
# au HEADER SIZE ENCODING RATE CHANNELS: an AU header
au() {
	printf '.snd'
	for n in "$@"; do
		# shellcheck disable=SC2059 # the escapes are the message
		printf "$(word "$n")"
	done
}
# The taps of a filter that passes everything: order 2, band 0 to half the rate, no scaling
# leaves the middle tap, so that what comes out is what went in, one frame late.
unfiltered() {
	bpfilter --band 0:"$2" --order 2 --zero-phase --no-scale "$1"
}
# samples FILE: the samples of our 64-bit AU output as numbers
samples() {
	frames "$1" | awk '{ printf "%.10g ", $1 }'
}
{ au 24 4294967295 3 8000 2; printf '\100\000\300\000\040\000\340\000'; } >pcm16.au
ok '16-bit PCM is read' sh -c 'bpfilter --band 0:4000 --order 2 --zero-phase --no-scale pcm16.au >out.au'
is '16-bit PCM is scaled to one' "$(samples out.au)" '0.5 -0.5 0.25 -0.25 '
{ au 24 4 2 8000 2; printf '\100\300\040\340'; } >pcm8.au
unfiltered pcm8.au 4000 >out.au
is '8-bit PCM is read' "$(samples out.au)" '0.5 -0.5 0.25 -0.25 '
{ au 24 6 4 8000 1; printf '\100\000\000\300\000\000'; } >pcm24.au
unfiltered pcm24.au 4000 >out.au
is '24-bit PCM with a declared length is read' "$(samples out.au)" '0.5 -0.5 '
{ au 24 8 6 8000 1; printf '\077\000\000\000\300\000\000\000'; } >float.au
unfiltered float.au 4000 >out.au
is '32-bit float beyond one is read' "$(samples out.au)" '0.5 -2 '
{ au 24 4294967295 7 8000 1; printf '\077\340\000\000\000\000\000\000'; } >double.au
unfiltered double.au 4000 >out.au
is '64-bit float is read' "$(samples out.au)" '0.5 '
is 'the length of the output is unknown' "$(od -An -tx1 -j8 -N4 out.au | tr -d ' ')" ffffffff
is 'the header records the command' "$(strings out.au | grep '^cmd' | cut -c 1-26)" 'cmd bpfilter --band 0:4000'
au 24 4294967295 7 8000 2 >empty.au
ok 'a signal without samples is read' sh -c 'bpfilter --band 0:4000 --order 2 empty.au >out.au'

fails 'a header cut off' 1 'want an AU header of at least 24 bytes, got 6' sh -c 'head -c 6 double.au | bpfilter'
fails 'another format' 1 "this is WAV audio, want signal: sigconvert" sh -c 'printf RIFFxxxxxxxxxxxxxxxxxxxxxxxx | bpfilter'
# refuse NAME PATTERN HEADER...
refuse() {
	name=$1
	pattern=$2
	shift 2
	au "$@" >bad.au
	fails "$name" 1 "$pattern" bpfilter bad.au
}
refuse 'a header of 2 GB' 'AU header of 2147483647 bytes' 2147483647 0 7 8000 1
refuse 'a header of 7 bytes' 'AU header of 7 bytes' 7 0 7 8000 1
refuse 'an annotation cut off' 'the stream ends inside the header' 64 0 7 8000 1
refuse 'an encoding we do not read' 'AU encoding 1, want 2 to 7' 24 0 1 8000 1
refuse 'no channels' '0 channels, want 1 to 64' 24 0 7 8000 0
refuse 'a rate of zero' 'rate 0 Hz' 24 0 7 0 1
{ cat double.au; printf xyz; } >odd.au
fails 'an end inside a frame' 1 'ends inside a frame: want 8 bytes, got 3' bpfilter --band 0:4000 --order 2 odd.au
{ au 24 16 7 8000 1; printf '\077\340\000\000\000\000\000\000'; } >short.au
fails 'a declared length not held' 1 'want 16 bytes of samples, got 8' bpfilter --band 0:4000 --order 2 short.au
{ cat short.au; printf 'xyz'; } >shorter.au
fails 'a declared length that ends inside a frame' 1 'want 16 bytes of samples, got 11' \
	bpfilter --band 0:4000 --order 2 shorter.au
{ au 24 4294967295 7 8000 1; printf '\177\370\000\000\000\000\000\000'; } >nan.au
fails 'a sample that is no number' 1 'frame 0, channel 1: sample is not a finite number' bpfilter --band 0:4000 --order 2 nan.au

# A pipe that delivers a byte at a time changes nothing.
bpfilter --band 1000:3000 --order 2 pcm16.au >whole.au
dd if=pcm16.au bs=1 2>/dev/null | bpfilter --band 1000:3000 --order 2 >dripped.au
is 'input that arrives slowly gives the same samples' "$(samples dripped.au)" "$(samples whole.au)"

if command -v sox >/dev/null; then
	is 'sox reads the output' "$(unfiltered pcm16.au 4000 | sox -t au - -t dat - 2>/dev/null |
		awk '!/^;/ { printf "%g %g ", $2, $3 }')" '0.5 -0.5 0.25 -0.25 0 0 '
else
	skip 'sox reads the output' 'no sox'
fi
if /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
	unfiltered pcm16.au 4000 >out.au
	is 'numpy reads the output' "$(/usr/bin/python3 -c "
import numpy as np
b = open('out.au', 'rb').read()
x = np.frombuffer(b, '>f8', offset=int.from_bytes(b[4:8], 'big')).reshape(-1, 2)[:-1]
print(x.shape, x[1, 1])")" '(2, 2) -0.25'
else
	skip 'numpy reads the output' 'no numpy'
fi
if command -v octave >/dev/null; then
	unfiltered pcm16.au 4000 >out.au
	is 'Octave reads the output' "$(octave --no-gui --norc --eval \
		"[x, rate] = audioread('out.au'); x = x(1:end-1, :); printf('%g %g %g %g', rate, x(1, 1), x(end, 2), rows(x))" 2>/dev/null)" \
		'8000 0.5 -0.25 2'
else
	skip 'Octave reads the output' 'no octave'
fi
if command -v gnuplot >/dev/null; then
	unfiltered pcm16.au 4000 >out.au
	skip=$(od -An -tu1 -j4 -N4 out.au | awk '{ print ((($1 * 256) + $2) * 256 + $3) * 256 + $4 }')
	is 'gnuplot reads the output' "$(gnuplot -e "set table; plot 'out.au' binary skip=$skip format='%double%double' endian=big using 0:1 with lines" |
		awk '/^ *[0-9]/ { printf "%g %.4f ", $1, $2 }')" '0 0.5000 1 0.2500 2 0.0000 '
else
	skip 'gnuplot reads the output' 'no gnuplot'
fi
# Samples of the other byte order: sines, whose last bytes are random, and whole numbers, whose last bytes are 0.
# turned ENCODING PACK SCALE: 400 samples
turned() {
	au 24 4294967295 "$1" 8000 1
	perl -e 'print map { pack $ARGV[0], $ARGV[1] == 1 ? sin $_ : int $ARGV[1] * sin $_ } 1 .. 400' "$2" "$3"
}
for type in '6 f' '7 d'; do
	for scale in 1 9; do
		turned ${type% *} "${type#* }<" $scale >turned.au
		fails "little-endian samples of encoding ${type% *} (times $scale)" 1 'turned.au: samples of impossible magnitudes' \
			sigconvert --output raw turned.au
		turned ${type% *} "${type#* }>" $scale >turned.au
		ok "big-endian samples of encoding ${type% *} are read (times $scale)" sigconvert --output raw turned.au
	done
done
done_testing

#!/bin/sh
# duet --method duet --align 0: the sources of a whole record
. "$(dirname "$0")/tap.sh"
. "$top/tests/au.sh"

# Two tones that take turns, the first stronger and earlier at sensor 2, the second weaker
# and later, as a table of frames: x1 x2 first second.
awk 'BEGIN { pi = atan2(0, -1)
	for (n = 0; n < 16000; n++) { t = n / 8000
		for (k = 0; k < 2; k++) { e = sin(pi * (3 + 2 * k) * t); e = e > 0 ? e * e : 0
			w = 2 * pi * (310 + 230 * k); d = k ? 1.5 : -1; a = k ? 0.8 : 1.2
			s[k] = e * sin(w * t) + e * sin(3 * w * t) / 2
			u = t - d / 8000
			z[k] = a * (e * sin(w * u) + e * sin(3 * w * u) / 2) }
		printf "%.9g %.9g %.9g %.9g\n", s[0] + s[1], z[0] + z[1], s[0], s[1] } }' >all.txt
perl -e 'print pack("N8", 0x2e736e64, 32, 0xffffffff, 7, 8000, 2, 0, 0);
	while (<>) { my @c = split; print pack("d>2", @c[0, 1]) }' all.txt >mix.au
duet --method duet --align 0 --separated apart.au --sections sections.tsv --histogram h.tsv \
	mix.au >found.tsv
is "the exit status is 0" $? 0
grep '^# source' found.tsv | awk '{ print $5, $7 * 8000 }' | sort -n >sources
near "the attenuation of the first source is found" "$(sed -n 2p sources | cut -d' ' -f1)" 1.2 0.02
near "the delay of the first source is found" "$(sed -n 2p sources | cut -d' ' -f2)" -1 0.05
near "the attenuation of the second source is found" "$(sed -n 1p sources | cut -d' ' -f1)" 0.8 0.02
near "the delay of the second source is found" "$(sed -n 1p sources | cut -d' ' -f2)" 1.5 0.05
is "the record is one section" "$(column section sections.tsv) $(column sources sections.tsv)" "1 2"
is "the histogram is complete" "$(column weight h.tsv | wc -l)" 4096
frames apart.au 8 | paste - all.txt >both.txt
# SDR of the better order, and what the sum of all channels lacks of channel 1
awk '{ e11 += ($1 - $11) ^ 2; e12 += ($1 - $12) ^ 2; e21 += ($2 - $11) ^ 2; e22 += ($2 - $12) ^ 2
	s1 += $11 ^ 2; s2 += $12 ^ 2; d = $1 + $2 - $9; if (d < 0) d = -d; if (d > m) m = d }
	END { a = s1 / e11 < s2 / e22 ? s1 / e11 : s2 / e22; b = s1 / e21 < s2 / e12 ? s1 / e21 : s2 / e12
	print 10 * log(a > b ? a : b) / log(10), m }' both.txt >sdr
ok "both sources are separated to $(cut -d' ' -f1 sdr) dB, each on the same channel throughout" \
	awk '{ exit !($1 > 9) }' sdr
near "the sources add up to channel 1" "$(cut -d' ' -f2 sdr)" 0 1e-12
duet --method duet --align 0 --sources 1 --separated one.au mix.au >one.tsv
is "one source is separated if specified" "$(grep -c '^# source' one.tsv)" 1
# shellcheck disable=SC2002 # a pipe is meant
cat mix.au | duet --method duet --align 0 --separated piped.au >piped.tsv
frames piped.au 8 >piped
frames apart.au 8 >apart
same "a record from a pipe gives the same result" piped apart
head -c 32 mix.au >none.au
fails "no frames" 3 "nothing in common" duet --method duet --align 0 none.au
duet --method duet --align 0 --sections no.sections --histogram no.h none.au >no.tsv 2>/dev/null
is "all tables say that they are doubtful" \
	"$(grep -c '^# doubtful: nothing in common of both channels' no.tsv no.sections no.h | tr '\n' ' ')" \
	"no.tsv:1 no.sections:1 no.h:1 "
# Sensor 2 hears the tones 40 samples later.
awk '{ a[NR] = $3; b[NR] = $4 } END { for (i = 41; i <= NR; i++) print a[i] + b[i], a[i - 40] + b[i - 40] }' all.txt |
	perl -e 'print pack("N8", 0x2e736e64, 32, 0xffffffff, 7, 8000, 2, 0, 0);
	while (<>) { my @c = split; print pack("d>2", @c) }' >late.au
duet --method duet --align 0 late.au >late.tsv 2>err
is "the table says that delays beyond 16 samples are doubtful" \
	"$? $(grep '^# doubtful' late.tsv)" "3 # doubtful: delays beyond 16 samples"
# Voices of 150 and 190 Hz at 16 kHz that take turns, with nothing below: one is heard 10 or
# 24 samples later.
voices() {
	awk -v late="$1" 'BEGIN { pi = atan2(0, -1); srand(1)
		for (n = 0; n < 32000; n++) { x = y = 0
			for (k = 0; k < 2; k++) { d = k ? late : 1
				for (h = 1; h < 12; h++) { w = 2 * pi * h * (150 + 40 * k) / 16000
					x += voice(n, k) * cos(w * n + h * h) / h
					y += voice(n - d, k) * cos(w * (n - d) + h * h) / h } }
			print x + (rand() - 0.5) / 50, y + (rand() - 0.5) / 50 } }
	function voice(n, k, e) { e = sin(pi * (n / 16000 * 3 + k / 2)); return e > 0 ? e * e : 0 }' |
		perl -e 'print pack("N8", 0x2e736e64, 32, 0xffffffff, 7, 16000, 2, 0, 0);
		while (<>) { my @c = split; print pack("d>2", @c) }'
}
for late in 10 24; do
	voices $late | duet --method duet --align 0 >late.tsv 2>err
	echo $?
done >late
is "voices without low frequencies are doubted with a delay of 24 samples, not of 10" "$(paste -s -d ' ' late)" "0 3"
# delays: of the sources of the record on standard input, samples at 16 kHz
delays() {
	duet --method duet --align 0 | sed -n 's/^# source.* \([-0-9.e+]*\) s.*/\1/p' >found
	awk '{ printf "%.1f\n", $1 * 16000 }' found | sort -n | paste -s -d ' ' -
}
# The delays of voices() are 1 and 3; these are 10 and 12, which only low frequencies tell
# from others.
later() {
	sigconvert --output text | awk -F '\t' '/^[0-9]/ { x[++n] = $2; y[n] = $3 }
		END { print "x y"; for (i = 10; i <= n; i++) print x[i], y[i - 9] }' | sigconvert --rate 16kHz
}
is "voices two samples apart are two sources" "$(voices 3 | delays)" "1.0 3.0"
is "also with delays of ten and twelve samples" "$(voices 3 | later | delays)" "10.0 12.0"

fails "a hop without a window" 2 "hop requires a --window" duet --method duet --align 0 --hop 9 mix.au
done_testing

# shellcheck shell=sh
# au.sh - make and read AU streams in tests; read it after tap.sh
#
#	au RATE CHANNELS <VALUES >FILE    one frame of doubles a line; nan, inf and tiny
#	                                  (2e-320) are words
#	frames FILE [CHANNELS]            the doubles of a stream, one frame a line, without
#	                                  the end of a stream that has one
#	worst FILE FILE                   largest difference between two lists of numbers of
#	                                  equal length

au() {
	awk -v rate="$1" -v channels="$2" '
	function byte(b) { printf "\\%03o", b }
	function word(w) {
		byte(int(w / 16777216)); byte(int(w / 65536) % 256)
		byte(int(w / 256) % 256); byte(w % 256)
	}
	function put(x,   s, e, m, hi, lo) {
		if (x == "nan") { word(2146959360); word(0); return }
		if (x == "inf") { word(2146435072); word(0); return }
		if (x == "tiny") { word(0); word(4096); return }
		x += 0
		if (x == 0) { word(0); word(0); return }
		s = x < 0; x = s ? -x : x; e = 1023
		while (x >= 2) { x /= 2; e++ }
		while (x < 1) { x *= 2; e-- }
		m = x - 1; hi = int(m * 1048576); lo = (m * 1048576 - hi) * 4294967296
		word(s * 2147483648 + e * 1048576 + hi); word(int(lo))
	}
	BEGIN { printf ".snd"; word(24); word(4294967295); word(7); word(rate); word(channels) }
	{ for (i = 1; i <= NF; i++) put($i) }' >au.text
	printf "$(cat au.text)"
}

frames() {
	header=$(od -An -tu1 -j4 -N4 "$1" | awk '{ print (($1 * 256 + $2) * 256 + $3) * 256 + $4 }')
	held=0
	! head -c "$header" "$1" | grep -qa 'stream wearpipe' || held=$(od -An -tu1 -j23 -N1 "$1")
	tail -c +$((header + 1)) "$1" | od -An -v -tu1 -w8 | awk -v channels="${2:-1}" -v held="$held" '{
		s = $1 >= 128; e = ($1 % 128) * 16 + int($2 / 16); m = $2 % 16
		for (i = 3; i <= 8; i++) m = m * 256 + $i
		if (e == 2047) x = m ? "nan" : "inf"
		else x = sprintf("%.17g", e ? (1 + m / 4503599627370496) * 2 ^ (e - 1023) : 0)
		last[NR % (held + 1)] = (s ? "-" : "") x
		k = NR - held
		if (k > 0) printf "%s%s", last[k % (held + 1)], k % channels ? "\t" : "\n" }'
}

worst() {
	paste "$1" "$2" | awk 'NF != 2 || $1 $2 ~ /[^-+.0-9e]/ { bad = 1 }
		{ d = $1 - $2; if (d < 0) d = -d; if (d > m) m = d }
		END { if (bad || !NR) print "no numbers"; else printf "%.3g\n", m }'
}

#!/bin/sh
# A day of a pump that wears, watched live: a sensor that clips, one that dies, exchanged
# sensors, stops and power cuts; and the page in a browser
. "$(dirname "$0")/../tap.sh"

# Twenty-four hours, two seconds of the record for each.  More particles from hour to hour,
# and larger ones; the volume at the end of life is reached some hours after the record.
awk 'BEGIN { srand(11); print "time\tdiameter"
	for (t = 0.1; t < 79.9; ) { printf "%.6f\t%.4e\n", t, (50 + 30 * rand() * (1 + t / 60)) * 1e-6
		t += 0.04 + 0.35 * rand() / (1 + t / 24) } }' >particles.tsv
limit=1.2e-10
end=$(awk -v v=$limit 'NR > 1 { w += 0.5235987756 * $2 ^ 3; if (w >= v) { print $1 * 1800; exit } }' particles.tsv)
awk '$1 < 47.9 || NR == 1' particles.tsv >day.tsv
sensorsim --duration 48s --noise 10mV --truth truth.tsv day.tsv >day.au
set -- --chunk 2s --overlap 0.2s --scale 1800 --threshold-volume $limit --classes 50um,75um,100um,150um
wearwatch "$@" --state day --alarm-life 20h,5h day.au 2>said
is 'an alarm of the remaining life stands at the end' $? 4
near 'as many particles are found as there were, within 1 %' "$(grep -c '^[0-9]' day/particles.tsv)" \
	"$(grep -c '^[0-9]' truth.tsv)" "$(grep -c '^[0-9]' truth.tsv | awk '{ print $1 / 100 }')"
near 'the volume is that put in, within 2 %' "$(column volume day/chunks.tsv | tail -1 | awk '{ print $1 * 1e10 }')" \
	"$(column diameter truth.tsv | awk '{ v += 0.5235987756 * $1 ^ 3 } END { print v * 1e10 }')" \
	"$(column volume day/chunks.tsv | tail -1 | awk '{ print $1 * 2e8 }')"
awk -F '\t' -v end="$end" '/^[0-9]/ && $1 >= 18 { r = $15 / (end - $3); if (r > most) most = r; if (!n++ || r < least) least = r }
	END { print (n == 6 && least > 0.5 && most < 2) }' day/chunks.tsv >within
is 'the remaining life of the last quarter is true within a factor of two' "$(cat within)" 1

# The same as a growing file, with the whole group killed again and again.
if command -v setsid >/dev/null; then
	: >growing.au
	{
		while [ "$(wc -c <growing.au)" -lt "$(wc -c <day.au)" ]; do
			head -c 250000 <&4 >>growing.au
			sleep 0.2
		done
	} 4<day.au &
	kills=0 status=137
	while [ $status = 137 ] && [ $kills -lt 60 ]; do
		# shellcheck disable=SC2016 # of the other shell
		setsid --wait sh -c 'echo $$ >group; exec wearwatch "$@"' sh "$@" --no-pictures --state killed \
			--alarm-life 20h,5h --follow growing.au 2>/dev/null &
		p=$!
		{ sleep "$(awk -v k=$kills 'BEGIN { srand(k + 1); print 0.2 + rand() * (1 + k / 5) }')"; kill -KILL "-$(cat group)"; } 2>/dev/null &
		q=$!
		wait $p
		status=$?
		kill $q 2>/dev/null
		wait $q 2>/dev/null
		kills=$((kills + 1))
	done
	wait
	is 'a growing file is worked off to its end in spite of kills' "$status $((kills > 5))" '4 1'
	same 'no row is lost or doubled' killed/chunks.tsv day/chunks.tsv
	same 'no particle is lost or doubled' killed/particles.tsv day/particles.tsv
else
	skip 'kills neither lose nor double a row' 'no setsid'
fi

# A live stream of 16-bit samples, as arecord writes it, stopped in the middle of a chunk;
# sensor 1 is driven beyond its range in hour 3, sensor 2 dead in hour 6, both exchanged in 9.
sigconvert --output text day.au | awk -F '\t' '
	/^[0-9]/ { if ($1 >= 24) exit
		if ($1 >= 5.8 && $1 < 8.2 && $2 > 0.15) $2 = 0.15
		if ($1 >= 12 && $1 < 14) $3 = 0
		if ($1 >= 18 && $1 < 20) { x = $2; $2 = $3; $3 = x }
		print $2, $3 }' |
	perl -ne 'BEGIN { binmode STDOUT; print ".snd", pack "N5", 24, 0xffffffff, 3, 10000, 2 }
		print pack "s>2", map { sprintf "%.0f", 1638 * $_ } split' >pcm.au
is 'the stream of 16 bits is as long as wanted' "$(wc -c <pcm.au | tr -d ' ')" $((24 + 240000 * 4))
head -c 400000 pcm.au | wearwatch "$@" --state faults --no-pictures 2>/dev/null
is 'the first part of a stream that was stopped is written but doubted, for a fault' "$?" 3
{ head -c 24 pcm.au && tail -c +400001 pcm.au; } | wearwatch "$@" --state faults --title 'A <pump> & its debris' 2>said
is 'the rest of the stream is written but doubted too' $? 3
# hour I: what is doubted there, without numbers
hour() {
	column doubts faults/chunks.tsv | sed -n "$(($1 + 1))p" | sed 's/:[0-9]*//g'
}
like 'clipping is doubted in its hour' "$(hour 3)" clipped1
like 'a dead sensor is reported in its hour' "$(hour 6)" dead2
like 'exchanged sensors are reported in their hour' "$(hour 9)" swapped
is 'the hours beside the faults are not doubted' "$(hour 1) $(hour 5) $(hour 11)" '- - -'
# The overlap of hour 8 reaches 0.2 s into the exchange: its pulses there pair with none.
like 'the hour before the exchange is doubted by duet or not at all' "$(hour 8)" '^\(-\|duet\)$'
near 'the hours without fault are counted as in the whole record' \
	"$(awk -F '\t' '$1 ~ /^(0|1|5|8|11)$/ { n += $7 } END { print n }' faults/chunks.tsv)" \
	"$(awk -F '\t' '$1 ~ /^(0|1|5|8|11)$/ { n += $7 } END { print n }' day/chunks.tsv)" 2

for browser in chromium chromium-browser google-chrome ''; do
	[ -z "$browser" ] || ! command -v "$browser" >/dev/null || break
done
if [ -z "$browser" ] || ! command -v gnuplot >/dev/null; then
	skip 'all pictures are drawn in a browser' 'no Chromium, or no gnuplot'
	done_testing
fi
for dir in day faults; do
	{
		grep -v 'http-equiv' $dir/index.html
		echo '<script>addEventListener("load", () => { const d = document.documentElement
		document.title = [...document.images].filter(i => i.complete && i.naturalWidth).length +
			" pictures, " + (d.scrollWidth - d.clientWidth) + " too wide, " +
			[...document.querySelectorAll("td")].filter(c => /nan|undefined/.test(c.textContent)).length + " nan" })</script>'
	} >probe.html
	for width in 400 1400; do
		"$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
			--disable-background-networking --disable-component-update --disable-sync \
			--user-data-dir="$work/profile" --enable-logging=stderr --window-size=$width,900 \
			--force-dark-mode --dump-dom "file://$work/probe.html" >dom 2>log
		like "$dir, $width pixels wide: all pictures are drawn, nothing is wider, no cell is void" \
			"$(sed -n 's/.*<title>\(.*\)<\/title>.*/\1/p' dom)" \
			"^$(grep -c '<figure>' $dir/index.html) pictures, 0 too wide, 0 nan"
		is "$dir: the page shows the wear, the sizes and, after a day, the life" \
			"$(grep -c '<figure>' $dir/index.html)" $((2 + (${#dir} == 3)))
		is "the console has no error on $dir at a width of $width pixels" "$(grep 'CONSOLE' log)" ''
	done
done
like 'the title is text and no markup' "$(cat faults/index.html)" '<h1>A &lt;pump&gt; &amp; its debris</h1>'
done_testing

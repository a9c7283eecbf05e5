#!/bin/sh
# wearwatch: a pump that wears, watched through a stop and a power cut
. "$(dirname "$0")/tap.sh"

# Six hours of a pump, one second of the record for each: particles become more, and some
# larger.
awk 'BEGIN { srand(3); print "time\tdiameter"
	for (t = 0.1; t < 5.9; t += 0.06 + 0.6 * rand() / (1 + t)) printf "%.6f\t%.4e\n", t, (60 + 40 * rand()) * 1e-6 }' >particles.tsv
sensorsim --duration 6s --noise 10mV --truth truth.tsv particles.tsv >hours.au
watch() {
	wearwatch --chunk 1s --overlap 0.1s --scale 3600 --threshold-volume 2e-10 --classes 50um,75um,100um \
		--no-pictures "$@"
}
watch --state whole hours.au 2>said
is 'a sound record is processed without a warning' "$? $(cat said)" '0 '
is 'every chunk has a row' "$(column chunk whole/chunks.tsv | tr '\n' ' ')" '0 1 2 3 4 5 '
near 'as many particles are found as were simulated' "$(grep -c '^[0-9]' whole/particles.tsv)" "$(grep -c '^[0-9]' truth.tsv)" 0
near 'the volume is that of the simulated particles within 2 %' "$(column volume whole/chunks.tsv | tail -1 | awk '{ print $1 * 1e12 }')" \
	"$(column diameter truth.tsv | awk '{ v += 0.5235987756 * $1 ^ 3 } END { print v * 1e12 }')" 1
near 'rates are per hour of operation' "$(column per_hour whole/chunks.tsv | tail -1)" \
	"$(column time1 truth.tsv | awk '$1 >= 5' | wc -l | tr -d ' ')" 0.5
is 'counts by size add up' "$(sed -n '/Sizes/,/<main>/s/.*<td>[0-9]*<\/td><td>[0-9]*<\/td><td>\([0-9]*\)<.*/\1/p;
	/Sizes/,/<main>/s/.*<td>100<\/td><td><\/td><td>\([0-9]*\)<.*/\1/p' whole/index.html |
	awk '{ n += $1 } END { print n }')" "$(grep -c '^[0-9]' truth.tsv)"

sensorsim --duration 2s --uniform 100um:150um --number 20 --material steel=3,copper --excitation 1MHz --noise 0.1mV \
	--truth copper.tsv >copper.au
watch --state copper copper.au 2>said
is 'pulses of the other sign are doubted as non-ferrous' "$? $(grep -c 'pulses have the other sign: non-ferrous' said)" '3 1'
# duet doubts one of seven, which overlaps a larger pulse
near 'all pulses of the other sign are counted' "$(column doubts copper/chunks.tsv | tr ',' '\n' | awk -F : '/^signs/ { n += $2 } END { print n }')" \
	"$(column amplitude copper.tsv | awk '$1 < 0' | wc -l | tr -d ' ')" 1

# The header has 2000 Hz for 2000.4, by which the last particles would be 1 ms late
sensorsim --rate 2000.4 --duration 6s --noise 10mV particles.tsv >fraction.au
watch --scale 1 --state fraction fraction.au
duet fraction.au | column time1 - >of_duet
near 'a rate with a fraction has its times' "$(column time1 fraction/particles.tsv | paste of_duet - | awk '
	{ d = $1 - $2; if (d < 0) d = -d; if (d > most) most = d } END { print (NR > 20 ? most : 1) }')" 0 2e-4

# Live, as a pipe: killed with all its children in the third hour, when a tenth of a second
# of the fourth is there; then started again with what comes after.
skip=$(od -An -tu1 -j4 -N4 hours.au | awk '{ print $3 * 256 + $4 }')
n=$((skip + 31000 * 16))
head -c $n hours.au >before.au
{ head -c "$skip" hours.au && tail -c +$((n + 1)) hours.au; } >after.au
started() {
	for _ in $(seq 400); do
		[ "$(grep -c '^[0-9]' cut/chunks.tsv)" -ge "$1" ] && [ "$(wc -c <cut/spool/3)" -ge 16000 ] && return
		sleep 0.05
	done 2>/dev/null
}
# Those killed are still there for a moment.
ended() {
	for _ in $(seq 400); do
		ps -A -o pgid= -o args= | awk -v g="$1" '$1 == g && !/<defunct>/ { n++ } END { exit !n }' || return
		sleep 0.05
	done
}
if command -v setsid >/dev/null; then
	mkfifo live
	# shellcheck disable=SC2016 # of the other shell
	setsid sh -c 'echo $$ >group; cat before.au - <live | wearwatch --chunk 1s --overlap 0.1s --scale 3600 --threshold-volume 2e-10 \
		--classes 50um,75um,100um --no-pictures --state cut' 2>/dev/null &
	p=$!
	exec 3>live
	started 2
	kill -KILL "-$(cat group)"
	exec 3>&-
	wait $p 2>/dev/null
	ended "$(cat group)"
	# A torn row, and rows of a chunk that has no row
	printf '3\t10800' >>cut/chunks.tsv
	printf '1\t2\t3\n' >>cut/particles.tsv
	watch --state cut <after.au 2>said
	like 'a truncated row is reported' "$(cat said)" 'the last row was cut off'
	same 'after a power failure all rows are those of an uninterrupted run' cut/chunks.tsv whole/chunks.tsv
	same 'after a power failure all particles are those of an uninterrupted run' cut/particles.tsv whole/particles.tsv
else
	skip 'a power failure can be tested' 'no setsid'
fi

# Three samples of sensor 1 are missing just before the third hour and two behind: in the
# overlap of both.  Ten are clipped there, at the largest value of the record.
sigconvert --output text hours.au | awk -F '\t' -v OFS='\t' '/^# (stream|end):/ { next }
	/^[0-9]/ { if ($1 > 1.97995 && $1 < 1.98025 || $1 > 2.03995 && $1 < 2.04015) $2 = "nan"
		if ($1 > 1.94995 && $1 < 1.95095) $3 = 10 } { print }' | sigconvert --from text >missing.au
watch --state missing missing.au 2>said
is 'missing samples of an overlap are counted once' \
	"$(column doubts missing/chunks.tsv | tr ',' '\n' | grep missing | tr '\n' ' ')" 'missing1:3 missing1:2 '
is 'clipped samples of an overlap are counted once' \
	"$(column doubts missing/chunks.tsv | tr ',' '\n' | grep clipped | tr '\n' ' ')" 'clipped2:10 '

# Sensor 1 is clipped in one hour; an alarm by rate is raised, reported once and cleared.
sigconvert --output text hours.au | awk -F '\t' -v OFS='\t' '/^[0-9]/ && $1 >= 2 && $1 < 3 && $2 > 0.3 { $2 = 0.3 }
	/^[0-9]/ && $1 < 4 { print } !/^[0-9]/ { print }' | sigconvert --from text >clipped.au
watch --state clipped --alarm-rate 6:2 --on-alarm 'echo "$WEARWATCH_ALARM" >>told' clipped.au 2>said
is 'an alarm is active at the end' $? 4
is 'the command of the alarm is called once' "$(cat told)" 'rate '
like 'clipped samples are reported' "$(cat said)" 'channel 1 is clipped'
is 'clipped samples are reported only in their hour' "$(column doubts clipped/chunks.tsv | sed 's/:.*//; s/,.*//' | tr '\n' ' ')" '- - clipped1 - '
like 'the page shows the clipping' "$(cat clipped/index.html)" 'channel 1 is clipped in [0-9]* samples'
like 'the page shows the alarm' "$(cat clipped/index.html)" 'Alarm: particles per hour'
like 'the page renews itself' "$(cat clipped/index.html)" 'http-equiv="refresh"'
is 'the page has no external link' "$(grep -cE '(src|href)="?[a-z]*:' clipped/index.html)" 0

# The header of a recorder that announced six hours and wrote two, in a file and in a stream that continues one of six
plain() {
	{ printf '.snd\0\0\0\030\0\016\246\0\0\0\0\007\0\0\047\020\0\0\0\002' && tail -c +$((skip + 1)) hours.au; } |
		head -c $((24 + 16 * $1))
}
plain 20000 >torn.au
watch --state torn torn.au 2>said
is 'a file that is shorter than its header declares is doubted' \
	"$? $(grep -c 'torn.au: cut off: want 60000 frames, got 20000' said)" '3 1'
plain 60000 | watch --state joined 2>said
is 'a stream as long as its header declares is whole' "$? $(cat said)" '0 '
plain 20000 | watch --state joined 2>said
is 'a stream that continues another is doubted by its own length' \
	"$? $(grep -c 'standard input: cut off: want 60000 frames, got 20000' said)" '3 1'
# A chunk of text behind the samples, of 0.2 s if they were some
sigconvert --output wav hours.au >hours.wav
{ cat hours.wav && printf 'LIST\0\175\0\0' && head -c 32000 hours.wav; } | watch --state listed 2>said
is 'a stream ends where its samples end' "$? $(cat said)" '0 '
watch --state filed hours.wav
same 'what follows the samples of a stream is none' listed/chunks.tsv filed/chunks.tsv
# A chunk of five bytes, and one of padding, before the format
{ head -c 12 hours.wav && printf 'JUNK\005\0\0\0abcde\0' && tail -c +13 hours.wav; } >junk.wav
watch --state junk junk.wav
same 'chunks of a WAV file may be of odd sizes' junk/chunks.tsv filed/chunks.tsv
printf 'RIFF\0\0\0\0WAVEfmt \020\0\0\0\003\0\002\0\020\047\0\0\200\070\001\0\010\0\040\0data\0\0\0\0' >narrow.wav
fails 'samples of another width for the same state' 1 'made with other options or of another stream: wav 3 8' \
	watch --state listed narrow.wav
mkdir -p full/spool/2
watch --state full <hours.wav 2>said
is 'a stream that cannot be stored fails' "$? $(column chunk full/chunks.tsv | tr '\n' ' ')$(tail -n 1 said)" \
	'1 0 wearwatch: full/spool: the stream cannot be stored'
fails 'other options for the same state' 1 'made with other options' \
	wearwatch --state whole --chunk 2s --overlap 0.1s --scale 3600 hours.au
fails 'other options of duet for the same state' 1 'made with other options' watch --state whole --duet '--calibration 9' hours.au
# A clock that is set back by an hour after the first of six chunks.  Each page asks date -u:
# after the first chunk, the second, the last whole one and the last one.
mkdir clock
cat >clock/date <<'END'
#!/bin/sh
if [ "$1" = -u ]; then
	echo page >>pages
	PATH=${PATH#*:} exec date "$@"
fi
echo x >>seconds
[ "$(wc -l <seconds)" -gt 1 ] && echo 1000000000 || echo 1000003600
END
chmod +x clock/date
PATH=$PWD/clock:$PATH watch --state back --refresh 1h hours.au
is 'a clock that is set back does not stop the page' "$(wc -l <pages | tr -d ' ')" 4
rm -r clock
sensorsim --duration 6s --noise 10mV --seed 2 particles.tsv >other.au
fails 'another recording for the same state' 1 'not the recording' watch --state whole other.au
printf 'a,b\n1,2\n' >table.csv
fails 'a table' 1 'neither AU nor WAV; sigconvert' watch --state other table.csv
fails 'an empty stream' 1 'empty' watch --state other
fails 'no state' 2 'want --state' wearwatch hours.au
fails 'a time without a number' 2 'want a time above 0' wearwatch --state other --chunk x hours.au
fails 'a time beyond a lifetime' 2 'want a time above 0, .*, to 1e9 s' wearwatch --state other --chunk 1e20s hours.au
ok 'a page is renewed once a second at most' watch --state soon --refresh 1e-5s hours.au
is 'a page that is renewed often is written without a word' "$(cat err)" ''
fails 'an overlap as long as a chunk' 2 'less than a chunk' wearwatch --state other --chunk 1s --overlap 1s hours.au
fails 'alarms of a life without an end' 2 'requires --threshold-volume' wearwatch --state other --alarm-life 2h hours.au
fails 'an alarm that clears above its level' 2 'CLEAR not above LEVEL' wearwatch --state other --alarm-rate 7:8 hours.au
fails 'alarms of a life that ascend' 2 'must be descending' \
	wearwatch --state other --threshold-volume 2e-10 --alarm-life 1h,3h hours.au
fails 'classes that descend' 2 'is not above' wearwatch --state other --classes 100um,50um hours.au
fails 'an option that duet has not' 2 'no such option' wearwatch --state other --duet '--colour 3' hours.au
fails 'an unknown option' 2 'no such option' wearwatch --colour
# Nothing wears for a while, and the record ends within the overlap behind its last whole chunk.
awk 'BEGIN { print "time\tdiameter"; for (i = 0; i < 241; i++) if (i < 85 || i > 225) print 0.05 + i / 10 "\t8e-5" }' >rest.tsv
sensorsim --duration 24.09s --noise 10mV rest.tsv >rest.au 2>err
watch --state rest rest.au 2>said
is 'a rest of the wear makes the life doubtful and the watch goes on' \
	"$? $(column chunk rest/chunks.tsv | wc -l | tr -d ' ') $(column doubts rest/chunks.tsv | grep -c life | awk '{ print ($1 > 0) }')" '3 25 1'
is 'the end of a record counts that is shorter than the overlap' \
	"$(column end rest/chunks.tsv | tail -n 1) $(column particles rest/chunks.tsv | tail -n 1)" "86724 1"
watch --state piped <rest.au 2>said
same 'a stream has the same end' piped/chunks.tsv rest/chunks.tsv
watch --state rest rest.au 2>said
same 'the end is done again in the same way' piped/chunks.tsv rest/chunks.tsv
done_testing

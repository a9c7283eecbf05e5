#!/bin/sh
# A day through sensorsim and bpfilter: memory, and no drift in time or phase.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/au.sh"

# last RATE: the last ten seconds as text, from a stream on standard input
last() {
	printf '.snd\000\000\000\030' >end.au
	head -c 16 /dev/zero >>end.au
	# The last frame is the end of the stream, no sample.
	tail -c $(($1 * 160 + 16)) | head -c $(($1 * 160)) >>end.au
	frames end.au 2
}

small() {
	near "$1 needs less than 40 MB" "$(column memory_kb "$1" | awk '{ print ($1 < 40000) }')" 1 0
}

# one particle every 10 s, its centre a quarter sample after a frame
awk 'BEGIN { print "time\tdiameter"
	for (t = 5; t < 86400; t += 10) printf "%.6f\t1e-4\n", t + 0.000025 }' >day.tsv
sensorsim --duration 1d -S sim.stats day.tsv |
	bpfilter -b 0:5000 --zero-phase --order 20 -S filter.stats | last 10000 >end
near "all frames of a day at 10 kHz are written" "$(column frames filter.stats)" 864000000 0
near "each pulse touched its own samples" "$(column pulse_samples sim.stats)" 1728000 20
small sim.stats
small filter.stats
# the last 10 s begin at 86390 s, the last pulse is at 86395.000025 s; seconds of a day in
# a double are good to 1.5e-11
near "the last pulse is where it was put" "$(awk '{
	p = NR - 1 - 50000.25; d = $1 - (p > -50 && p < 50 ? -sin(6.283185307179586 * p / 100) : 0)
	if (d < 0) d = -d; if (d > m) m = d } END { print m }' end)" 0 1e-7

sensorsim -r 200 --duration 1d --mains 0.5 --uniform 1um:1um --number 0 |
	bpfilter -b 0:100 --zero-phase --order 20 --lines 50 -S filter.stats | last 200 >end
near "the mains line is gone to the end" "$(awk '{ d = $1 < 0 ? -$1 : $1
	if (d > m) m = d } END { print m }' end)" 0 1e-7
small filter.stats

# Table 8: counted peaks follow the time the powder takes, whatever passes
for g in 2 7 3; do
	"$top"/examples/ch3-signals/count $g 1
done >counts
is "there are no peaks without debris" "$(awk '$1 == "count.2.1" { print $3 }' counts)" 0
near "group 7 has the peaks that the thesis counted" "$(awk '$1 == "count.7.1" { print $3 }' counts)" 436 40
near "group 3 has the peaks that the thesis counted" "$(awk '$1 == "count.3.1" { print $3 }' counts)" 5893 400
done_testing

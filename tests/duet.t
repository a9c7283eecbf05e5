#!/bin/sh
# duet: particles found again, whatever the method, the pipe and the nuisances
. "$(dirname "$0")/tap.sh"

# score FIELD TRUTH FOUND
score() {
	"$top/scripts/score" "$2" "$3" | column_of "$1"
}
column_of() {
	awk -F '\t' -v c="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
	{ print $k }'
}
at_least() {
	if awk -v x="$2" -v y="$3" 'BEGIN { exit !(x + 0 >= y) }'; then
		pass "$1"
	else
		fail "$1" "got:  $2" "want: at least $3"
	fi
}

sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >s.au
ok "the fit runs" sh -c "duet -v s.au >fit.tsv 2>fit.log"
is "the fit finds all particles" "$(score matched truth.tsv fit.tsv)" 60
is "the fit finds no false particle" "$(score false truth.tsv fit.tsv)" 0
# The bound at 30 dB: 3.3 sigma / A samples of delay (A from 0.51 to 1.73), 0.11 % of size.
at_most "the delays of the fit are right to 0.14 samples" "$(score delay_rms truth.tsv fit.tsv)" 14e-6
at_most "the sizes of the fit are right to 0.3 %" "$(score size_rms truth.tsv fit.tsv)" 0.003
at_least "fit: standard errors are not too small" "$(score delay_cover truth.tsv fit.tsv)" 0.5
at_most "fit: standard errors are not too large" "$(score delay_cover truth.tsv fit.tsv)" 0.85
ok "the gain is learned" grep -Eq 'gain 0\.9(0[6-9]|1[0-2])' fit.log
ok "the shape is learned" grep -q 'pulse sine' fit.log
near "velocity is spacing over delay" "$(column velocity fit.tsv | head -1)" \
	"$(column delay fit.tsv | awk 'NR == 1 { printf "%.12g", 0.25 / $1 }')" 1e-6

# Same particles however the record comes in.
(dd bs=777 2>/dev/null; :) <s.au | duet >blocks.tsv
sed 1d fit.tsv >a
sed 1d blocks.tsv >b
same "a pipe of 777-byte blocks gives the same rows" a b

# Sections longer than a window, some of them unresolved.
sensorsim --uniform 50um:150um --number 240 --duration 2s --snr 30dB --lag 0.2ms:0.5ms >long.au
duet --stats stats.tsv long.au | sed 1d >a
(dd bs=5003 2>/dev/null; :) <long.au | duet | sed 1d >b
same "the same where sections are cut into windows" a b
# White noise is not guessed at, though hardly anything is quiet between dense pulses.
is "a dense white record is learned once" "$(column_of calibrations <stats.tsv)" 1

# Twins 2 ms apart: one peak to the eye.
sensorsim --uniform 90um:110um --number 40 --burst 2 --span 3ms --gap 1.5ms --period 0.1s \
	--duration 2.2s --snr 30dB --lag 0.2ms:0.5ms --truth twins.tsv >twins.au
duet --stats stats.tsv twins.au >found.tsv
is "twins in white noise are learned once" "$(column_of calibrations <stats.tsv)" 1
for most in 0 1 2; do
	WEARPIPE_LIMITS=pulses=$most duet twins.au >few
	echo $? >status.$most
	column verdict few | sort | uniq -c >few.$most
done
is "what exceeds the limit of pulses is one unresolved row" "$(awk '{ print $1, $2 }' few.1)" "20 unresolved"
is "sections too short to count the particles in them make the record doubtful" \
	"$(cat status.1),$(cat status.2)" 3,0
is "a limit below one is one" "$(cat few.0)" "$(cat few.1)"
is "pulses up to the limit are found" "$(awk '{ print $1, $2 }' few.2)" "40 overlap"
is "both twins of each pair are found" "$(score matched twins.tsv found.tsv)" 40
is "no third twin is found" "$(score false twins.tsv found.tsv)" 0
duet --method count twins.au >counted.tsv
at_most "twins: counted peaks see one of two" "$(column particle counted.tsv | wc -l)" 25

# Pulses with long tails, in a regular train: neither cut short, nor taken for lines, nor
# paired the wrong way round.  The bound at 30 dB: 3.3 sigma / A samples of delay as above.
sensorsim --uniform 90um:110um --number 120 --burst 3 --span 15ms --gap 1ms --period 55ms \
	--start 20ms --snr 30dB --lag 0.2ms:0.5ms --gain 0.909 --pulse lorentz \
	--truth tails.tsv >tails.au
duet -v tails.au >found.tsv 2>log
ok "tails: the shape is learned" grep -q 'pulse lorentz' log
ok "tails: no line is found" grep -q ' 0 lines' log
is "tails: all particles are found" "$(score matched tails.tsv found.tsv)" 120
is "tails: no false particle is found" "$(score false tails.tsv found.tsv)" 0
at_most "tails: the delay errors are at the bound" "$(score delay_ratio tails.tsv found.tsv)" 1.3

# Mains and pump, found and fitted.
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms --mains 0.5,0.3 --pump 0.4,0.2 --truth lines.tsv >lines.au
duet -v lines.au >found.tsv 2>log
ok "lines: four are found" grep -q ' 4 lines' log
is "lines: all particles are found" "$(score matched lines.tsv found.tsv)" 60
is "lines: no false particle is found" "$(score false lines.tsv found.tsv)" 0
at_most "lines: the delays are right to 0.16 samples" "$(score delay_rms lines.tsv found.tsv)" 16e-6

# Masks: isolated pulses come out, with the delay not shrunk to 0.56.
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 50ms --snr 40dB \
	--lag 0.2ms:0.5ms --truth truth.tsv >s.au
duet --method duet --separated sources.au --histogram hist.tsv s.au >masks.tsv
is "masks: all particles are found" "$(score matched truth.tsv masks.tsv)" 60
at_most "masks: the delays of isolated pulses are right to 0.4 samples" "$(score delay_rms truth.tsv masks.tsv)" 40e-6
ok "masks: the histogram is written" sh -c "grep -q ^section hist.tsv"
ok "masks: the separated signals are written" sh -c "test \$(wc -c <sources.au) -gt 1000000"
ok "counting at sensor 1 succeeds" sh -c "duet --method count s.au >c.tsv"
is "counting finds the 60 isolated pulses" "$(column particle c.tsv | wc -l)" 60

# Standard errors: 68 % inside one, give or take 3.5 deviations of 200 draws.
sensorsim --uniform 80um:120um --number 200 --duration 30s --gap 50ms --snr 30dB \
	--lag 0.2ms:0.5ms --truth t.tsv >single.au
duet single.au >f.tsv
for c in time1 time2 delay velocity diameter amplitude; do
	for f in t f; do
		column "$c" $f.tsv >$f.col
	done
	column "${c}_se" f.tsv | paste t.col f.col - | awk -v c="$c" '
	{ n++; inside += ($1 - $2) ^ 2 < $3 ^ 2 }
	END { if (inside / n < 0.565 || inside / n > 0.795) print c, inside / n }'
done >off.txt
is "68 % of the delays are within their standard error" "$(cat off.txt)" ""

# Counted on either sensor: that one has an arrival.
duet --method count --sensor 2 --align 20ms single.au >c.tsv
is "counting at sensor 2 gives no arrival at sensor 1" "$(column time1 c.tsv | sort -u)" nan
column time2 t.tsv >t.col
at_most "peaks at sensor 2 are a quarter of a pulse (2.5 ms) from the arrivals" \
	"$(column time2 c.tsv | paste t.col - | awk '{ d = sqrt(($1 - $2) ^ 2) - 2.5e-3
		d = d < 0 ? -d : d; most = d > most ? d : most } END { print most }')" 1e-3
is "all pulses are counted at sensor 2" "$(column time2 c.tsv | wc -l)" 200

# Of noisier or shorter pulses the masks find more sources than there are: these are marked.
sensorsim --uniform 80um:120um --number 20 --duration 4s --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms --rate 2500Hz --seed 5 --truth truth.tsv >few.au
duet --method duet --window 16 few.au >masks.tsv 2>err
is "masks: doubtful, exit status 3" $? 3
at_least "masks: more sources than particles" "$(column verdict masks.tsv | grep -c misfit)" 3
grep -v misfit masks.tsv >believed.tsv
at_most "masks: false rows are marked misfit" "$(score false truth.tsv believed.tsv)" 1
at_least "masks: true rows are not marked misfit" "$(score matched truth.tsv believed.tsv)" 18
fails "masks: a window too short to see a pulse is refused" 1 "pulses of 25 samples want a --window" \
	duet --method duet --window 8 few.au

# Detection: twenty large particles, and weak ones of one size, half of them within 10 ms,
# a pulse, of a large one.
awk 'BEGIN { print "time\tdiameter"; for (i = 0; i < 300; i++) {
	t = 0.1 + i * 0.06; w = t + (i % 2 ? (i % 40 - 20) / 2000 + 0.0002 : 0.028)
	if (w < t) printf "%g\t2.7e-5\n%g\t1.2e-4\n", w, t
	else printf "%g\t1.2e-4\n%g\t2.7e-5\n", t, w } }' >weak.tsv
sensorsim --duration 18.2s --noise 30mV weak.tsv >weak.au
duet --detectable limits.tsv weak.au >found.tsv
column time1 found.tsv >t.col
column amplitude found.tsv | paste t.col - | awk '$2 < 0.1 { x = ($1 - 0.1) / 0.06; i = int(x + 0.5)
	if (x - i > 0.4) lone++; else beside++ } END { print lone / 150, beside / 150 }' >share
for c in alone beside; do
	column amplitude limits.tsv >a.col
	column $c limits.tsv | paste a.col - | awk -v a=0.019683 '$1 > a { print p + ($2 - p) * log(a / b) / log($1 / b); exit }
		{ b = $1; p = $2 }'
done | paste -s - >told
# Of 150 particles the share scatters by 0.04; see detectable.h for the rest.
near "the share of isolated particles found is the predicted one" "$(cut -d' ' -f1 share)" "$(cut -f1 told)" 0.17
near "the share found beside a large particle is the predicted one" "$(cut -d' ' -f2 share)" "$(cut -f2 told)" 0.22
at_most "a large pulse hides small ones" "$(cut -f2 told)" 0.7
is "the largest pulse is reported" "$(sed -n 's/^# large: \([0-9.]\{3\}\).* V$/\1/p' limits.tsv)" 1.7
fails "no limits of detection without a fit" 2 'detectable requires --method fit' \
	duet --method count --detectable x weak.au

# A live record: rows come before a second of it has, though its end is far away.
awk 'BEGIN { print "time\tdiameter"; for (i = 0; i < 85; i++) printf "%g\t%g\n", 0.05 + 0.08 * i, 8e-5 + i % 7 * 6e-6 }' |
	sensorsim --duration 7s --snr 30dB --lag 0.2ms:0.5ms --truth live-truth.tsv >live.au
for option in --verbose --latency=1s; do
	: >live.tsv
	live 150000 live.au | duet $option >live.tsv 2>err # 0.93 s
	at_least "live, $option: the first rows come within a second of signal" "$(grep -c alone first.tsv)" 1
	is "live, $option: the first rows are those of the whole record" "$(cat first.tsv)" \
		"$(head -n "$(wc -l <first.tsv)" live.tsv)"
	is "live, $option: all particles are found" "$(score matched live-truth.tsv live.tsv)" 85
	is "live, $option: once" "$(grep -c alone live.tsv)" 85
	at_most "live, $option: the delay error is near the bound" "$(score delay_ratio live-truth.tsv live.tsv)" 1.3
done
duet live.au | sed 1d >a
for bytes in 777 70001; do
	(dd bs=$bytes 2>/dev/null; :) <live.au | duet | sed 1d >b
	same "live: blocks of $bytes bytes give the same rows" a b
done

# Particles behind noise from which nothing could be learned.
sensorsim --uniform 80um:120um --number 40 --duration 80s --start 55s --snr 30dB --lag 0:0.4ms \
	--mains 0.3 --truth truth.tsv >late.au
duet late.au >late.tsv 2>err
is "noise that resembles the noise before it: particles behind it are found" \
	"$? $(score matched truth.tsv late.tsv)" "0 40"

# The same where means of eight samples are learned from, 65536 of which last 2.6 s.
sensorsim --rate 200kHz --uniform 80um:120um --number 70 --duration 4s --gap 15ms --snr 30dB --lag 0.2ms:0.5ms \
	--seed 3 >fast.au
: >live.tsv
live 3300000 fast.au | duet --latency 1s >live.tsv 2>err # 1.03 s
at_least "live, means of samples: the first rows come within the latency" "$(grep -c -e alone -e overlap first.tsv)" 1

# A record of noise alone, 3e6 samples: 30 false alarms at 1e-5, and no more by following them;
# Rice's formula is too small by a third at so low a level, and the number has a deviation of 6.
sensorsim --uniform 80um:120um --number 60 --duration 20s --noise 30mV --lag 0:0.4ms --seed 33 >loud.au
sensorsim --uniform 1um:2um --number 0 --duration 300s --noise 30mV --seed 31 >noise.au
duet --false-alarm 1e-5 --instrument alarms-rig.tsv loud.au >loud.tsv
duet --false-alarm 1e-5 --instrument alarms-rig.tsv noise.au >alarms.tsv 2>err
is "false alarms: the record is believed" "$?: $(cat err)" "0: "
near "false alarms are as frequent as said" "$(column time1 alarms.tsv | wc -l)" 40 20

# Work left out.
duet --stats stats.tsv --method duet s.au >/dev/null
at_most "masks: isolated pulses are not demixed" "$(column_of demixings <stats.tsv)" 2

# Too dense: said so, and the sum of squares is right (1000 per second, A = 1: 1000 V2/s).
sensorsim --uniform 100um:100um --number 2000 --duration 2s --snr 30dB --truth t.tsv >dense.au
duet --sections sections.tsv dense.au >dense.tsv
is "no particle is invented in a dense record" "$(column verdict dense.tsv | sort -u)" unresolved
near "dense: the sum of squares is right within 15 %" "$(awk -F '\t' '/^#/ { next }
	!n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
	{ t = $c["end"] - $c["begin"]; s += t * $c["square"]; all += t }
	END { print s / all }' sections.tsv)" 1000 150

# Stretches too short to be counted: whatever Campbell's theorem gives by chance, what the
# rows say is in them is no more than there is.
sensorsim --uniform 40um:180um --number 800 --duration 4s --snr 40dB --pulse lorentz \
	--lag 0:0.4ms --seed 405 --truth truth.tsv >tails.au
duet --sections sections.tsv --detectable limits.tsv tails.au >found.tsv 2>err
is "short dense stretches: doubtful" $? 3
is "all tables say so" "$(grep -c '^# doubtful' sections.tsv limits.tsv found.tsv | tr '\n' ' ')" \
	"sections.tsv:1 limits.tsv:1 found.tsv:1 "
awk -F '\t' '/^#/ { next } $1 == "section" || $1 == "particle" && $2 == "time1" { file++; for (i = 1; i <= NF; i++) c[$i] = i; next }
	file == 1 && $c["verdict"] == "unresolved" { from[$c["section"]] = $c["begin"]; to[$c["section"]] = $c["end"] }
	file == 2 { if ($c["kind"] == "particle") { time[n] = $c["time1"]; d[n] = $c["diameter"]; a[n++] = $c["amplitude"] } }
	file == 3 && $c["verdict"] == "unresolved" { k = $c["section"]; sources = volume = sixth = 0; rows++
		for (i = 0; i < n; i++) if (time[i] >= from[k] && time[i] < to[k]) { sources++; volume += a[i] }
		half = sqrt(3) * $c["time1_se"]
		for (i = 0; i < n; i++) if (time[i] > $c["time1"] - half && time[i] < $c["time1"] + half) sixth += d[i] ^ 6
		within += $c["diameter_most"] >= sixth ^ (1 / 6); factor += log($c["diameter_most"] / sixth ^ (1 / 6))
		more += $c["sources"] > sources || ($c["amplitude"] != "nan" && $c["sources"] * $c["amplitude"] > volume) }
	END { print (rows > 10), more + 0; print rows - within, exp(factor / rows) }' sections.tsv truth.tsv found.tsv >more
is "short dense stretches: number and volume are lower bounds" "$(sed -n 1p more)" "1 0"
is "short dense stretches: diameter_most bounds what is in them" "$(sed -n '2s/ .*//p' more)" 0
at_most "short dense stretches: by no more than half of the diameter" "$(sed -n '2s/.* //p' more)" 1.5

# Filtered records.  "filter" in the header is how bpfilter tells what a record has passed.
passed() {
	head -c 4096 "$1" | strings | sed -n 's/^filter //p'
}
# bare FILE: two channels of doubles at 10 kHz with an empty header
bare() {
	header=$(od -An -tu1 -j4 -N4 "$1" | awk '{ print (($1 * 256 + $2) * 256 + $3) * 256 + $4 }')
	printf '.snd\0\0\0\030\377\377\377\377\0\0\0\007\0\0\047\020\0\0\0\002'
	tail -c "+$((header + 1))" "$1"
}
rows() {
	grep -v '^#' "$1"
}
sensorsim --uniform 80um:120um --number 100 --start 1s --span 14s --duration 16s --gap 20ms \
	--snr 30dB --lag 0.2ms:0.5ms --gain 0.909 --truth truth.tsv >raw.au
bpfilter --zero-phase raw.au >narrow.au
bpfilter -b 20:1000 --order 1000 --zero-phase raw.au >wide.au
bpfilter -b 0:2000 --window kaiser raw.au | bpfilter -b 30:1000 --order 600 >chain.au
is "the header of a filtered record states the filter" "$(passed narrow.au)" "70:130 200 hamming 0 scaled"
is "the header of a record filtered twice states both filters" "$(passed chain.au)" \
	"0:2000 200 kaiser 5.6532600000000004 scaled | 30:1000 600 hamming 0 scaled"
duet --method duet --separated separated.au wide.au >/dev/null
is "the header of separated signals states no filter" "$(passed separated.au)" ""

# The bound is that of white noise: undoing the filter must cost next to nothing.  The ratio
# of 100 errors to it scatters by 1 / sqrt 200, so 1.25 is 3.5 deviations (measured 0.93 to
# 1.03).  All sizes share the error of the duration learned from 16 pulses: at most 0.07 %
# on six records, raw or filtered.
undone() { # NAME FOUND
	is "$1: all particles are found" "$(score matched truth.tsv "$2")" 100
	is "$1: no false particle is found" "$(score false truth.tsv "$2")" 0
	at_most "$1: the delay error is near the bound" "$(score delay_ratio truth.tsv "$2")" 1.25
	near "$1: the sizes are unbiased" "$(score size_bias truth.tsv "$2")" 0 0.002
}
duet --stats stats.tsv narrow.au >narrow.tsv
undone "70:130 undone" narrow.tsv
is "70:130 undone: nothing is guessed" "$(column_of calibrations <stats.tsv)" 1
duet wide.au >wide.tsv
undone "20:1000 undone" wide.tsv
duet chain.au >chain.tsv
# The delay of both filters, 100 and 300 samples, is that of either channel.
awk -F '\t' -v OFS='\t' 'NR > 3 && $1 != "particle" { $2 -= 0.04; $3 -= 0.04 } 1' chain.tsv >early.tsv
undone "two filters undone" early.tsv

bare narrow.au >bare.au
is "duet copies no filter from a record without header" "$(passed bare.au)" ""
bpfilter --taps >taps.tsv
duet --undo taps.tsv bare.au >found.tsv
rows narrow.tsv >a
rows found.tsv >b
same "the taps of a table are those of the header" a b
bpfilter --taps -b 20:1000 --order 1000 >taps.tsv
bare wide.au | duet --undo taps.tsv >found.tsv
rows wide.tsv >a
rows found.tsv >b
same "a table of 1001 taps gives the rows of the header" a b
(dd bs=777 2>/dev/null; :) <wide.au | duet >found.tsv
rows found.tsv >b
same "20:1000 undone: a pipe of 777-byte blocks gives the same rows" a b
sensorsim --uniform 50um:150um --number 120 --duration 1s --snr 30dB --lag 0.2ms:0.5ms |
	bpfilter --zero-phase >passed.au
duet passed.au | sed 1d >a
(dd bs=5003 2>/dev/null; :) <passed.au | duet | sed 1d >b
same "70:130 undone: the same where sections are cut into windows" a b

# Coloured noise: the bound of white noise of the same power does not hold, the standard
# errors do (68 % within one; of 60 that scatters by 6 %).
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms --gain 0.909 --corner 1kHz --truth truth.tsv >coloured.au
duet coloured.au >found.tsv
is "coloured noise: all particles are found" "$(score matched truth.tsv found.tsv)" 60
is "coloured noise: no false particle is found" "$(score false truth.tsv found.tsv)" 0
at_most "coloured noise: the delay error is near the bound" "$(score delay_ratio truth.tsv found.tsv)" 1.3
at_least "coloured noise: standard errors" "$(score delay_cover truth.tsv found.tsv)" 0.5
near "coloured noise: the sizes are unbiased" "$(score size_bias truth.tsv found.tsv)" 0 0.003

# What the header or the table of taps should not say.  All frequencies pass 0:5000.
bpfilter -b 0:5000 --order 2 twins.au | sed -e 's/wearpipe-streams(5)/anything-streams(5)/' -e 's/^\(filter .*\) hamming/\1 unknown/' >odd.au
is "the header keeps an unknown filter" "$(passed odd.au)" "0:5000 2 unknown 0 scaled"
duet odd.au >found.tsv 2>warning
is "an unknown filter gives one warning" "$(wc -l <warning)" 1
ok "the warning names the unknown filter" grep -q "not known: '0:5000 2 unknown" warning
rows found.tsv >a
bare odd.au | duet | grep -v '^#' >b
same "a record with an unknown filter is treated as one without header" a b
taps() { # TAP...
	{ echo tap; printf '%s\n' "$@"; } >odd.tsv
}
taps 1 2 3
fails "asymmetric taps" 1 'odd.tsv: tap 1 is not equal.*linear phase' duet --undo odd.tsv twins.au
taps 1 nan 1
fails "a tap that is no number" 1 'odd.tsv: line 3: tap is not' duet --undo odd.tsv twins.au
taps 0 0 0
fails "taps that are all 0" 1 'odd.tsv: the largest tap is 0' duet --undo odd.tsv twins.au
echo tap >odd.tsv
fails "no taps" 1 'odd.tsv: no taps' duet --undo odd.tsv twins.au
printf 'gain\n1\n' >odd.tsv
fails "a table without taps" 1 "odd.tsv: no column 'tap'" duet --undo odd.tsv twins.au
fails "a missing table of taps" 1 'none.tsv' duet --undo none.tsv twins.au

# Silence and bad input.
sensorsim --uniform 80um:120um --number 0 --duration 10s --noise 1V >noise.au
duet --align 19.6ms --pulse-duration 10ms noise.au >none.tsv
is "noise has no particle" "$(grep -vc '^#' none.tsv)" 1
duet noise.au >none.tsv 2>warning
is "noise: nothing to learn from, no particle" "$(column particle none.tsv | wc -l)" 0
ok "a record without common pulses is reported" grep -q 'nothing in common' warning
# The sensor of channel 2 is dead but for its noise.
columns() { # COLUMNS of a record of N particles
	sensorsim --uniform 60um:180um --number "$2" --duration 10s --noise 3mV --seed 5 |
		sigconvert -o text | grep -v '^#' | cut -f "$1"
}
columns 1,2 30 >first.txt
columns 3 0 | paste first.txt - | sigconvert --from text >dead.au
fails "pulses on one channel alone" 3 'a channel stands out of its noise' duet dead.au
head -c 32000 s.au >cut.au
fails "a record cut inside a frame" 1 'cut' duet "$work/cut.au"
fails "empty input" 1 . duet /dev/null
fails "too little to learn from" 1 "10 samples at 10000 Hz, want at least 64" duet --learn 1ms s.au
bpfilter -b 95:105 --order 800 s.au >tight.au
fails "a filter that leaves too little of the pulses" 1 "too narrow a band" duet tight.au
fails "a lag as long as the record" 1 "align is as long as what is learned from" duet --align 10s s.au
fails "an unknown method" 2 'method' duet --method best s.au
fails "odd window" 2 'even' duet --method duet --window 63 s.au
fails "window without duet" 2 'require --method duet' duet --window 64 s.au

# The instrument is kept: a second run learns nothing, and its rows come at once.
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 20ms --snr 30dB --lag 0.2ms:0.5ms \
	--gain 0.909 --mains 0.2 --seed 4 >rig.au
ok "an instrument is learned and kept" duet --instrument rig.tsv rig.au
grep -v '^#' out >first
ok "a kept instrument is used" duet --instrument rig.tsv --stats stats.tsv rig.au
echo mine >common.tsv.new
for i in 1 2 3; do duet --instrument common.tsv rig.au >common$i.tsv 2>err$i & done
wait
is "programs that learn one instrument at once all finish" "$(tail -qn 1 common?.tsv | grep -c '^# end') $(cat err?)" "3 "
is "a file beside that of the instrument is left alone" "$(cat common.tsv.new; ls common.tsv.*)" "mine
common.tsv.new"
grep -v '^#' out >second
same "the rows of a kept instrument are those of the learned one" first second
is "with a kept instrument nothing is learned" "$(column_of calibrations <stats.tsv)" 0
(head -c 320000 rig.au; i=0; until grep -q alone live || [ $i -ge 300 ]; do
	sleep 0.1; i=$((i + 1)); done; echo $i >waited) | duet --instrument rig.tsv >live 2>err || :
at_most "rows come 2 s into a live record, of which 6.6 s are learned from" "$(cat waited)" 299
rm -f passed.tsv
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 20ms --snr 30dB --lag 0.2ms:0.5ms |
	bpfilter --band 20:1000 --order 400 --zero-phase >passed.au
duet --instrument passed.tsv passed.au | grep -v '^#' >first
duet --instrument passed.tsv passed.au | grep -v '^#' >second
same "a filtered record and a kept instrument give the same rows" first second
at_least "a kept instrument finds the particles of a filtered record" "$(column verdict second | grep -c alone)" 59

refuses() {
	fails "an instrument $1 is refused" 1 "$2" duet --instrument "$work/$3" ${4:-} rig.au
}
{ sed 40q rig.tsv && printf %.9s "$(sed -n 41p rig.tsv)"; } >torn.tsv
head -n 900 rig.tsv >short.tsv
sed '/^gain/s/0[.]9/0.8/' rig.tsv >edited.tsv
grep -v '^# end' rig.tsv | grep -v '^# stream' >plain.tsv
refuses "cut inside a row" 'truncated' torn.tsv
refuses "cut between rows" 'did not finish' short.tsv
refuses "with another number" 'damaged' edited.tsv
refuses "without an end mark" 'no end mark' plain.tsv
refuses "of other sensors" 'sensors 0.25 m apart' rig.tsv '--spacing 20cm'
refuses "learned with other options" 'other options' rig.tsv '--gain 1'
fails "a table of something else is no instrument" 1 "no key 'instrument'" \
	duet --instrument "$work/truth.tsv" rig.au
head -c 50000 rig.au >torn.au
fails "an instrument that cannot be written, before the record is found torn" 1 '^duet: missing/rig.tsv: No such file' \
	duet --instrument missing/rig.tsv torn.au
sensorsim --uniform 80um:120um --number 9 --duration 2s --rate 5kHz --noise 30mV >slow.au
fails "an instrument of another rate is refused" 1 'learned at 10000 Hz, the record has 5000 Hz' \
	duet --instrument rig.tsv slow.au
fails "an instrument is for the fit" 2 'requires --method fit' duet --method count --instrument rig.tsv rig.au

# What has changed since is noticed: gain, form, polarity, lines, noise of either channel; the flow is
# followed.
cp rig.tsv before.tsv
for change in "--gain 1.2" "--gain 0.909 --zone 90mm" \
	"--gain 0.909 --phase 180deg" "--gain 0.909 --mains 1,0.4" "--gain 0.909 --noise 40mV" \
	"--gain 0.909 --noise 24mV"; do
	sensorsim --uniform 80um:120um --number 40 --duration 7s --gap 20ms --noise 31.6mV \
		--lag 0.2ms:0.5ms --mains 0.2 $change --seed 6 >changed.au
	duet --instrument rig.tsv changed.au >found.tsv 2>err
	echo "$? $(grep -c 'instrument does not fit' err) $(grep -c '^# doubtful' found.tsv) $change"
done >noticed
is "a record of another instrument is doubtful, whatever has changed" "$(grep -vc '^3 1 1' noticed)" 0
same "a doubtful record does not change the file of the instrument" before.tsv rig.tsv
sensorsim --uniform 80um:120um --number 40 --duration 7s --gap 20ms --noise 31.6mV \
	--lag 0.2ms:0.5ms --mains 0.2 --gain 0.909 --flow 63L/min --seed 6 --truth faster.tsv >changed.au
ok "a kept instrument reads a record of another flow" duet --instrument rig.tsv changed.au
grep -v '^# doubtful' out >found.tsv
is "a kept instrument follows the flow: particles" "$(score matched faster.tsv found.tsv)" 40
is "a kept instrument follows the flow: no false particle is found" "$(score false faster.tsv found.tsv)" 0
at_most "a kept instrument follows the flow: the delay error is near the bound" \
	"$(score delay_ratio faster.tsv found.tsv)" 1.3
cp before.tsv rig.tsv
sensorsim --uniform 80um:120um --number 0 --duration 7s --noise 31.6mV --mains 0.2 >quiet.au
ok "a record without particles is not another instrument" duet --instrument rig.tsv quiet.au
is "a record without particles has no rows" "$(grep -vc '^#' out)" 1
sensorsim --uniform 80um:120um --number 60 --duration 7s --shocks 3Hz --snr 30dB --lag 0.2ms:0.5ms >shocks.au
rm -f shocks.tsv
duet --instrument shocks.tsv shocks.au >found.tsv 2>err
is "a doubtful instrument is not kept" "$(ls shocks.tsv 2>/dev/null) $(grep -c 'not written' err)" " 1"

# Pulses of thousands of samples are found in means of samples: the same errors, the same rows whatever
# the pipe, a kept instrument, and the phases of four channels.
sensorsim --uniform 80um:120um --number 30 --duration 4s --rate 400kHz --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms --truth fast-truth.tsv >fast.au
duet --instrument fast-rig.tsv --stats stats.tsv --sections sections.tsv fast.au >fast.tsv
is "all pulses of 4000 samples are found" "$(score matched fast-truth.tsv fast.tsv)" 30
is "pulses of 4000 samples: no false particle is found" "$(score false fast-truth.tsv fast.tsv)" 0
at_most "pulses of 4000 samples: the delay error is near the bound" \
	"$(score delay_ratio fast-truth.tsv fast.tsv)" 1.3
is "work is counted in samples of the record" "$(column_of samples <stats.tsv)" 1600000
duet --instrument fast-rig.tsv fast.au >kept.tsv
grep -v '^#' fast.tsv >a
grep -v '^#' kept.tsv >b
same "a kept instrument reads means as well" a b
# The polarity and the crosstalk of a kept instrument hold from the first sample on, whatever part
# of a mean has come.
sensorsim --uniform 80um:120um --number 30 --duration 3s --rate 100kHz --gap 20ms --snr 30dB \
	--lag 0.2ms:0.5ms | sigconvert -o text |
	awk -F '\t' -v OFS='\t' '/^#/ { next } /^[0-9]/ { $3 = -$3 - 0.05 * $2 } 1' |
	sigconvert --from text >opposite.au
duet --instrument opposite-means.tsv opposite.au 2>/dev/null | grep -v '^#' >a
duet --instrument opposite-means.tsv opposite.au 2>/dev/null | grep -v '^#' >b
at_least "opposite sensors with crosstalk are read in means" "$(wc -l <a)" 31
same "a kept instrument has polarity and crosstalk in means as well" a b
(dd bs=5003 2>/dev/null; :) <fast.au | duet | grep -v '^#' >b
grep -v '^#' fast.tsv >a
same "blocks of 5003 bytes give the same rows" a b
column begin sections.tsv >a
column end sections.tsv | paste a - >ranges
column time1 fast.tsv >a
column section fast.tsv | paste a - >b
awk 'NR == FNR { from[NR] = $1; to[NR] = $2; next } $1 < from[$2] || $1 > to[$2]' ranges b >outside
is "sections enclose the arrivals of their particles" "$(wc -l <b) $(wc -l <outside)" "30 0"

# Oil that flows backwards, or sensors the wrong way round.
sigconvert -o text rig.au >rig.txt
sigconvert --from text --columns 'channel2;channel1' rig.txt >swapped.au
fails "swapped sensors are named" 1 'pulses reach channel 2 first' duet swapped.au
# Among small particles, sizes by a power law, any two look like one if any delay may be.
awk 'BEGIN { print "# units: m\ndiameter"; for (i = 1; i <= 250; i++) {
	u = i * 0.6180339887; u -= int(u); printf "%.6g\n", 20e-6 * (1 - u * (1 - (1 / 15) ^ 3)) ^ (-1 / 3) } }' >sizes.tsv
for seed in 5 8; do
	sensorsim -s $seed --duration 10s --rate 20kHz --snr 30dB --pulse gauss --spacing 375mm \
		--lag 0.25ms:0.25ms sizes.tsv | sigconvert -o text >small.txt
	sigconvert --from text --columns 'channel2;channel1' small.txt >swapped.au
	fails "swapped sensors are named among small particles, seed $seed" 1 \
		'pulses reach channel 2 first' duet swapped.au
done

# The leads of one coil exchanged.
awk -F '\t' -v OFS='\t' '/^#/ { next } NR > 6 && !sub(/^-/, "", $3) { $3 = "-" $3 } 1' rig.txt |
	sigconvert --from text >opposite.au
duet rig.au >plain.tsv
rows plain.tsv >a
duet --instrument opposite-rig.tsv opposite.au 2>said >b.tsv
rows b.tsv >b
same "a sensor of opposite polarity gives the same rows" a b
is "its polarity is said" "$(grep -c 'channel 2 have the sign opposite to those of channel 1' said)" 1
duet --instrument rig.tsv rig.au >plain.tsv
rows plain.tsv >a
duet --instrument opposite-rig.tsv opposite.au >b.tsv 2>said
rows b.tsv >b
same "a kept instrument has the polarity" a b
duet --align 20ms rig.au >plain.tsv
rows plain.tsv >a
duet --align 20ms opposite.au >b.tsv 2>said
rows b.tsv >b
same "it is found at a given lag, too" a b
# Each channel records a share of the other one; errors of the shares are 0.001.
sensorsim --uniform 80um:120um --number 60 --duration 9s --gap 35ms --snr 30dB --lag 0.2ms:0.5ms --seed 4 >pure.au
sigconvert -o text pure.au |
	awk -F '\t' -v OFS='\t' '/^#/ { next } /^[0-9]/ { x = $2; $2 = x - 0.02 * $3; $3 += 0.05 * x } 1' |
	sigconvert --from text >mixed.au
duet pure.au >plain.tsv
duet -v --instrument mixed-rig.tsv mixed.au 2>said >mixed.tsv
is "with crosstalk as many particles are found" "$(column time1 mixed.tsv | wc -l)" "$(column time1 plain.tsv | wc -l)"
near "the share of channel 2 on channel 1 is found" "$(sed -n 's/.*crosstalk \([^ ]*\) and.*/\1/p' said)" -0.02 0.005
near "and that of channel 1 on channel 2" "$(sed -n 's/.*crosstalk [^ ]* and \([^ ,]*\),.*/\1/p' said)" 0.05 0.005
rows mixed.tsv >a
duet --instrument mixed-rig.tsv mixed.au >again.tsv
rows again.tsv >b
same "a kept instrument has the crosstalk" a b
# 5 cm are 39.27 samples at this velocity.  With the duration of 39 samples all velocities
# would be out by nine standard errors; what is learned of the gain alone is some tenths.
sensorsim --uniform 100um:100um --number 200 --burst 1 --span 1ms --period 100ms --spacing 5cm \
	--snr 40dB --seed 106 --truth truth.tsv |
	duet --gain 1 --spacing 5cm --pulse sine --pulse-duration 10ms >found.tsv
column velocity truth.tsv >a
column velocity found.tsv | paste a - >b
column velocity_se found.tsv | paste b - >c
near "a given duration is that of the mean particle, between two samples" \
	"$(awk '{ sum += ($2 - $1) / $3 } END { print sum / NR }' c)" 0 0.7
done_testing

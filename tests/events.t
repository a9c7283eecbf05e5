#!/bin/sh
# duet names events that are no particles, and what reads its table leaves them out
. "$(dirname "$0")/tap.sh"

at_least() {
	ok "$1 ($2)" test "$2" -ge "$3"
}
scene="--uniform 80um:120um --number 40 --duration 20s --snr 30dB --lag 0:0.3ms"
half="--uniform 80um:120um --number 20 --duration 10s --snr 30dB --lag 0:0.3ms"
# verdicts TABLE WORD: how many rows have it
verdicts() { column verdict "$1" | grep -c "^$2$"; }
# at_event TABLE WORD: rows with this verdict less than 40 ms behind the beginning of such an event
# at either sensor, or 15 ms from the middle of a bubble
at_event() {
	grep -hv '^#' truth.tsv "$1" | awk -F '\t' -v word="$2" '
		$1 == "particle" { file++; for (i = 1; i <= NF; i++) c[$i] = i; next }
		file == 1 { if ($c["kind"] == word) { for (i = 1; i <= 2; i++) t[n++] = $c["time" i] } next }
		$c["verdict"] == word { hit = 0
			for (i = 0; i < n; i++)
				for (k = 1; k <= 2; k++) { x = $c["time" k]; if (x != "nan" && x > t[i] - 0.015 && x < t[i] + 0.04) hit = 1 }
			sum += hit }
		END { print sum + 0 }'
}

for kind in bubble shock impulse; do
	# shellcheck disable=SC2086 # options are words
	sensorsim $scene --"${kind}s" 0.7 --seed 3 --truth truth.tsv >s.au
	duet s.au >found.tsv 2>err
	status=$?
	case $kind in
	impulse) is "impulses: the record is believed" "$status: $(cat err)" "0: " ;;
	*)
		is "${kind}s: hide particles, so that the record is doubtful" "$status" 3
		like "${kind}s: a message states the share of the record" "$(cat err)" \
			'^duet: s.au: events that are no particles cover [0-9.]* % of it, and hide'
		;;
	esac
	n=$(column kind truth.tsv | grep -c "^$kind$")
	named=$(verdicts found.tsv "$kind")
	at_least "${kind}s: two of three are named" "$named" $((2 * n / 3))
	is "${kind}s: all rows named so are" "$(at_event found.tsv "$kind")" "$named"
	is "${kind}s: no other event is named" \
		"$(column verdict found.tsv | grep -c -e shock -e bubble -e impulse -e transient)" "$named"
	is "${kind}s: have no size" "$(awk -F '\t' -v kind="$kind" '$17 == kind && $4 != "nan"' found.tsv | wc -l)" 0
	like "${kind}s: are counted at the end of the table" "$(tail -n 3 found.tsv)" \
		"# events: .*$named ${kind}s"
	at_least "${kind}s: particles beside them are found" "$(($(verdicts found.tsv alone) + $(verdicts found.tsv overlap)))" 36
done

# Samples at the limit of the converter, and those of a sensor that stands still, the first of
# which is measured.
sensorsim --uniform 90um:120um --number 40 --duration 10s --snr 30dB --seed 6 >s.au
sigconvert -o text s.au | grep -v '^#' | awk -F '\t' -v OFS='\t' '
	/^[0-9]/ { if ($2 > 1) { $2 = 1; high++ } if ($1 > 6) { $3 = last; still++ } last = $3 }
	{ print } END { print high, still >"counted" }' | sigconvert --from text >missing.au
duet missing.au >found.tsv 2>err
is "a limit and a sensor that stands still: the record is believed" $? 0
is "a limit and a sensor that stands still: nearly all particles are found" \
	"$(($(verdicts found.tsv alone) + $(verdicts found.tsv overlap) > 37))" 1
like "a limit and a sensor that stands still: the samples are counted and reported" "$(cat err)" \
	"^duet: missing.au: $(awk '{ print $1 " samples of sensor 1 and " $2 + 1 }' counted) of sensor 2 were not measured"
is "a limit and a sensor that stands still: the table says the same" \
	"$(sed -n 's/^# missing: //p' found.tsv)" "$(sed 's/^duet: missing.au: //' err)"

# All that is measured of a particle ten times as large as the limit is where it changes its
# sign, which is one lobe.
sensorsim --rate 16kHz --uniform 60um:150um --number 80 --duration 14s --snr 36dB --lag 0:0.4ms \
	--seed 209 >s.au
sigconvert -o text s.au | grep -v '^#' | awk -F '\t' -v OFS='\t' '/^[0-9]/ { for (i = 2; i <= 3; i++)
	$i = $i > 0.3 ? 0.3 : $i < -0.3 ? -0.3 : $i } { print }' | sigconvert --from text >limits.au
duet limits.au >found.tsv 2>err
is "no particle beyond both limits of the converter is a bubble" "$(verdicts found.tsv bubble)" 0
is "all particles beyond both limits are found" \
	"$(($(verdicts found.tsv alone) + $(verdicts found.tsv overlap)))" 80

# Nothing can be learned from shocks alone; the particles behind them are found.
sensorsim --uniform 80um:150um --number 0 --shocks 3 --duration 9s --noise 20mV --seed 4 >shocks.au
sensorsim --uniform 80um:150um --number 60 --duration 20s --noise 20mV --seed 5 >behind.au
for s in shocks behind; do sigconvert -o raw $s.au; done |
	sigconvert --from raw --channels 2 --rate 10kHz >s.au
duet s.au >found.tsv 2>err
is "nothing learned at first: the record is doubtful" $? 3
like "nothing learned at first: a message states the time" "$(cat err)" \
	'^duet: s.au: nothing could be learned from its first [0-9.]* s, in which a channel'
is "nothing learned at first: particles behind it are found" \
	$(($(verdicts found.tsv alone) + $(verdicts found.tsv overlap))) 60
duet behind.au >found.tsv 2>err
is "nothing passed over: the record is believed" "$?: $(cat err)" "0: "

# The last of a record is learned from, too, if it has half as many samples: an amplifier
# that settles for a second hides what the sensors have in common.
sensorsim --uniform 80um:120um --number 50 --duration 7s --gap 30ms --snr 30dB --lag 0.2ms:0.5ms --seed 6 |
	sigconvert -o text - | grep -v '^#' | awk -F '\t' -v OFS='\t' '/^[0-9]/ { for (i = 2; i <= 3; i++)
	$i += (5 - i) * exp(-$1 / 0.3) } { print }' | sigconvert --from text >settles.au
duet settles.au >found.tsv 2>err
is "a record that settles is doubtful" $? 3
like "a record that settles: a message states the time" "$(cat err)" '^duet: settles.au: nothing could be learned from its first'
at_least "a record that settles: particles behind it are found" "$(verdicts found.tsv alone)" 15
is "a record that settles: no others are claimed" "$(verdicts found.tsv overlap)" 0

# shellcheck disable=SC2086
sensorsim $half --bubbles 0.5 --shocks 0.5 --transients 0.2 --seed 5 --truth truth.tsv >s.au
duet s.au >found.tsv 2>err
for kind in bubble shock transient; do
	at_least "$kind among others: named" "$(verdicts found.tsv $kind)" 1
	is "$kind among others: rightly" "$(at_event found.tsv $kind)" "$(verdicts found.tsv $kind)"
done
awk -F '\t' '!/^#/ && $17 != "shock" && $17 != "bubble" && $17 != "impulse" && $17 != "transient"' found.tsv >bare.tsv
for way in '' --doubtful; do
	# shellcheck disable=SC2086
	is "wear-volume $way leaves them out" "$(wear-volume $way found.tsv 2>err | tail -n +4 | grep -v '^#')" \
		"$(wear-volume $way bare.tsv 2>err | tail -n +4 | grep -v '^#')"
	# shellcheck disable=SC2086
	is "debriscount $way leaves them out" "$(debriscount $way --duration 10s found.tsv 2>err | grep -v '^#')" \
		"$(debriscount $way --duration 10s bare.tsv 2>err | grep -v '^#')"
done
is "rwl leaves them out" "$(rwl --observe debris found.tsv 2>err | grep -v '^#')" \
	"$(rwl --observe debris bare.tsv 2>err | grep -v '^#')"

# shellcheck disable=SC2086
sensorsim $half --transients 1 --seed 5 >s.au
duet s.au >found.tsv 2>err
like "a transient is one of the rows that may fit no particle" "$(cat err)" \
	"^duet: s.au: [0-9]* of $(column verdict found.tsv | wc -l) rows fit no particle"
# shellcheck disable=SC2086
sensorsim $half --bubbles 0.5 --transients 2 --seed 4 >s.au
duet s.au >found.tsv 2>err
n=$(column verdict found.tsv | grep -vc bubble)
like "a bubble is none of those rows, also where all are doubted" "$(cat err)" \
	"^duet: s.au: $n of $n rows fit no particle"
at_least "bubbles in that record" "$(verdicts found.tsv bubble)" 1

# shellcheck disable=SC2086
sensorsim $scene --seed 4 >s.au
duet s.au >found.tsv
is "no event is named in a record of particles" \
	"$(grep -c -e shock -e bubble -e impulse -e transient -e '# events' found.tsv)" 0
done_testing

#!/bin/sh
# aopf as a monitor: saved states, units side by side, alarms, events, costs, JSON
. "$(dirname "$0")/tap.sh"

# wear LIFE ROWS SEED: straight wear with noise of 1 % of the way to 1
wear() {
	awk -v life="$1" -v rows="$2" -v seed="$3" 'BEGIN { srand(seed); for (t = 0; t < rows; t++) {
		z = 0
		for (k = 0; k < 12; k++) z += rand()
		printf "%d\t%.6f\n", t, t / life + 0.01 * (z - 6) } }'
}

# Three units that alternate.
{
	printf 'unit\tt\ty\n'
	for u in 1 2 3; do wear $((60 + 40 * u)) 80 "$u" | sed "s/^/u$u	/"; done | sort -s -n -k 2
} >three.tsv
head -1 three.tsv >header
rows() { grep -v '^#' "$1" | grep -v '^unit'; }
for how in '' '--lives-only --mission 20 --cost-ratio 5 --weights'; do
	# shellcheck disable=SC2086 # words
	run() { aopf --unit unit --threshold 1 --direction up $how "$@"; }
	run three.tsv >whole
	rows whole >whole.rows
	head -122 three.tsv | run --save state >first
	{ cat header; tail -n +123 three.tsv; } | run --resume state --save state >second
	{ rows first; rows second; } >parts
	same "stopping and resuming does not change the output (${how:-with the filter})" parts whole.rows
	run --resume state three.tsv | rows - >again
	is "rows that were processed before are skipped (${how:-with the filter})" "$(wc -l <again | tr -d ' ')" 0
	run --threads 3 three.tsv >side
	same "threads do not change the output (${how:-with the filter})" side whole
done
# A row that is refused loses none of those before it.
awk -F '\t' -v OFS='\t' 'NR == 150 { $2 = 1 } { print }' three.tsv >refused.tsv
for n in 1 3; do
	aopf --unit unit --threshold 1 --direction up --lives-only --save kept$n --threads $n refused.tsv 2>err$n >rows$n
done
is "the rows before one that is refused are written" "$(rows rows1 | wc -l | tr -d ' ')" 148
same "threads do not change them" rows3 rows1
same "nor what is said" err3 err1
aopf --unit unit --threshold 1 --direction up --lives-only --resume kept3 three.tsv | rows - >rest
is "nor the state" "$(wc -l <rest | tr -d ' ')" 92
fails "a state on standard output" 2 '-: an output requires a file name' aopf --save - three.tsv
cp three.tsv kept.tsv
fails "a state in the file that is read" 2 'the same file is read and written' aopf --save kept.tsv kept.tsv
same "the file is kept" three.tsv kept.tsv
fails "a state of other options" 1 "state: saved with other options" \
	aopf --unit unit --threshold 1 --direction up --resume state three.tsv
# doubtful NAME WANT COMMAND...: the command writes its result, warns once and returns 3
doubtful() {
	name=$1 want=$2
	shift 2
	"$@" >doubtful.out 2>doubtful.err
	is "$name: status" $? 3
	is "$name: warning" "$(cat doubtful.err)" "aopf: $want"
}
by_unit() { aopf --unit unit --threshold 1 --direction up "$@"; }
sed 's/^u\([123]\)/v\1/' three.tsv >others.tsv
doubtful "a state of other units" "the series has no unit of the saved state, whose first is 'u1'" \
	by_unit --lives-only --mission 20 --cost-ratio 5 --weights --resume state others.tsv
awk -F '\t' -v OFS='\t' '$1 == "u2" && $2 == 79 { $3 = 0.5 } { print }' three.tsv >changed.tsv
fails "a state of another series" 1 "changed.tsv: line 240: u2: y is 0.5, but was .* another series" \
	by_unit --lives-only --mission 20 --cost-ratio 5 --weights --resume state changed.tsv
fails "a table instead of a state" 1 "no state saved by aopf" \
	aopf --unit unit --threshold 1 --resume three.tsv three.tsv

# A fleet file may change while its name does not.
{ printf 'unit\tt\ty\n'; wear 90 92 4 | sed 's/^/old	/'; } >fleet.tsv
shared() { aopf --unit unit --threshold 1 --direction up --lives-only --fleet fleet.tsv "$@"; }
shared --save shared.state three.tsv >/dev/null
ok "a state is resumed with the same fleet" shared --resume shared.state three.tsv
sed '$s/\t[^\t]*$/\t1.3/' fleet.tsv >other.tsv
mv other.tsv fleet.tsv
fails "a state of another fleet" 1 "shared.state: saved with another fleet" \
	shared --resume shared.state three.tsv
cp state torn
printf 'xxxx' | dd of=torn bs=1 seek=3000 conv=notrunc 2>/dev/null
ok "a truncated state leaves the previous one" \
	aopf --unit unit --threshold 1 --direction up --lives-only --mission 20 --cost-ratio 5 --weights --resume torn --stats torn.stats three.tsv
is "the previous state has all units" "$(column units_resumed torn.stats)" 3

# Killed between two rows.
wear 100 70 7 | sed '1i t	y' >one.tsv
aopf --threshold 1 --direction up --lives-only one.tsv | grep '^[0-9]' >whole
mkfifo in
aopf --threshold 1 --direction up --lives-only --save killed in >before &
p=$!
exec 3>in
head -41 one.tsv >&3
for _ in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do
	[ "$(grep -c '^[0-9]' before)" = 40 ] && break
	sleep 0.1
done
sleep 0.1
kill -KILL $p
exec 3>&-
wait $p 2>/dev/null
aopf --threshold 1 --direction up --lives-only --resume killed one.tsv >after
{ grep '^[0-9]' before; grep '^[0-9]' after; } >both
same "killing the program between two rows does not change the output" both whole

# A state of which the end is lost, and one that is damaged in the middle: the units before go on.
awk 'BEGIN { print "unit\tt\ty"; for (t = 0; t < 9; t++) for (u = 0; u < 3; u++) print u "\t" t "\t" t / 20 }' >trio.tsv
monitor='aopf --threshold 1 --direction up --unit unit --lives-only'
$monitor --save trio trio.tsv >/dev/null
size=$(wc -c <trio)
head -c $((size / 2)) trio >lost
fails "a state that is cut short" 3 'lost: the state is damaged from unit 2 on' $monitor --resume lost trio.tsv
is "the units before go on" "$(grep '^[0-9]' out | cut -f 1 | sort -u | tr '\n' ' ')" "1 2 "
third=$((size / 3))
{ head -c $third trio && head -c $third /dev/zero && tail -c $((size - third - third)) trio; } >holed
fails "a state that is damaged in the middle" 3 'holed: the state is damaged from unit 2 on' $monitor --resume holed trio.tsv
ok "the whole state has no such warning" $monitor --resume trio trio.tsv

# The memory of a unit: of a stream of 400 and of 4000 units, five rows each.
stream() {
	awk -v n="$1" 'BEGIN { print "unit\tt\ty"; for (t = 0; t < 5; t++)
		for (u = 0; u < n; u++) print u "\t" t "\t" t / 100 }'
}
for n in 400 4000; do
	stream $n | aopf --unit unit --threshold 1 --direction up --lives-only --after 1e9 --stats stats >/dev/null
	column memory_kb stats
done >memory
if [ -n "${ASAN_OPTIONS:-}" ]; then
	skip "each further unit takes some kilobytes" 'the sanitizer has an allocator of its own'
else
	near "each further unit takes some kilobytes" "$(awk 'NR == 1 { a = $1 } END { print ($1 - a) / 3600 }' memory)" 20 2
fi

# Probability and costs, of draws that the quantiles tell: the lowest quantile at 0, others
# in steps of 5 %.
levels=$(seq -s, 0 0.05 1)
aopf --threshold 1 --direction up --lives-only --levels "$levels" --mission 15 --cost-ratio 10 one.tsv | grep -v '^#' | tail -1 >last
awk -F '\t' '{ for (k = 3; k <= 23 && $k <= 15; k++); print (k - 4 + (15 - $(k - 1)) / ($k - $(k - 1))) / 20 }' last >p
near "the probability of failure within a mission is that of the quantiles" "$(cut -f 25 last)" "$(cat p)" 0.01
# by hand: cost per time of a replacement at each quantile
awk -F '\t' '{ best = 1e9; for (k = 3; k <= 22; k++) { p = (k - 3) / 20
		area += k > 3 ? (1 - p + 0.025) * ($k - $(k - 1)) : $k
		cost = (1 + 9 * p) / (69 + area)
		if (cost < best) { best = cost; at = $k } } print at }' last >best
near "the replacement time has the lowest cost" "$(cut -f 26 last)" "$(cat best)" 2
is "no replacement is advised if a failure costs no more" \
	"$(aopf --threshold 1 --direction up --lives-only --cost-ratio 1 one.tsv | column replace_in /dev/stdin | tail -1)" inf
is "a unit that has failed is replaced at once" \
	"$(seq 0 9 | awk 'BEGIN { print "t\ty" } { print $1 "\t" $1 / 5 }' |
		aopf --threshold 1 --lives-only --cost-ratio 10 | column replace_in /dev/stdin | tail -1)" 0
fails "a failure whose cost the draws do not resolve" 2 'cost-ratio 1000: want 1 to 500' \
	aopf --threshold 1 --cost-ratio 1000 one.tsv
# After 11 rows ten ages are 100, less than the mission and the level of the alarm.
seq 0 10 | awk 'BEGIN { print "t\ty"; srand(4) } { print $1 "\t" $1 / 60 + (rand() - 0.5) / 200 }' >young.tsv
for horizon in 20 0 1e6; do
	aopf --threshold 1 --direction up --lives-only --mission 1000 --cost-ratio 5 --alarm 300 --levels 0.5,0.9 \
		--horizon $horizon young.tsv | grep -v '^#' | cut -f 6-8 >decided.$horizon
done
same "what is decided does not depend on the usual horizon" decided.0 decided.1e6
same "nor on a short one" decided.20 decided.1e6
is "a young unit does not survive a long mission, and has an alarm" "$(tail -1 decided.0 | cut -f 1,3 | tr '\t' ' ')" "1 1"

# Alarms: raised when the lowest quantile falls to a level, cleared above 1.25 of it.
wear 100 95 8 | sed '1i t	y' >worn.tsv
aopf --threshold 1 --direction up --lives-only --alarm 20,5 worn.tsv >alarms
is "an alarm is active at the end" $? 4
awk -F '\t' '/^[0-9]/ { want = 0
	if ($3 != "nan") {
		if ($3 <= 20 * (was >= 1 ? 1.25 : 1)) want = 1
		if ($3 <= 5 * (was >= 2 ? 1.25 : 1)) want = 2
		bad += $7 != want
		was = want
		n++
	} } END { print bad + 0, (n > 80) }' alarms >bad
is "the levels have hysteresis" "$(cat bad)" "0 1"
head -20 worn.tsv | aopf --threshold 1 --direction up --lives-only --alarm 1,0.5 >alarms
is "without an alarm the status is 0" $? 0
fails "alarms that rise" 2 "descending" aopf --threshold 1 --alarm 1,2 one.tsv
fails "a mission without a threshold" 2 "mission requires --threshold" aopf --mission 3 one.tsv
fails "lives without a threshold" 2 "lives-only requires --threshold" aopf --lives-only one.tsv
fails "lives of the filter without it" 2 "excludes" \
	aopf --lives-only --threshold 1 --model grey one.tsv

# Downtime: the same wear, the clock of the calendar stopped for 500 after row 40.
awk -F '\t' 'NR == 1 { print "t\thours\ty"; next } { print $1 + ($1 > 40 ? 500 : 0) "\t" $1 "\t" $2 }' one.tsv >halt.tsv
aopf --threshold 1 --direction up --lives-only --clock hours halt.tsv | grep '^[0-9]' | cut -f 3- >clock
cut -f 3- whole >plain
same "lives are predicted in operating hours" clock plain
awk -F '\t' 'NR == 1 { print "t\ty"; next } { print $1 "\t" $3 }' halt.tsv >bare.tsv
aopf --threshold 1 --direction up --lives-only --stats halt.stats bare.tsv | grep -v '^#' | tail -1 | cut -f 4 >r
near "the values after a halt identify it" "$(cat r)" "$(grep -v '^#' whole | tail -1 | cut -f 4)" 1
is "halts are counted" "$(column halts halt.stats)" 1
# the first rows after it: healthy, not dead
aopf --threshold 1 --direction up --lives-only bare.tsv | awk -F '\t' '$1 == 541 { print $4 }' >r
near "the row after a halt predicts no failure" "$(cat r)" "$(awk -F '\t' '$1 == 41 { print $4 }' whole)" 5

# A repair in the events takes effect at once, an unreported one after three rows.
awk -F '\t' 'NR > 1 && $1 >= 60 { $2 -= 0.3 } { print $1 "\t" $2 }' one.tsv >repaired.tsv
printf 't\tevent\n60\trepair\n' >events.tsv
aopf --threshold 1 --direction up --lives-only repaired.tsv >untold
aopf --threshold 1 --direction up --lives-only --events events.tsv --stats events.stats repaired.tsv >told
is "events are counted" "$(column events events.stats)" 1
near "the life after a specified repair is right" "$(awk '$1 == 60 { print $4 }' told)" 68 12
near "the life after an unspecified repair is right three rows later" "$(awk '$1 == 63 { print $4 }' untold)" \
	"$(awk '$1 == 63 { print $4 }' told)" 8
printf 't\tevent\n60\tfire\n' >bad.tsv
fails "an event of another kind" 1 "bad.tsv: line 2: event 'fire', want repair or load" \
	aopf --threshold 1 --events bad.tsv one.tsv

# Events without effect
events() {
	printf "$1" >none.tsv
	shift
	aopf --threshold 1 --direction up --lives-only --events none.tsv "$@"
}
doubtful "an event of an unknown unit" "none.tsv: line 3: the event has no effect: the series has no unit 'u9'" \
	events 't\tevent\tunit\n60\trepair\tu1\n60\trepair\tu9\n' --unit unit three.tsv
doubtful "an event of a unit in a series without units" \
	"none.tsv: line 2: the event has no effect: the series has no unit 'u1'" \
	events 't\tevent\tunit\n60\trepair\tu1\n' one.tsv
doubtful "an event after the last row" \
	"none.tsv: line 3: the event has no effect: time 69.5 is after the last row of the series" \
	events 't\tevent\n69\trepair\n69.5\tload\n' one.tsv
doubtful "events before the third value" \
	"none.tsv: line 2: the event has no effect: time -5 is not after the third value in use; nor have 1 others" \
	events 't\tevent\n-5\trepair\n2\tload\n2.5\tload\n' one.tsv
ok "an event that one of several units reaches is no cause for a warning" \
	events 't\tevent\n60\trepair\n' --unit unit three.tsv
printf 't\tevent\n1000\trepair\n' >never.tsv
ok "an alarm has precedence over events without effect" sh -c \
	'aopf --threshold 1 --direction up --lives-only --alarm 20,5 --events never.tsv worn.tsv >/dev/null 2>&1; test $? = 4'
# An event while the clock of wear stands takes effect when it runs again.
printf 't\tevent\n41.5\trepair\n' >stood.tsv
awk -F '\t' 'NR == 1 { print "t\thours\ty"; next } { t = $1
	if (t == 42) print "41\t41\t" y "\n42\t41\t" y
	else if (t != 41) print t "\t" t "\t" (t > 42 ? $2 - 0.2 : $2)
	y = $2 }' one.tsv >stands.tsv
aopf --threshold 1 --direction up --lives-only --clock hours --events stood.tsv --stats stood.stats stands.tsv >stood
is "an event while the clock stands is not lost" "$(column events stood.stats)" 1
near "the life after a repair while the clock stood is right" "$(awk '$1 == 43 { print $4 }' stood)" 77 15
awk -F '\t' -v OFS='\t' 'NR > 30 { $2 -= 20 } { print }' stands.tsv >reset.tsv
fails "a clock that decreases" 1 "reset.tsv: line 31: operating time 9 comes after 28: it must not decrease" \
	aopf --threshold 1 --clock hours reset.tsv
# An event that is reported only after a state was saved
printf 't\tevent\n30\tload\n' >late.tsv
head -51 one.tsv | aopf --threshold 1 --direction up --lives-only --events late.tsv --save late.state >/dev/null
ok "a known event before the saved state" aopf --threshold 1 --direction up --lives-only \
	--events late.tsv --resume late.state one.tsv
printf '40\trepair\n' >>late.tsv
doubtful "an event before the saved state that it does not know" \
	"late.tsv: 1 events are not after the last row of the saved state and have no effect" \
	aopf --threshold 1 --direction up --lives-only --events late.tsv --resume late.state one.tsv

# A fleet in operating hours, one unit of which has no value
awk 'BEGIN { srand(3); print "unit\tt\thours\ty\nidle\t0\t0\tnan"
	for (h = 0; h <= 100; h++) print "old\t" 10 * h "\t" h "\t" (h / 100) ^ 2 + 0.01 * rand()
	print "old\t1010\t100\t1" }' >hours.tsv
awk 'BEGIN { srand(4); print "t\thours\ty"
	for (h = 0; h <= 50; h++) print 3 * h "\t" h "\t" (h / 100) ^ 2 + 0.01 * rand() }' >worked.tsv
near "the ages of a fleet are operating hours, too" "$(aopf --threshold 1 --direction up --lives-only \
	--clock hours --fleet hours.tsv worked.tsv | column rul_q50 /dev/stdin | tail -1)" 50 3
fails "a fleet whose operating time decreases" 1 "back.tsv: line 40: operating time decreases" sh -c \
	"awk -F '\t' -v OFS='\t' 'NR == 40 { \$3 = 1 } { print }' hours.tsv >back.tsv
	aopf --threshold 1 --direction up --lives-only --clock hours --fleet back.tsv worked.tsv"

# A unit that is in its own fleet, too
awk '{ print (NR == 1 ? "unit" : "mine") "\t" $0 }' one.tsv >mine.tsv
{ cat mine.tsv; wear 80 82 5 | sed 's/^/old	/'; wear 120 122 6 | sed 's/^/older	/'; } >with.tsv
grep -v '^mine' with.tsv >without.tsv
for f in with without; do
	aopf --unit unit --threshold 1 --direction up --lives-only --weights --fleet $f.tsv mine.tsv | grep '^mine' >$f
done
same "the path of a unit is no evidence for itself" with without

# Options that nothing would heed
for o in '--weights' '--clock t' '--direction up' '--persist 2' '--after 3' '--model linear'; do
	# shellcheck disable=SC2086 # words
	fails "$o without a threshold" 2 "requires --threshold" aopf $o one.tsv
done
fails "an option of the filter without it" 2 "lives-only excludes --particles" \
	aopf --lives-only --threshold 1 --particles 10 one.tsv
fails "a fleet for the grey model" 2 "fleet is not for --model grey" \
	aopf --threshold 1 --direction up --fleet hours.tsv --model grey one.tsv

# Weights of straight wear
aopf --threshold 1 --direction up --lives-only --weights one.tsv >weights
column weight_linear weights | tail -1 >w
ok "a straight line gives the linear family the largest weight" sh -c \
	"grep -v '^#' weights | tail -1 | cut -f 7-12 | tr '\t' '\n' | sort -g | tail -1 | cmp - w"
near "weights add up to 1" "$(grep -v '^#' weights | tail -1 | cut -f 7-13 | awk '{ print $1 + $2 + $3 + $4 + $5 + $6 + $7 }')" 1 1e-9

# JSON
aopf --unit unit --threshold 1 --direction up --lives-only --json three.tsv >rows.json
is "each row is a line of JSON" "$(grep -c '^{"unit":"u[123]","t":[0-9]*,"y":.*}$' rows.json)" 240
if command -v python3 >/dev/null; then
	python3 -c 'import json
n = [json.loads(x) for x in open("rows.json")]
print(len(n), sorted(n[0]), n[0]["rul_q50"])' >parsed
	is "the JSON can be parsed" "$(cat parsed)" \
		"240 ['p_no_crossing', 'rul_q05', 'rul_q50', 'rul_q95', 't', 'unit', 'y'] None"
fi
# Events of a kind between two rows are one, in any order; a repair of one unit is none of another.
sheet() {
	printf "$1" >sheet.tsv
	shift
	aopf --threshold 1 --direction up --lives-only --events sheet.tsv "$@" 2>err | grep -v '^#'
}
sheet 't\tevent\n59.2\trepair\n59.4\tload\n' repaired.tsv >once
sheet 't\tevent\n59.5\tload\n59.6\trepair\n59.5\tload\n59.6\trepair\n' repaired.tsv >twice
same "events that are told twice, or in another order, are one of each kind" once twice
fails "units of events under another name" 1 "sheet.tsv: .*no column 'machine'" \
	sh -c "printf 't\tevent\tunit\n60\trepair\tu1\n' >sheet.tsv; sed 's/^unit/machine/' three.tsv >machines.tsv
	aopf --threshold 1 --direction up --lives-only --events sheet.tsv --unit machine machines.tsv"
fails "days for a series of unknown times" 1 "sheet.tsv: column 't' is in 'd', but the series names no unit" \
	sh -c "printf '# units: d 1\nt\tevent\n60\trepair\n' >sheet.tsv
	aopf --threshold 1 --direction up --lives-only --events sheet.tsv repaired.tsv"
printf 't\tevent\n60\trepair\n# doubtful: guessed\n' >sheet.tsv
aopf --threshold 1 --direction up --lives-only --events sheet.tsv repaired.tsv >out 2>err
is "lives from doubtful events are doubtful" "$? $(grep '^# doubtful' out)" "3 # doubtful: guessed"
aopf --threshold 1 --direction up --lives-only --events never.tsv repaired.tsv >out 2>err
is "a table whose lives are doubtful says so" "$? $(grep -c '^# doubtful' out)" "3 1"
done_testing

#!/bin/sh
# Ends of streams: what was cut off is refused wherever the cut falls, in files and in
# pipes, and what was whole before it is passed on; other tools read on
. "$(dirname "$0")/tap.sh"
. "$top/tests/au.sh"

roughgen --points 8 --length 1mm --sq 1um --corr 300um --count 3 >fields
sensorsim --uniform 80um:150um --number 5 --duration 20ms --truth table >signal
sensorsim --single --uniform 80um:150um --number 5 --duration 20ms --truth - >single 2>/dev/null
sensorsim --single --uniform 80um:150um --number 5 --duration 20ms >single
for f in fields signal single table; do
	ok "a whole stream of $f is whole" records --check $f
	like 'and says so' "$(cat out)" "^$f: .*, whole$"
done

# Every cut of a stream is refused, by --check and by a reader.
for f in fields signal single table; do
	size=$(wc -c <$f)
	missed=
	n=0
	# Every byte near the begin and the end, and then some with a stride that is prime.
	for at in $(seq 0 40) $(seq 41 97 $((size - 41))) $(seq $((size - 40)) $((size - 1))); do
		head -c "$at" $f >cut
		n=$((n + 1))
		records --check cut >out 2>err
		[ $? = 1 ] && [ "$(wc -l <err)" = 1 ] || missed="$missed $at"
	done
	is "each of $n cuts of $f is refused" "$missed" ''
done

# One flipped bit anywhere is seen, unless the reader refuses the value itself.
for f in fields signal table; do
	size=$(wc -c <$f)
	missed=
	for at in $(seq 30 211 $((size - 2))); do
		flip $f "$at" >bad
		records --check bad >out 2>err
		[ $? = 1 ] && [ "$(wc -l <err)" = 1 ] || missed="$missed $at"
	done
	is "a flipped bit of $f is seen wherever it falls" "$missed" ''
done

done_testing

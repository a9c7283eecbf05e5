#!/bin/sh
# An ensemble killed at random moments and resumed gives the bytes of a single process, and
# never a wrong or short result without an error
. "$(dirname "$0")/../tap.sh"

surfaces='roughgen --points 64 --length 10um --sq 0.1um --corr 1um'
rest='bemcontact --pressure 50MPa --young 210GPa --boundary periodic | debrisgen --yield 355MPa --friction 0.3 2>/dev/null'
eval "$surfaces --count 8 | $rest" >whole
command="$surfaces --first \$K | $rest"

run() {
	"$top/scripts/ensemble" -j 2 -d folder 8 "$command" >joined 2>err
}
begin=$(date +%s%N)
run
length=$((($(date +%s%N) - begin) / 1000000)) # ms
same 'an undisturbed ensemble is complete' joined whole
wrong=
finished=0
for k in $(seq 20); do
	rm -rf folder
	after=$(awk -v s="$k" -v l="$length" 'BEGIN { srand(s); printf "%.3f", rand() * l / 1000 }')
	: >joined
	run &
	pid=$!
	sleep "$after"
	# the shell of the run and the script it started, nothing else
	child=$(ps -o pid= --ppid $pid)
	kill -KILL $child $pid 2>/dev/null
	wait $pid 2>/dev/null && cmp -s joined whole && finished=$((finished + 1))
	# What was joined is whole or not called so.
	if records --check joined >/dev/null 2>&1 && ! cmp -s joined whole; then
		wrong="$wrong $k:looks-whole"
	fi
	run || wrong="$wrong $k:$(tail -n 1 err)"
	cmp -s joined whole || wrong="$wrong $k:resumed-differs"
done
is "an ensemble killed at 20 moments ($finished had finished) is resumed" "$wrong" ''
done_testing

#!/bin/sh
# On a terminal a program that takes long tells how far it is, in a line that it erases; a
# pipeline has a line for each program; elsewhere there is silence
. "$(dirname "$0")/tap.sh"

if ! command -v script >/dev/null; then
	skip 'progress' 'no script(1) to make a terminal'
	done_testing
fi
sensorsim --uniform 80um:150um --number 40 --duration 4s >signal
# Slow input, no work: a second passes in waiting.
cat >slowly <<'END'
for i in 1 2 3 4 5 6 7 8 9 10; do
	dd if=signal bs=64k skip=$((i - 1)) count=1 2>/dev/null
	sleep 0.25
done
END
# lines: what the terminal got, split where the cursor is moved
lines() {
	tr '\r' '\n' <"typescript${1:-}" | tr '\033' '\n'
}
script -qec 'sh slowly | bpfilter --band 0:5000 --order 20 >filtered' typescript >/dev/null 2>&1
like 'a program reports how much it has read' "$(lines)" '^bpfilter: [0-9]* MB, [1-9][0-9]* s$'
like 'a program erases its progress at the end' "$(lines | grep -v '^$' | grep -v '^Script' | tail -n 1)" '^\[K'
sh slowly | bpfilter --band 0:5000 --order 20 >quiet 2>err
is 'no progress is written where standard error is no terminal' "$(cat err)" ''
script -qec 'sh slowly | bpfilter --band 0:5000 --order 20 | bpfilter --band 0:5000 --order 30 >twice' typescript >/dev/null 2>&1
like 'the second program of a pipeline writes a line below the first' "$(lines | tr '\n' '|')" '\[1B|bpfilter: '
same 'progress does not change the output' filtered quiet

# share NAME PROGRAM COMMAND: the program tells its share.  The reader of its output, or the
# writer of its input, waits for longer than the second after which a line is shown; all of
# them wait at the same time.
shares=0
share() {
	shares=$((shares + 1))
	printf '%s\n' "$1" >"name.$shares"
	echo "$2" >"program.$shares"
	script -qec "$3" "typescript.$shares" >/dev/null 2>&1 &
}
share 'work of known size reports its share and the time left' roughgen \
	'roughgen --points 512 --length 1mm --sq 1um --corr 50um --count 200 | { sleep 1.5; cat; } >/dev/null'
awk 'BEGIN { print "t\ty"; for (t = 0; t < 3000; t++) print t "\t" 1 + t / 1000 }' >series.tsv
share 'a series of known size has a share' aopf 'aopf series.tsv | { sleep 1.5; cat; } >/dev/null'
share 'a record of known duration has a share' sensorsim \
	'sensorsim --uniform 80um:150um --number 4 --duration 20s | { sleep 1.5; cat; } >/dev/null'
roughgen --points 64 --length 1mm --sq 1um --corr 50um --crown auto --count 4 |
	bemcontact --pressure 1MPa --young 210GPa >four.nrrd
share 'contacts of a stream of known size have a share' bemcontact \
	'bemcontact --pressure 2MPa --young 210GPa four.nrrd | { sleep 1.5; cat; } >/dev/null'
share 'the last contact of a pipe has a share' bemcontact \
	'{ head -c 100000 four.nrrd; sleep 1.5; tail -c +100001 four.nrrd; } | bemcontact --pressure 2MPa --young 210GPa >/dev/null'
share 'wear of several surfaces has a share' debrisgen \
	'mkfifo worn; { sleep 1.5; cat; } <worn >/dev/null & debrisgen --yield 355MPa --young 210GPa --surface worn --steps 3 four.nrrd >rows; wait'
debrisgen --yield 355MPa --friction 0.3 four.nrrd >particles.tsv 2>err
share 'the sources of a mixture have a share' duet \
	'sh slowly | duet --method duet --align 0 --separated sources.au >/dev/null'
share 'the paths of an ensemble have a share' rwl \
	'{ head -n 6 particles.tsv; sleep 1.5; tail -n +7 particles.tsv; } | rwl --new --wear - --step-time 1h --count 3000000 --area 1mm2 >/dev/null'
share 'a bootstrap has a share' debrisstat \
	'{ head -n 6 particles.tsv; sleep 1.5; tail -n +7 particles.tsv; } | debrisstat --bootstrap 50 >/dev/null'
wait
for n in $(seq $shares); do
	like "$(cat "name.$n")" "$(lines ".$n")" "^$(cat "program.$n"): [0-9]* %, [0-9]* s left$"
done
done_testing

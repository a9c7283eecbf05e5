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
	tr '\r' '\n' <typescript | tr '\033' '\n'
}
script -qec 'sh slowly | bpfilter --order 20 >filtered' typescript >/dev/null 2>&1
like 'a program tells what it has read' "$(lines)" '^bpfilter: [0-9]* MB, [1-9][0-9]* s$'
like 'and erases it at the end' "$(lines | grep -v '^$' | grep -v '^Script' | tail -n 1)" '^\[K'
sh slowly | bpfilter --order 20 >quiet 2>err
is 'not where standard error is no terminal' "$(cat err)" ''
script -qec 'sh slowly | bpfilter --order 20 | bpfilter --order 30 >twice' typescript >/dev/null 2>&1
like 'the second program of a pipeline writes a line below the first' "$(lines | tr '\n' '|')" '\[1B|bpfilter: '
same 'and the output is that of no terminal' filtered quiet
script -qec 'roughgen --points 512 --length 1mm --sq 1um --corr 50um --count 200 | head -c 400000000 >/dev/null' typescript >/dev/null 2>&1
like 'work whose size is known tells its share and the time left' "$(lines)" '^roughgen: [0-9]* %, [0-9]* s left$'
done_testing

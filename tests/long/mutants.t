#!/bin/sh
# Streams with random faults: every program reads or refuses them, in one line, in time
. "$(dirname "$0")/../tap.sh"

${CC:-cc} -O1 -o mutate "$top/tests/faults/mutate.c" 2>err || {
	skip 'every mutant is read or refused' 'no compiler'
	done_testing
}
each=${MUTANTS:-70} # mutants of a scene
roughgen --points 8 --length 10um --sq 0.1um --corr 3um --count 2 >surfaces
bemcontact --pressure 50MPa --young 210GPa surfaces >contacts
debrisgen --yield 355MPa --friction 0.3 contacts >particles 2>/dev/null
sensorsim --uniform 80um:150um --number 10 --duration 100ms --noise 5mV --truth truth >signal
awk 'BEGIN { print "t\ty"; for (i = 0; i < 30; i++) print i "\t" 1 + i / 50 }' >series
printf 'volume\n1.1e-15\n1.4e-15\n0.9e-15\n1.2e-15\n' >wear
delaynet --columns 8 --layers 3:relu --count 20 --epochs 2 --batch 10 >net
delaynet --task data --columns 8 --count 3 >sections
# What marks no end is looked at further: the same without promise.
grep -v '^#' particles >plain
sed 's/wearpipe-streams(5)/anything-streams(5)/' signal >foreign
sed '/^stream:=/d' contacts >unmarked

# scene STREAM COMMAND...: the mutants on standard input
scene() {
	stream=$1
	shift
	odd=
	seed=0
	while [ $seed -lt "$each" ]; do
		seed=$((seed + 1))
		./mutate $seed <"$stream" >mutant
		timeout 20 "$@" <mutant >out 2>err
		got=$?
		case $got in
		0 | 3) ;;
		# what was read before the fault may be doubtful, which takes a line of its own
		1 | 2) case $(wc -l <err) in [123]) ;; *) odd="$odd $seed:lines" ;; esac ;;
		*) odd="$odd $seed:$got" ;;
		esac
	done
	is "$each mutants of $stream: $1 reads or refuses them" "$odd" ''
}
scene surfaces records
scene unmarked records --output nrrd
scene surfaces bemcontact --pressure 50MPa --young 210GPa
scene contacts debrisgen --yield 355MPa --friction 0.3
scene unmarked debrisgen --yield 355MPa --friction 0.3
scene particles debrisstat
scene plain debrisstat
scene plain sensorsim --duration 100ms
scene signal bpfilter --order 100
scene foreign bpfilter --order 100
scene foreign duet
scene series aopf --particles 20 --threshold 2
scene wear rwl --new --wear - --step-time 1h --threshold-gap 11um --count 20
scene net delaynet --task score --columns 8 --count 5
scene sections delaynet --task apply --network net

# Every stream that was once read wrongly, or crashed a reader, is kept: it is read or
# refused in one line.
odd=
for f in "$top"/tests/fuzz/corpus/fields/* "$top"/tests/fuzz/corpus/signals/* "$top"/tests/fuzz/corpus/tables/*; do
	for action in --check '--output nrrd'; do
		# shellcheck disable=SC2086 # an option and its word
		timeout 20 records $action "$f" >out 2>err
		got=$?
		case $got in
		0 | 3) ;;
		1) [ "$(wc -l <err)" = 1 ] || odd="$odd ${f##*/}:$(wc -l <err) lines" ;;
		*) odd="$odd ${f##*/}:$got" ;;
		esac
		! grep -q "$(printf '\033')" err || odd="$odd ${f##*/}:escape"
	done
done
is 'every stream of the corpus is read or refused' "$odd" ''
done_testing

#!/bin/sh
# A system call or allocation that fails, whichever and whenever: every program says so in
# one line and fails, or its output is the same bytes
. "$(dirname "$0")/../tap.sh"
case ${ASAN_OPTIONS:-} in
?*)
	skip 'every fault is reported or does no harm' 'the sanitizer has an allocator of its own'
	done_testing
	;;
esac
if ! ${CC:-cc} -shared -fPIC -O1 -o shim.so "$top/tests/faults/shim.c" -ldl 2>err; then
	skip 'every fault is reported or does no harm' 'no library can be preloaded here'
	done_testing
fi
most=${FAULTS:-8} # calls of a function that are tried, first, last and spread between

roughgen --points 16 --length 10um --sq 0.1um --corr 3um --count 2 >surfaces
bemcontact --pressure 50MPa --young 210GPa surfaces >contacts
debrisgen --yield 355MPa --friction 0.3 contacts >particles 2>/dev/null
sensorsim --uniform 80um:150um --number 10 --duration 200ms --noise 5mV --truth truth >signal
sensorsim --uniform 80um:150um --number 10 --duration 500ms --noise 5mV --pump 30mV --seed 3 |
	bpfilter --band 0:800Hz --order 200 >hum
awk 'BEGIN { print "t\ty"; for (i = 0; i < 30; i++) print i "\t" 1 + i / 50 }' >series
printf 'volume\n1.1e-15\n1.4e-15\n0.9e-15\n1.2e-15\n' >wear
delaynet --columns 8 --layers 3:relu --count 20 --epochs 2 --batch 10 >net
delaynet --task data --columns 8 --count 3 >sections
{
	printf 'time1\tdiameter\tamplitude\tdelay\tvelocity\tverdict\n'
	awk 'BEGIN { for (i = 1; i <= 12; i++) printf "%g\t%g\t%g\t0.02\t12.5\talone\n", i / 2, 1e-4, 1 + i / 1000 }'
} >found
sed 's/1e-04/1.2e-4/; s/0.0001\t/0.00012\t/' found | awk -F '\t' -v OFS='\t' 'NR > 1 { $3 *= 1.728 } { print }' >larger
printf '1 2 3\n4 5 6\n7 8 9\n' >matrix
sigconvert --output text signal | grep -v '^#' | head -n 40 >recording
records --output table surfaces >points

# broken: what a run did that it should not have done; empty where all is well
broken() {
	lines=0
	while read -r line; do
		lines=$((lines + 1))
	done <err
	if [ "$got" -ge 126 ]; then
		echo "ended by signal $((got - 128))"
	elif [ "$got" = 0 ] || [ "$got" = "$normal" ]; then
		for f in out $sides; do
			cmp -s "$f" "$f.whole" || echo "exit status $got with other bytes in $f"
		done
	elif [ $lines = 0 ]; then
		echo "exit status $got without a word"
	elif grep -q ': Success$' err; then
		echo "no reason: $(grep ': Success$' err)"
	elif [ $lines -gt 1 ] && [ "$(grep -cvxFf err.whole err)" -gt 1 ]; then
		echo "$lines lines: $(tail -n 1 err)"
	fi
}

# scene "SIDE-OUTPUTS" COMMAND...
scene() {
	sides=$1
	shift
	for call in malloc calloc realloc strdup read write fwrite fopen fclose fflush open_memstream pthread_create; do
		FAULT_CALL=$call FAULT_COUNT=count LD_PRELOAD=./shim.so "$@" >out.whole 2>err.whole </dev/null
		normal=$?
		for f in $sides; do mv "$f" "$f.whole"; done
		read -r n <count
		odd=
		tried=0
		step=$((n > most ? n / most : 1))
		at=1
		while [ "$at" -le "$n" ]; do
			timeout 20 env FAULT_CALL=$call FAULT_AT=$at LD_PRELOAD=./shim.so "$@" >out 2>err </dev/null
			got=$?
			tried=$((tried + 1))
			what=$(broken)
			[ -z "$what" ] || odd="$odd
$call $at of $n: $what"
			at=$((at < 8 || at + step > n && at < n ? at + 1 : at + step))
		done
		all=$((all + tried))
		faults="$faults$odd"
	done
	is "$1: $all faults are reported or do no harm" "$faults" ''
	# The smallest stack that is accepted is enough.
	# shellcheck disable=SC3045 # dash and bash have it
	(ulimit -s 256 && "$@" >out 2>err </dev/null)
	got=$?
	is "$1: a small stack changes nothing" "$(broken)" ""
	# shellcheck disable=SC3045
	(ulimit -s 64 && "$@" >out 2>err </dev/null)
	is "$1: a smaller stack is refused" "$? $(cat err)" \
		"1 $1: the stack may have 64 kB, want 256: see ulimit -s"
	all=0
	faults=
}
# limited COMMAND...: with less and less memory, FFTW's planner included
limited() {
	odd=
	"$@" >out.whole 2>err.whole </dev/null
	normal=$?
	for kb in 200000 120000 80000 60000 50000 40000 32000 26000 22000 19000 17000 15000 13500 12500 11500 10500 9500; do
		# shellcheck disable=SC3045
		(ulimit -v $kb && "$@" >out 2>err </dev/null) 2>shell
		got=$?
		# below this the loader itself fails
		! grep -q 'shared libraries\|cannot map\|oader' err shell || continue
		sides=
		what=$(broken)
		[ -z "$what" ] || odd="$odd
$kb kB: $what"
	done
	is "$1: little memory is reported or does no harm" "$odd" ''
}
limited roughgen --points 128 --length 10um --sq 0.1um --corr 3um
limited bemcontact --pressure 50MPa --young 210GPa surfaces
limited debrisgen --yield 355MPa --friction 0.3 contacts
limited bpfilter --order 2000 signal
all=0
faults=
scene '' roughgen --points 16 --length 10um --sq 0.1um --corr 3um --count 2 --threads 2
scene '' roughgen --measure surfaces
scene '' bemcontact --pressure 50MPa --young 210GPa --threads 2 surfaces
scene 'side1 side2 side3' debrisgen --yield 355MPa --friction 0.3 --steps 2 --threads 2 --surface side1 \
	--summary side2 --stress side3 contacts
scene '' debrisstat particles
scene 'side1' sensorsim --uniform 80um:150um --number 10 --duration 200ms --noise 5mV --truth side1
scene '' bpfilter --order 100 --lines 50 signal
scene 'side1 side2' duet --separated side1 --sections side2 signal
scene '' duet --method duet hum
scene '' duet --method count signal
scene 'side1' duet --method duet --align 0 --separated side1 signal
scene '' aopf --particles 20 --threshold 2 series
scene '' rwl --new --wear wear --step-time 1h --threshold-gap 11um --count 20
scene '' delaynet --columns 8 --layers 3:relu --count 20 --epochs 2 --batch 10
scene '' delaynet --task apply --network net sections
scene '' wear-volume found
scene '' debriscount --classes 50um,110um --duration 7s found
scene '' ballcal --balls found:100um --balls larger:120um --noise 5mV --pulse-duration 10ms
scene 'side1 side2' abrade --load 10mN --hardness 4GPa --friction 0.1 --slide 5um --surface surfaces \
	--particles side1 --summary side2 particles
scene '' layout --coils 0,25cm --snr 30dB --arrivals 100 --spread 2.5%
scene '' surfimport --pixel 1um --height-unit 1um matrix
scene '' sigconvert recording
scene '' sigconvert --output text signal
# WAV and not FLAC: libFLAC does not look whether it got memory.
! sigconvert --output wav signal >wav 2>err || scene '' sigconvert --output wav signal
scene '' records --output nrrd points
scene '' records --output nrrd surfaces
scene '' records --join particles particles
done_testing

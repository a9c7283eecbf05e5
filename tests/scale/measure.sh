#!/bin/sh
# measure.sh - what one core does in an hour: a table of programs, work and its unit
#
#	sh tests/scale/measure.sh >hour.tsv
#
# Processor seconds are those that the programs report, so that other work on the machine
# disturbs little.  The figures of wearpipe(7) are from here.
set -eu
top=$(cd "$(dirname "$0")/../.." && pwd)
PATH=$top/bin:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cc -O2 -o particles "$top/tests/scale/particles.c" -lm

# hour AMOUNT UNIT PROGRAM ARGUMENT...
hour() {
	amount=$1
	unit=$2
	shift 2
	"$@" --stats stats >out 2>err || [ $? = 3 ] || [ $? = 4 ]
	awk -F '\t' -v n="$amount" -v unit="$unit" 'NR == 2 { printf "%s\t%.2g\t%s\n", $1, n / $3 * 3600, unit }' stats
}
printf 'program\tin_an_hour\tunit\n'
hour 40 'surfaces of 256 x 256' roughgen --points 256 --length 1mm --sq 0.8um --corr 50um --count 40
roughgen --points 128 --length 1mm --sq 0.8um --corr 50um --crown 3.2um --count 4 >surfaces
hour 4 'contacts of 128 x 128' bemcontact --load 50N --young 210GPa surfaces
mv out contacts
hour 12 'wear steps of 128 x 128, with contact and stress' debrisgen --yield 355MPa --friction 0.3 --steps 3 contacts
./particles 300000 >many.tsv
hour 300000 particles debrisstat many.tsv
hour 300000 particles rwl --new --wear many.tsv --step-time 1h --threshold-gap 11um --count 100
hour 100 's of signal at 10 kHz' sensorsim --uniform 100um:200um --number 1000 --duration 100s --noise 1mV
mv out signal
hour 100 's of signal at 10 kHz' bpfilter signal
sensorsim --uniform 100um:200um --number 100 --duration 10s --noise 1mV >short
hour 10 's of signal at 10 kHz, ten particles a second' duet short
awk 'BEGIN { print "t\ty"; for (i = 0; i < 2000; i++) print i "\t" 1 + i / 2000 }' >series
hour 2000 'rows of a series' aopf --threshold 10 series

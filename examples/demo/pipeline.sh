#!/bin/sh
# From a rough surface to the distribution of remaining wear life, in two pipelines.
#
# usage: pipeline.sh [roughgen options and a measured surface]
#
# A square millimetre of steel is pressed and slid against another, again and again.  One
# wear step stands for an hour of running, and two seconds of the record of the debris
# sensors for the debris of that hour.  The pair is worn out when it has lost 0.09
# cubic millimetres, which happens before the record ends.  A measured surface takes the
# place of the twenty-four generated ones; area, sensor and threshold are then scaled to
# its size.
#
# Leaves its streams in the working directory for the pictures.  Exit status 3 of a program
# means a result that may be unreliable, as the life from one surface alone; its warning
# states the reason.
set -eu

# A measured surface is put on a crown, so that its middle carries the load.
if [ $# -gt 0 ]; then
	steps=48
	roughgen --level --resample 128 "$@" >flat.nrrd
	crown=$(records flat.nrrd | awk -F '\t' '$1 == 1 { print 0.01 * $5 * $8 }')
	roughgen --crown "$crown" flat.nrrd >surface.nrrd
else
	steps=2
	roughgen --points 128 --length 1mm --sq 0.8um --corr 50um --crown auto --count 24 >surface.nrrd
fi

# What follows from the nominal area: the volume lost at failure, and the calibration of a
# sensor that gives 1 V for a particle of a tenth of the side.
read -r area volume sensor <<EOF
$(records surface.nrrd | awk -F '\t' '$1 == 1 { a = $5 * $8 * $6 * $9
	print a, 0.09 * a ^ 1.5, 78.54 / a ^ 1.5 }')
EOF

# What wears off ...
<surface.nrrd bemcontact --pressure 50MPa --young 210GPa | tee contact.nrrd |
	debrisgen --yield 355MPa --friction 0.3 --steps $steps \
		--surface worn.nrrd --summary steps.tsv >particles.tsv || [ $? = 3 ]

# ... and what the sensors tell of it.
sensorsim --duration 96s --calibration $sensor --noise 5mV --mains 20mV --pump 50mV \
	--truth truth.tsv particles.tsv | tee raw.au |
	bpfilter --band 0:1500 --lines 50 --zero-phase | tee band.au |
	duet --calibration $sensor --separated pulses.au | tee found.tsv |
	wear-volume --period 2s --time-scale 1800 |
	aopf | tee state.tsv |
	rwl --wear particles.tsv --fragment-area $area --area $area --quantity volume \
		--threshold-volume $volume - >life.tsv || [ $? = 3 ]

#!/bin/sh
# Stiff and extreme scenes of delaynet: accurate, or refused in one line.
. "$(dirname "$0")/../tap.sh"
. "$top/tests/extremes/scenes.sh"
. "$top/tests/au.sh"

# alike NAME EXPECTATION FILE FILE: the same weights
alike() {
	sed '/^#/d; /^end/d' "$3" >one
	sed '/^#/d; /^end/d' "$4" >two
	[ -s one ] || echo "no weights" >one
	same "$1 | $2 | the same | 0" one two
}

# error COLUMN OPTION...: of the net on standard input, clean samples
error() {
	c=$1
	shift
	delaynet --task score "$@" >scores
	column "$c" scores | head -n 1
}
x="--columns 40"

# shellcheck disable=SC2086
{
	delaynet $x --epochs 10 --scaled >unit.net
	scene "amplitudes of 1e6, scaled" "as amplitudes of 1" \
		"$(error ordered $x --scaled <unit.net)" 1e-4 \
		"$(delaynet $x --epochs 10 --scaled --amplitude 0:1e6 |
			error ordered $x --scaled --amplitude 0:1e6)"
	# Descent alone reaches the mean of the labels: 1/12 to what 10000 labels allow.
	scene "silence" "the constant, 1/12" 0.083333 0.001 \
		"$(delaynet $x --amplitude 0:0 --scaled --optimiser descent --learning-rate 0.1 |
			error ordered $x --amplitude 0:0 --scaled --count 10000)"
	scene "two columns" "no better than 1/18, no worse than 1/12" 0.0695 0.02 \
		"$(delaynet --columns 2 --epochs 20 | error ordered --columns 2)"
	delaynet $x --count 1 --epochs 3000 --layers 4 >one.net
	scene "one sample" "reproduced exactly" 0 1e-6 \
		"$(error ordered $x --first 0 --count 1 <one.net)"
	# Sorted constants leave 1 / (6 (n + 1)) of sixteen delays.
	scene "sixteen sources, best order" "sorted constants, 1/102" 0.0098 0.002 \
		"$(delaynet $x --sources 16 --loss unordered --epochs 30 --amplitude 0:0 |
			error unordered $x --sources 16 --amplitude 0:0)"
	delaynet $x --epochs 3 --batch 0 >all.net
	delaynet $x --epochs 3 --batch 1000000 >more.net
	alike "a batch larger than the set" "the whole set" all.net more.net
	delaynet $x --epochs 3 --learning-rate 0 >still.net
	delaynet $x --epochs 0 >start.net
	alike "steps of length 0" "the weights drawn" still.net start.net
	fifteen="1 1 1 1 1 1 1 1 1 1 1 1 1 1 1"
	delaynet $x --epochs 1 --layers "$fifteen" >deep.net
	is "fifteen hidden layers of one unit | sixteen layers with the output | 16 | 0" \
		"$(sed -n 's/^layers//p' deep.net | wc -w)" 16
	refused "sixteen hidden layers" 2 "at most 15" delaynet $x --layers "$fifteen 1"
	refused "a kernel of 4096 x 4096" 1 "too large" delaynet $x --layers 200conv4096x4096
	refused "a million by a million weights" 1 "too large" delaynet $x --layers "1000000 1000000"
	refused "amplitudes of 1e6, not scaled" 1 "diverged" \
		delaynet $x --amplitude 1e6:1e6 --optimiser descent --layers 4:relu
}
delaynet --task data --columns 40 --count 2 >two.snd
head -c 1000 two.snd >some.snd
frames two.snd 2 >two.txt
rate=$(od -An -v -tu1 -j16 -N4 two.snd | awk '{ print (($1 * 256 + $2) * 256 + $3) * 256 + $4 }')
: | au "$rate" 2 >empty.snd
delaynet --task apply --network start.net empty.snd >none.tsv
is "a signal without frames | a table without rows | 0 | 0" "$(column section none.tsv | wc -l)" 0
sed '$ s/[^[:blank:]]*$/nan/' two.txt | au "$rate" 2 >nan.snd
refused "nan as the last of the samples" 1 "frame 79: want finite" \
	delaynet --task apply --network start.net nan.snd
sed '$ s/[^[:blank:]]*$/1.797e308/' two.txt | au "$rate" 2 >huge.snd
refused "1.8e308 among the samples" 1 "frame 79: want finite" \
	delaynet --task apply --network start.net huge.snd
done_testing

#!/bin/sh
# delaynet: training by seed, scores beside the levels, files, errors
. "$(dirname "$0")/tap.sh"

# A network edited by sed, with the checksum of what it now is: gzip ends with it, reversed.
edited() {
	sed "$1;/^end /d" "$2" >body
	gzip -c body | tail -c 8 | od -An -tx1 -N4 | awk '{ print "end crc32 " $4 $3 $2 $1 }' | cat body -
}

small="--columns 40 --layers 6 --count 200 --batch 20"

# shellcheck disable=SC2086
{
	delaynet $small --epochs 30 >a.net
	delaynet $small --epochs 30 >b.net
	same "the same options give the same bytes" a.net b.net
	delaynet $small --epochs 30 --repetition 1 >b.net
	ok "another repetition gives other weights" sh -c '! cmp -s a.net b.net'
	is "the file states its format" "$(sed -n '1p;3,5p' a.net | tr '\n' ';')" \
		"wearpipe-network 2;purpose delays;input 1 2 40;layers 6:tanh 3:linear;"
	is "the file has as many weights as declared" "$(sed '/^weights/,/^end/!d;/^[we]/d' a.net | wc -w)" \
		"$(sed -n 's/^weights //p' a.net)"

	# Zero epochs with weights that are drawn score worse than the constant; trained ones
	# on arrival order with fresh data beat it clearly, since one source has one label.
	delaynet $small --sources 1 --fresh --epochs 300 --labels arrival --learning-rate 3e-3 >one.net
	delaynet --task score --columns 40 --sources 1 one.net >one.tsv
	got=$(column ordered one.tsv | head -n 1)
	ok "one source is learnt: $got is far below 1/12" \
		awk -v g="$got" 'BEGIN { exit !(g < 0.4 / 12) }'
	is "the table has a clean row and a noisy row" "$(column noise one.tsv | tr '\n' ' ')" \
		"0 0.31622776601683794 "
	is "with one source both orders give the same score" "$(column ordered one.tsv)" "$(column unordered one.tsv)"
}
delaynet --task score --columns 40 a.net >a.tsv
is "score reads standard input" "$(delaynet --task score --columns 40 <a.net)" "$(cat a.tsv)"
is "score keeps the recorded pipeline" "$(sed -n 's/^# cmd: //p' a.tsv)" \
	"delaynet --columns 40 --layers 6 --count 200 --batch 20 --epochs 30 | delaynet --task score --columns 40"
is "the best order is never worse than the given order" "$(awk '/^[0-9]/ { print ($5 ~ /^[0-9]/ && $5 + 0 <= $3 + 0) }' a.tsv | sort -u)" 1

# A linear network without hidden worth: gradient descent on the constant stays the mean.
delaynet --columns 4 --layers 2:relu --optimiser descent --learning-rate 0.5 --epochs 400 --batch 0 \
	--amplitude 0:0 >flat.net
delaynet --task score --columns 4 --amplitude 0:0 flat.net --count 10000 >flat.tsv
near "without a signal the score is that of the constant predictor, 1/12" \
	"$(column ordered flat.tsv | head -n 1)" 0.083333 0.0015

# Exported data and the application of a network to them.
delaynet --task data --columns 40 --count 50 --first 1000 --truth truth.tsv >x.snd
delaynet --task apply --network a.net x.snd >out.tsv
is "each section has a row" "$(column section out.tsv | wc -l)" 50
got=$(awk -F '\t' '/^#/ || /^section/ { next } FNR == NR { for (i = 2; i < 5; i++) t[$1 - 1000, i] = $i; next }
	{ for (i = 2; i < 5; i++) s += ($i - t[$1, i]) ^ 2 } END { printf "%.6g", s / 150 }' truth.tsv out.tsv)
delaynet --task score --columns 40 --count 50 a.net >b.tsv
near "data and apply give the same score" "$got" "$(column ordered b.tsv | head -n 1)" 1e-6
delaynet --task apply --network a.net <x.snd >in.tsv
same "apply reads a pipe" in.tsv out.tsv
printf '# doubtful: cut off\ntime\tdiameter\n0.001\t1e-4\n' |
	sensorsim --duration 4ms --rate 10kHz - >cut.au 2>/dev/null
delaynet --task apply --network a.net cut.au >cut.tsv 2>err
is "a doubtful signal makes the delays doubtful" \
	"$? $(grep '^# doubtful' cut.tsv) $(grep -c 'cut.au: doubtful by its own account: cut off' err)" \
	"3 # doubtful: cut off 1"
is "data can be written in parts" "$(for f in 0 3; do delaynet --task data --columns 40 -f "$f" -c 3 | head -c -16 | tail -c 1920; done | cksum)" \
	"$(delaynet --task data --columns 40 -c 6 | head -c -16 | tail -c 3840 | cksum)"

# Auto-encoders.
delaynet --columns 40 --layers "8 6" --activation sigmoid --pretrain 20 --sparsity 4 --epochs 5 \
	--count 100 --stats stats.tsv >ae.net
is "pre-training is counted for two layers" "$(column epochs stats.tsv)" 45

delaynet --columns 30 --layers "4conv6x2 pool2x2 3conv3x1 pool2x1 16" --activation relu --count 100 \
	--epochs 3 --loss sums >cnn.net
delaynet --task score --columns 30 cnn.net >cnn.tsv
ok "two convolutions are scored" grep -q '^0	300	0\.' cnn.tsv

# A tiny network for arrivals of one or two pulses: it must say far more than the prior,
# delays within +-3 % of the duration, whose standard deviation is 0.0173.
arrivals="--model pulses --reach 0.03:0.03 --snr 30:30"
# shellcheck disable=SC2086
{
	delaynet $arrivals --fresh --layers "8conv13x1/4 12conv5x1/2 32" --activation relu \
		--count 1000 --epochs 20 --learning-rate 4e-3 --learning-rate-end 1e-4 >tiny.net
	delaynet --task score $arrivals tiny.net >tiny.tsv
}
is "counts of one to four pulses are scored" "$(column sources tiny.tsv | tr '\n' ' ')" "1 2 3 4 "
got=$(column delay_rmse tiny.tsv | head -n 1)
ok "a small trained network has an error of delay of $got durations, below 0.0173 of the prior" \
	awk -v g="$got" 'BEGIN { exit !(g < 0.01) }'
got=$(column size_rmse tiny.tsv | head -n 1)
ok "a small trained network has an error of size of $got" awk -v g="$got" 'BEGIN { exit !(g < 0.1) }'
fails "arrivals for delays" 1 "want a network for delays, got one for arrivals" \
	delaynet --task score tiny.net
fails "delays for arrivals" 1 "want a network for arrivals, got one for delays" \
	delaynet --task score --model pulses a.net
edited 's/^purpose arrivals/purpose delays/' tiny.net >lying.net
fails "layers of arrivals for delays" 1 "lying.net: inputs of 2 x 1 x 128 and 34 outputs do not suit delays" \
	delaynet --task score lying.net
edited 's/^purpose delays/purpose arrivals/' a.net >lying.net
fails "layers of delays for arrivals" 1 "lying.net: inputs of 1 x 2 x 40 and 3 outputs do not suit arrivals" \
	delaynet --task score --model pulses lying.net
fails "five pulses" 2 "at most 4" delaynet --model pulses --sources 5
fails "apply of arrivals without sections" 2 "requires --sections" delaynet --task apply --model pulses --network tiny.net

fails "an unknown kind of layer" 2 "--layers: '5x' is no layer" delaynet --layers 5x
fails "too many operands" 2 "has no input" delaynet a.net
fails "apply without a network" 2 "requires --network" delaynet --task apply x.snd
fails "a missing network" 1 "no.net: No such file" delaynet --task score no.net
fails "a signal for a network" 1 "x.snd: line 1:" delaynet --task score x.snd
head -c 3000 a.net >cut.net
fails "a network cut short" 1 "cut.net: line [0-9]*: ends early" delaynet --task score cut.net
edited '' a.net >whole.net
same "the checksum is the CRC-32 of the lines before it" whole.net a.net
sed '8s/1/2/' a.net >bad.net
fails "a weight that was altered" 1 "bad.net: line [0-9]*: want 'end crc32 [0-9a-f]*', got 'end crc32 [0-9a-f]*': damaged or edited" \
	delaynet --task score --columns 40 bad.net
sed 's/^# cmd: delay/# cmd: decay/' a.net >bad.net
fails "a comment that was altered" 1 "damaged or edited" delaynet --task score --columns 40 bad.net
sed 's/^end .*/end/' a.net >bad.net
fails "a network without its checksum" 1 "damaged or edited" delaynet --task score --columns 40 bad.net
sed 's/^input 1 2 40/input 1 2 41/' a.net >bad.net
fails "weights that do not suit" 1 "bad.net: line 6: the layers have" delaynet --task score bad.net
sed '8s/^[^ ]*/nan/' a.net >bad.net
fails "a weight that is no number" 1 "bad.net: line 8: weight" delaynet --task score bad.net
fails "a network for another number of points" 1 "40 points and 3 delays, but" delaynet --task score a.net
head -c 4000 x.snd >cut.snd
fails "half a section" 1 "cut.snd: section 6: want 40 frames" \
	delaynet --task apply --network a.net cut.snd
fails "a step too long" 1 "the training diverged" \
	delaynet --columns 40 --optimiser descent --learning-rate 900 --activation linear
fails "sparsity without sigmoid" 2 "--sparsity requires" delaynet --pretrain 1 --sparsity 4
fails "convolutions are no auto-encoders" 2 "only dense" delaynet --layers 2conv3x1 --pretrain 1
fails "an empty range" 2 "--gain: want A:B" delaynet --gain 1:0.5
done_testing

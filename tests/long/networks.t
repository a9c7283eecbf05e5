#!/bin/sh
# The shipped network's own command, cut to a thirtieth, and what the loss (3-20) leaves of a
# network that sees nothing.
. "$(dirname "$0")/../tap.sh"


"$top/scripts/arrivals-network" --epochs 20 >short.net
is "the trained network has the layers of the shipped one" "$(grep -a '^layers' short.net)" \
	"$(grep '^layers' "$top/share/arrivals.net")"
known="--task score --model pulses --snr 30:30 --reach 0.015:0.015 --amplitude 0.5:1.5 --gain 0.909:0.909 --count 500"
# shellcheck disable=SC2086
for net in short.net "$top/share/arrivals.net"; do
	delaynet $known "$net" >"$(basename "$net").tsv"
done
# Prior: 0.015 / sqrt 3 = 0.0087 durations.
at_most "a network trained on 2e5 sections has the delay of one pulse" "$(column delay_rmse short.net.tsv | sed -n 1p)" 0.004
at_most "a network trained on 2e5 sections has the delays of two pulses" "$(column delay_rmse short.net.tsv | sed -n 2p)" 0.006
at_most "the shipped network has the delay of one pulse" "$(column delay_rmse arrivals.net.tsv | sed -n 1p)" 0.002
at_most "the shipped network has the delays of two pulses" "$(column delay_rmse arrivals.net.tsv | sed -n 2p)" 0.003

# Trained on (3-20) without anything to see: the outputs are constants of sum 3/2 and of the
# mean variance of three labels, (1 - 1/3) / 12 = 1/18, in any order: 1/12 + 1/18 = 5/36.
delaynet --columns 20 --amplitude 0:0 --loss sums --layers 8 --epochs 400 >blind.net
delaynet --task score --columns 20 --amplitude 0:0 --count 10000 blind.net >blind.tsv
near "a network without input has the loss 5/36 of (3-20)" "$(column ordered blind.tsv | head -n 1)" 0.1389 0.004
done_testing

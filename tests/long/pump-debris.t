#!/bin/sh
# The pump whose own debris wears it faster: nothing is lost, and the filter helps
. "$(dirname "$0")/../tap.sh"

ok "the example runs" make -s -C "$top/examples/pump-debris" table OUT="$work/pump"
cd "$work/pump/seed-1" || exit
c=$(sed -n 's/^# dirt: \([^ ]*\).*/\1/p' feedback.tsv)
# OIL = 0.05 m3
near "without a filter the oil holds all that wore off" \
	"$(tail -n 1 feedback.tsv | awk -v c="$c" '{ printf "%.9f", $3 * c * 0.05 / $2 }')" 1 1e-5
near "without feedback the wear is even: 1e-8 m3 at 2e-12 m3/h" "$(column life numbers.tsv | head -n 1)" 5000 1
life() {
	awk -v c="$1" '$1 == c { print $2 }' numbers.tsv
}
rising "its own debris shortens the life, a filter gives some of it back" \
	"$(life feedback)" "$(life filtered)" "$(life alone)"
# dw/dt = w0 exp(g t) from the first hour on: w = w0 (exp(g t) - 1) / g
near "dirt and wear grow as the balance of the oil predicts" "$(awk -v g="$(sed -n 's/^# growth: \([^ ]*\).*/\1/p' feedback.tsv)" \
	'/^400\t/ { printf "%.6f", $2 / (2e-12 * (exp(g * 400) - 1) / g) }' feedback.tsv)" 1 1e-4
done_testing

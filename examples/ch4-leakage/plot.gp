# Figures 54 to 60 of chapter 4; hours and L/min
set terminal pngcairo size 1000,560 font "sans,12"
set border 3; set tics nomirror; set key top left noautotitle
set xlabel "time, h"; set ylabel "return oil flow, L/min"
set datafile separator "\t"
grey = "#888888"; blue = "#2b3a67"; red = "#b23a48"; gold = "#c98a1b"

set output "fig50.png"
set title "Figure 50: return oil flow of three synthetic pumps"
plot for [k=1:3] sprintf("pump-%d.tsv", k) using "t":"y" with lines title sprintf("pump %d", k)

set output "fig51.png"
set title "Figure 51: four points, and how models of first and second order go on"
set xlabel "step"; set ylabel "state"; set xrange [-0.5:4.5]
plot "sketch.tsv" using "t":"y" with linespoints pt 7 lc rgb grey title "so far", \
	"sketch-ahead.tsv" using "t":"first" with linespoints pt 6 lc rgb red title "first order", \
	"sketch-ahead.tsv" using "t":"second" with linespoints pt 6 lc rgb blue title "second order"
set xlabel "time, h"; set ylabel "return oil flow, L/min"; set xrange [*:*]

set output "fig54.png"
set title "Figure 54: return oil flow of the synthetic pump"
plot flow using "t":"y" with lines lc rgb blue, limit with lines dt 2 lc rgb red title "failure"

set output "fig55.png"
set title "Figure 55: one step ahead"
set xrange [0:train]; set yrange [1.2:2.6]
plot flow using "t":"y" with points pt 7 ps 0.3 lc rgb grey title "observed", \
	"rule-insample.tsv" using "t":"grey" with lines lc rgb red title "grey model", \
	"rule-insample.tsv" using "t":"prediction" with lines lc rgb blue title "filter"

set output "fig56.png"
set title "Figure 56: mean square error so far"
set ylabel "(L/min)^2"; set yrange [0:0.03]; set key top right
plot "errors-insample.tsv" using "t":"grey" with lines lc rgb red title "grey model, order by fit", \
	"errors-insample.tsv" using "t":"filter" with lines lc rgb blue title "filter, order by fit", \
	"errors-window.tsv" using "t":"filter" with lines dt 2 lc rgb blue title "filter, order by a window of errors"

set output "fig57.png"
set title "Figure 57: order of the model"
set ylabel "order"; set yrange [0:62]
plot "rule-insample.tsv" using "t":"order" with steps lc rgb blue title "by fit", \
	"rule-window.tsv" using "t":"order" with steps lc rgb gold title "by a window of errors"

# Life predicted at the end of the training: level and growth rate of a grey model are
# one exponential through the present state and the limit at the end predicted.
rul(file) = real(system(sprintf("awk -F '\t' '!/^#/ { if (!k) { for (i = 1; i <= NF; i++) { if ($i == \"rul_q50\") k = i; if ($i == \"state\") s = i } } else if ($1 == %d) print $k }' %s", train, file)))
state(file) = real(system(sprintf("awk -F '\t' '!/^#/ { if (!s) { for (i = 1; i <= NF; i++) if ($i == \"state\") s = i } else if ($1 == %d) print $s }' %s", train, file)))
raw = real(system(sprintf("awk -F '\t' '!/^#/ && $1 == %d { print $NF / 3600 }' grey.tsv", 3600 * train)))
future(t, level, life) = t < train ? NaN : level * exp(log(limit / level) * (t - train) / life)
set xrange [0:*]; set yrange [1.2:3]; set ylabel "return oil flow, L/min"; set key top left
set arrow 1 from train, graph 0 to train, graph 1 nohead dt 3
set arrow 2 from eol, graph 0 to eol, graph 1 nohead lc rgb red
set samples 500
set output "fig58.png"
set title "Figure 58: from the first 600 points to failure"
l1 = state("rule-insample.tsv"); r1 = rul("rule-insample.tsv"); ra = rul("average.tsv")
plot flow using "t":"y" with points pt 7 ps 0.2 lc rgb grey title "observed", \
	limit with lines dt 2 lc rgb red, \
	future(x, l1, raw) lw 2 lc rgb red title sprintf("grey model: %.0f h", train + raw), \
	future(x, l1, r1) lw 2 lc rgb blue title sprintf("filter and grey model: %.0f h", train + r1), \
	future(x, l1, ra) lw 2 lc rgb gold title sprintf("filter, models averaged: %.0f h", train + ra)

set output "fig59.png"
set title "Figure 59: filters of fixed order, grey model ahead"
l7 = state("order-7.tsv"); r7 = rul("order-7.tsv"); l20 = state("order-20.tsv"); r20 = rul("order-20.tsv")
plot flow using "t":"y" with points pt 7 ps 0.2 lc rgb grey title "observed", \
	limit with lines dt 2 lc rgb red, \
	future(x, l7, r7) lw 2 lc rgb gold title sprintf("order 7: %.0f h", train + r7), \
	future(x, l20, r20) lw 2 lc rgb blue title sprintf("order 20: %.0f h", train + r20)
unset arrow

set output "fig60.png"
set title sprintf("Figure 60: mean square error at hour %d by order", train)
set xrange [5:62]; set yrange [0.003:0.012]; set xlabel "order"; set ylabel "(L/min)^2"; set key top right
plot "orders.tsv" using "order":"grey" with linespoints pt 7 ps 0.5 lc rgb red title "rolling grey model", \
	"orders.tsv" using "order":"filter" with linespoints pt 7 ps 0.5 lc rgb blue title "filter", \
	"-" using 1:2 with points pt 4 ps 2 lc rgb "black" title "thesis"
7	0.0091
20	0.0060
30	0.0055
e

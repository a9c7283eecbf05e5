# Figures 27 and 28, and error against seconds of training, one point per network
set terminal pngcairo size 900,600
set datafile separator "\t"
set output "fig27.png"
set title "Figure 27: error of a network of 10 units by epoch"
set xlabel "epoch"; set ylabel "mean squared error"; set logscale x
plot "curve.tsv" using "epochs":"error" with linespoints pt 7 lw 2 notitle, 1./12 with lines dt 2 title "constant, 1/12"
unset logscale
set output "fig28.png"
set title "Figure 28: errors of its delays, 300 samples"
set xlabel "error of a delay"; set ylabel "delays"; set style fill solid 0.5; set boxwidth 0.045
bin(x) = 0.05 * floor(x / 0.05) + 0.025
plot "errors-0.tsv" using (bin(column("error"))):(1) smooth frequency with boxes notitle
unset title
set output "fig-seconds.png"
set datafile commentschars "#"
set logscale xy
set yrange [0.03:0.4]
set xlabel "seconds of training"
set ylabel "mean squared error of the delays, samples without noise"
set key outside reverse Left
set arrow from graph 0, first 1./12 to graph 1, first 1./12 nohead dashtype 2
set arrow from graph 0, first 1./24 to graph 1, first 1./24 nohead dashtype 2
set label "constant, 1/12" at graph 0.02, first 1./12 offset 0, 0.5
set label "sorted constants, 1/24" at graph 0.02, first 1./24 offset 0, -0.6
family = "feed-forward cascade-forward auto-encoder sparse convolutional"
seconds(t) = column("table") == t ? column("seconds") : NaN
plot for [t = 2:6] "tables.tsv" using (seconds(t)):"ordered" \
		with points pointtype 7 linecolor t title word(family, t - 1)." in order", \
	for [t = 2:6] "tables.tsv" using (seconds(t)):"unordered" \
		with points pointtype 6 linecolor t title word(family, t - 1)." best order"

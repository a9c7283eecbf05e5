# Error against seconds of training, one point per network: gnuplot -c plot.gp TABLE PNG
set terminal pngcairo size 900,600
set output ARG2
set datafile separator "\t"
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
plot for [t = 2:6] ARG1 using (seconds(t)):"ordered" \
		with points pointtype 7 linecolor t title word(family, t - 1)." in order", \
	for [t = 2:6] ARG1 using (seconds(t)):"unordered" \
		with points pointtype 6 linecolor t title word(family, t - 1)." best order"

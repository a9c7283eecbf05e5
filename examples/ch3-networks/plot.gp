# Error against seconds of training, one point per structure: gnuplot -c plot.gp TABLE PNG
set terminal pngcairo size 900,600
set output ARG2
set datafile separator "\t"
set datafile commentschars "#"
set logscale xy
set xlabel "seconds of training"
set ylabel "mean squared error of the delays, samples without noise"
set key outside
set arrow from graph 0, first 1./12 to graph 1, first 1./12 nohead dashtype 2
set arrow from graph 0, first 1./24 to graph 1, first 1./24 nohead dashtype 2
set label "constant, 1/12" at graph 0.02, first 1./12 offset 0, 0.5
set label "sorted constants, 1/24" at graph 0.02, first 1./24 offset 0, 0.5
family = "feed-forward cascade-forward auto-encoder sparse convolutional"
plot for [t=2:6] ARG1 using (column("table") == t ? column("seconds") : NaN):"ordered" \
		with points pointtype t + 3 title word(family, t - 1)." ordered", \
	for [t=2:6] ARG1 using (column("table") == t ? column("seconds") : NaN):"unordered" \
		with points pointtype t + 3 linecolor t title word(family, t - 1)." best order"

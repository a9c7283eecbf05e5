# One picture for each tool beyond the thesis, from the tables of the Makefile
set datafile separator "\t"
set datafile commentschars "#"
set key autotitle columnhead
set terminal pngcairo size 900,450 font "sans,12"
set grid

set output "fig-layout.png"
set title "layout: two coils, 100 particles a second, 30 dB"
set xlabel "distance, cm"
set ylabel "standard error of the velocity, m/s"
set ytics nomirror
set y2label "probability that a pulse is paired without doubt"
set y2tics
set logscale y
set key center right
set arrow from 25, graph 0 to 25, graph 1 nohead dt 2 lc rgb "#999999"
set label "thesis" at 25.5, graph 0.05 tc rgb "#666666"
plot "layout.tsv" using (column("extent") * 100):"se_velocity" with lines lw 2 title "standard error", \
	"" using (column("extent") * 100):"p_unique" axes x1y2 with lines lw 2 title "paired without doubt"
unset arrow; unset label; unset title; unset y2label; unset y2tics; unset logscale; set ytics mirror; set key top left

set output "fig-materials.png"
set multiplot layout 1, 2 title "sensorsim: spheres in a field of 100 kHz"
set logscale xy
set format "10^{%T}"
set xlabel "diameter, m"
set ylabel "amplitude, V"
plot for [m in materials] "material-".m.".tsv" using "diameter":(sqrt(column("amplitude") ** 2 + column("quadrature") ** 2)) with lines lw 2 title m
unset logscale y
set format y "%g"
set ylabel "phase, degrees"
set key at graph 0.4, 0.8
plot for [m in materials] "material-".m.".tsv" using "diameter":(column("phase") * 180 / pi) with lines lw 2 title m
unset multiplot
unset logscale; set format "%g"; set key default

set output "fig-debriscount.png"
set title "debriscount: particles per hour, four hours at a time"
set xlabel "time, h"
set ylabel "particles per hour"
set key top left
plot "trend-1.tsv" using (column("begin") / 3600 + 2):"per_hour":"per_hour_low":"per_hour_high" with yerrorbars pt 7 title "counted, 95 %", \
	20 + 0.8 * x with lines lc rgb "#999999" title "put in", \
	80 with lines dt 2 lc rgb "#b23a48" title "alarm", 60 with lines dt 3 lc rgb "#b23a48" title "cleared"

set output "fig-abrade.png"
set title "abrade: ISO 4406 18/16/13 in gaps of 100 cm^2, bodies of 2 and 6 GPa"
set xlabel "gap, um"
set ylabel "depth of the harder body per length slid"
set format y "%.1e"
set xrange [0:32]
set key bottom right
plot for [g in gaps] "abrade-".g.".tsv" using (g + 0):"depth_rate2" with points pt 7 ps 0.6 lc rgb "#0072b2" notitle, \
	for [g in gaps] "abrade-".g.".tsv" every ::0::0 using (g + 0):"mean_depth_rate2" with points pt 2 ps 1.5 lc rgb "#b23a48" notitle, \
	NaN with points pt 7 lc rgb "#0072b2" title "particles drawn", NaN with points pt 2 lc rgb "#b23a48" title "mean of the code"

set terminal pngcairo size 700,600 font "sans,12"
set output "fig-volumes.png"
set logscale xy
set format "10^{%T}"
set xlabel "volume by the full model, m^3"
set ylabel "estimate and its 90 % interval, m^3"
set key top left
set grid
plot x with lines lc rgb "#999999" title "equal", \
	"volumes.tsv" using 2:3:4:5 with yerrorbars pt 7 ps 0.6 lc rgb "#0072b2" title "a surface"

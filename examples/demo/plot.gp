# Pictures of the demo; side is the length of the area in um
set terminal pngcairo size 900,600 font "sans,14"
set style line 1 lc rgb "#1f77b4" lw 2
set style line 2 lc rgb "#d62728" lw 2
set style line 3 lc rgb "#7f7f7f" lw 1
set style line 4 lc rgb "#2ca02c" lw 2
set border 3; set tics nomirror; set key noautotitle

set output "surface.png"
stats "height.txt" matrix nooutput
n = STATS_size_x
unset border; unset tics
set xlabel "x"; set ylabel "y"; set colorbox; set cblabel "height, um"
set palette defined (0 "#2b3a67", 0.5 "#e8e1d3", 1 "#b23a48")
set view 60, 35; set hidden3d
set pm3d; set ztics
splot "height.txt" matrix using ($1/n*side):($2/n*side):($3*1e6) with pm3d

set output "pressure.png"
unset pm3d; unset hidden3d
set border; set tics out nomirror
set size ratio -1
set xlabel "x, um"; set ylabel "y, um"; set cblabel "pressure, GPa"
set xrange [0:side]; set yrange [0:*]
set palette defined (0 "#ffffff", 0.05 "#fee0d2", 0.5 "#ef3b2c", 1 "#67000d")
plot "pressure.txt" matrix using (($1+0.5)/n*side):(($2+0.5)/n*side):($3/1e9) with image
set size noratio; unset colorbox; set xrange [*:*]; set yrange [*:*]

set border 3
set output "particles.png"
set logscale xy; set xlabel "diameter, um"; set ylabel "particles at least that large"
set key top right
plot "made.txt" using 1:2 with lines ls 1 title "torn off", \
     "found.txt" using 1:2 with lines ls 2 title "found by the sensors"
unset logscale

# A piece of the record of 0.12 s from begin on; the *_at are where it lies in the streams.
set output "signal.png"
last = 1199
set xlabel "time, s"; set ylabel "V"
set xrange [begin:begin+0.12]; set key top right
stats "raw.au" binary skip=raw_at format="%double%double" endian=big every ::0::last \
	using 1 nooutput
peak = abs(STATS_min) > STATS_max ? -STATS_min : STATS_max
set yrange [-1.1*peak:1.1*peak]
set ytics (sprintf("%.2g", -peak) -peak, "0" 0, sprintf("%.2g", peak) peak)
set multiplot layout 3,1 margins 0.1,0.97,0.1,0.97 spacing 0.09
unset xlabel
plot "raw.au" binary skip=raw_at format="%double%double" endian=big every ::0::last \
	using (begin + $0/rate):1 with lines ls 3 title "as measured"
plot "band.au" binary skip=band_at format="%double%double" endian=big every ::0::last \
	using (begin + $0/rate):1 with lines ls 1 title "band-passed"
set xlabel "time, s"
plot for [k=1:8] "pulses.au" binary skip=pulses_at \
	format="%double%double%double%double%double%double%double%double" endian=big every ::0::last \
	using (begin + $0/rate):k with lines lw 2 lc k title k == 1 ? "separated" : ""
unset multiplot
set xrange [*:*]; set yrange [*:*]; unset tics; set tics nomirror

set output "state.png"
set xlabel "time, h"; set ylabel "volume worn off, 10^6 um^3"
set key bottom right
plot "state.tsv" using (column("t")/3600):(column("y")*1e12) with points pt 7 ps 0.7 lc rgb "#7f7f7f" title "observed", \
     "" using (column("t")/3600):(column("state")*1e12) with lines ls 1 title "filtered"

set output "life.png"
set ylabel "remaining wear life, h"
set key top right
plot "life.tsv" using (column("t")/3600):(column("q05")/3600):(column("q95")/3600) with filledcurves lc rgb "#c6dbef" title "90 % band", \
     "" using (column("t")/3600):(column("q50")/3600) with lines ls 1 title "median"

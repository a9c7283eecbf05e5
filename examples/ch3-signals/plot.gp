# Figures 34 to 38 of chapter 3; seconds, volts and hertz
set terminal pngcairo size 1100,640 font "sans,11"
set border 3; set tics nomirror; set key top right noautotitle
blue = "#2b3a67"; red = "#b23a48"; grey = "#888888"

# AU: the header says how long it is
header(file) = int(system(sprintf("od -An -tu1 -j6 -N2 %s | awk '{ print $1 * 256 + $2 }'", file)))
signal(file, channel) = sprintf("'%s' binary skip=%d format='%s' endian=big using (column(0) / 1e4):1", \
	file, header(file), channel == 1 ? "%double%*double" : "%*double%double")

group(n, g, what, from, to) = sprintf( \
	"set output 'fig%d.png'; set multiplot layout 2,2 title 'Figure %d: %s';", n, n, what) . \
	sprintf("set xrange [%g:%g]; set xlabel 'time, s'; set ylabel 'sensor 1, V'; plot ", from, to) . \
	signal(sprintf("group-%d.au", g), 1) . " with lines lc rgb blue;" . \
	"unset xrange; set xrange [0:5000]; set xlabel 'frequency, Hz'; set ylabel 'V'; plot " . \
	sprintf("'spectrum-%d-1.tsv' using 'frequency':'amplitude' with lines lc rgb red;", g) . \
	sprintf("set xrange [%g:%g]; set xlabel 'time, s'; set ylabel 'sensor 2, V'; plot ", from, to) . \
	signal(sprintf("group-%d.au", g), 2) . " with lines lc rgb blue;" . \
	"set xrange [0:5000]; set xlabel 'frequency, Hz'; set ylabel 'V'; plot " . \
	sprintf("'spectrum-%d-2.tsv' using 'frequency':'amplitude' with lines lc rgb red;", g) . \
	"unset multiplot"

eval group(34, 1, "pump off", 1, 1.2)
eval group(35, 2, "pump on, no debris", 1, 1.2)
eval group(36, 7, "pump on, 1 g of coarse debris", 13, 13.2)

set output "fig37.png"
set title "Figure 37: order 200, Hamming, 70-130 Hz: too few to stop the mains"
set xrange [0:500]; set yrange [-80:5]; set xlabel "frequency, Hz"; set ylabel "dB"
set for [f in "50 150 250"] arrow from f, graph 0 to f, graph 1 nohead dt 3 lc rgb grey
plot "response.tsv" using "frequency":"level" with lines lc rgb blue lw 2
unset arrow; unset title

set output "fig38.png"
set multiplot layout 2,1 title "Figure 38: filtered signals of group 7"
set xrange [10:20]; set yrange [*:*]; set xlabel "time, s"
set ylabel "sensor 1, V"
eval "plot " . signal("filtered-7.au", 1) . " with lines lc rgb blue"
set ylabel "sensor 2, V"
eval "plot " . signal("filtered-7.au", 2) . " with lines lc rgb blue"
unset multiplot

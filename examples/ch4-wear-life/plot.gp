# Figures 64 to 68 of chapter 4
set terminal pngcairo size 1000,560 font "sans,12"
set border 3; set tics nomirror; set key top right noautotitle
set datafile separator "\t"
grey = "#888888"; blue = "#2b3a67"; red = "#b23a48"; gold = "#c98a1b"

set output "fig64.png"
set title "Figure 64 (a): wear of fragments of 100 um by step"
set xlabel "fragment and step"; set ylabel "volume, um^3"; set logscale y; set yrange [0.1:3e4]; set format y "10^{%T}"
plot for [p in "21 5 1 0.15"] p.".steps" using 0:(column("volume")*1e18) with points pt 7 ps 0.5 title p." MPa"
unset logscale y; set format y "%g"; set yrange [0:*]

set output "fig64-distribution.png"
set title "Figure 64 (b): distribution of the wear of a step"
set xlabel "volume, um^3"; set ylabel "share of the steps, %"; set format x "10^{%g}"
set boxwidth 0.09; set style fill solid 0.5 noborder
# classes of a tenth of a decade; steps without wear are in none
classes(p) = sprintf("< awk -F '\t' '/^#/ { next } !/^[-0-9]/ { for (i = 1; i <= NF; i++) if ($i == \"volume\") k = i; next } { n++ } $k > 0 { c[int(10 * (log($k) / log(10) + 18) + 1000) - 1000]++ } END { for (x in c) print (x + 0.5) / 10 \"\t\" 100 * c[x] / n }' %s.steps | sort -g", p)
plot for [p in "21 0.15"] classes(p) using 1:2 with boxes lc rgb (p eq "21" ? blue : gold) title p." MPa"
set format x "%g"

set output "fig65.png"
set title "Figure 65: wear of the plate per step"
set xlabel "volume, mm^3"; set ylabel "paths"; set boxwidth 0.9 relative; set style fill solid 0.5 noborder
stats "rates.tsv" using (column("mean")*1e9) name "W" nooutput
bin = (W_max - W_min) / 40.0
plot "rates.tsv" using (bin*(floor(column("mean")*1e9/bin)+0.5)):(1) smooth frequency with boxes lc rgb blue \
	title "every class as one fragment", \
	"independent-rates.tsv" using (bin*(floor(column("mean")*1e9/bin)+0.5)):(1) smooth frequency with boxes lc rgb gold \
	title "fragments independent"

h = 1.0 / 3600
set xlabel "time, h"; set ylabel "remaining wear life, h"; set xrange [0:eol]; set yrange [0:2.2*eol]
truth(t) = eol - t
set output "fig67a.png"
set title "Figure 67 (a): samples of the remaining wear life"
plot "samples.tsv" using (column("t")*h):(column("rwl")*h) with points pt 7 ps 0.2 lc rgb grey title "paths", \
	truth(x) lw 2 lc rgb red title "truth"
set output "fig67b.png"
set title "Figure 67 (b): mean and 90 % interval"
band = "life.tsv"
plot band using (column("t")*h):(column("q05")*h):(column("q95")*h) with filledcurves lc rgb "#c5cbe0" title "90 %", \
	band using (column("t")*h):(column("mean")*h) with lines lw 2 lc rgb blue title "mean", \
	"independent.tsv" using (column("t")*h):(column("q05")*h):(column("q95")*h) with filledcurves lc rgb "#e6c48d" \
	title "90 %, fragments independent", \
	truth(x) lw 2 lc rgb red title "truth"
set output "fig68.png"
set title "Figure 68: fragments, filters, dry bound and grey model"
plot band using (column("t")*h):(column("q05")*h):(column("q95")*h) with filledcurves lc rgb "#c5cbe0" title "fragments, 90 %", \
	band using (column("t")*h):(column("q50")*h) with lines lw 2 lc rgb blue title "fragments, median", \
	band using (column("t")*h):(column("archard")*h) with lines lc rgb "black" title "dry bound", \
	band using (column("t")*h):(column("grey")*h) with lines lc rgb gold title "grey model", \
	"filter.tsv" using (column("t")*h):(column("q50")*h) with lines lc rgb "#3a8f5c" title "fragments and filters, median", \
	truth(x) lw 2 lc rgb red title "truth"

# Figure 66: dry sliding by Archard's law, the volume of the plate by the hour
set output "fig66.png"
set title "Figure 66 (b): volume of the plate, dry and by the fragments"
set xlabel "time, h"; set ylabel "volume, mm^3"; set xrange [0:eol]; set yrange [0:*]; set key top left
k = real(system("sed -n 's/^# archard: //p' life.tsv"))
force = 2346.3e-6 * (0.45 * 21.15e6 + 0.1 * 10.575e6)
rate = real(system("awk -F '\t' '/^#/ { next } !/^[-0-9]/ { for (i = 1; i <= NF; i++) c[$i] = i; next } { s += $c[\"mean\"] / $c[\"step_time\"]; n++ } END { print s / n }' rates.tsv"))
plot k / 1.065e9 * force * 20.94 * x * 3600 * 1e9 lw 2 lc rgb "black" title sprintf("Archard, K = %.1e", k), \
	rate * x * 3600 * 1e9 lw 2 lc rgb blue title "fragments, mean"
set output "fig64-field.png"
set title "Pressure of the valve plate by angle, and the thesis' two halves"
set xlabel "angle, degrees"; set ylabel "pressure, MPa"; set xrange [0:360]
plot "field.tsv" using "angle":"pressure" with lines lw 2 lc rgb blue title "field", \
	(x < 180 ? 21 : 0.15) with steps dt 2 lc rgb grey title "two halves"

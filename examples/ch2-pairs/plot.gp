# Figures 11, 13, 14 and 16 to 19 of chapter 2; pairs is set by the Makefile
set terminal pngcairo size 900,600 font "sans,13"
set border 3; set tics nomirror; set key top left noautotitle
set datafile commentschars "#"
set xlabel "step"; set xtics 1
blue = "#1f77b4"; red = "#d62728"; grey = "#7f7f7f"
hundred = 100.0 / pairs
set style fill solid 0.3

set output "fig11.png"
set title "Figure 11: roughness over that before wear, first pair"
set ylabel "relative roughness"; set key bottom left
first(y) = column("realisation") == 0 ? column(y) : NaN
plot "column.50N.steps" using (first("step")):(first("relative_roughness")) with linespoints lw 2 pt 7 title "column rule (2-12)", \
     "whole.50N.steps" using (first("step")):(first("relative_roughness")) with linespoints lw 2 pt 5 title "whole set (2-11)", \
     "column-hard.50N.steps" using (first("step")):(first("relative_roughness")) with linespoints lw 2 pt 9 title "column rule, hardness 3 yield", \
     1.0015 with lines dt 2 lc rgb grey title "thesis: settles at 1.0015"
set key top left

set output "fig13.png"
set title "Figure 13: wear volume, mean and standard deviation of the pairs"
set ylabel "cumulative volume, 10^{-12} m^3"; set yrange [0:*]
first = real(system("awk -F '\t' '$1 == 1 { print $6 * 1e12 }' 50N.bystep"))
plot "50N.bystep" using "step":(column("cumulative_volume")*1e12):(column("cumulative_volume_sd")*1e12) \
		with yerrorlines lw 2 lc rgb blue title "50 N", \
     "100N.bystep" using "step":(column("cumulative_volume")*1e12):(column("cumulative_volume_sd")*1e12) \
		with yerrorlines lw 2 lc rgb red title "100 N", \
     0.72*first*x with lines lw 2 lc rgb grey title "Archard's law from step 1, distance times 0.72", \
     2.135*x with lines dt 2 lc rgb blue title "thesis at 50 N over 100", \
     3.6107*x with lines dt 2 lc rgb red title "thesis at 100 N over 100"
set output "fig13-late.png"
set title "Figure 13 gone on to step 30: each pair at 50 N"
set xtics 5
plot "late.lines" using 1:($2*1e12) with lines lc rgb blue
set xtics 1

set output "fig14.png"
set title "Figure 14: real contact area, mean and standard deviation of the pairs"
set ylabel "cells in contact, %"; set yrange [0:*]
plot "50N.contact" using "step":(column("mean")*100):(column("sd")*100) with yerrorlines lw 2 lc rgb blue title "50 N", \
     "100N.contact" using "step":(column("mean")*100):(column("sd")*100) with yerrorlines lw 2 lc rgb red title "100 N"

set output "fig16.png"
set title "Figure 16: wear particles of 100 pairs at 50 N"
set ylabel "particles"
plot "50N.bystep" using "step":(column("particles")*100) with linespoints lw 2 pt 7 lc rgb blue title "of each step", \
     "50N.bystep" using "step":(column("cumulative_particles")*hundred) with linespoints lw 2 pt 5 lc rgb red title "of all steps so far", \
     (x >= 1.47 ? 41.29*x**1.383 - 70.29 : NaN) with lines dt 2 lw 2 lc rgb grey title "thesis (2-16)"

set output "fig17.png"
set title "Figure 17: sizes of all particles at 50 N"
set xlabel "equivalent diameter, um"; set ylabel "density, 1/um"; set xtics auto; set key top right
thesis(x) = 2.718/200.698*(x/200.698)**1.718*exp(-(x/200.698)**2.718)
set xrange [0:400]; set samples 400
middle = "(0.5e6*(column(\"low\")+column(\"high\")))"
plot "50N.sizes" using @middle:(column("density")*1e-6):(10) with boxes lc rgb blue title "ours", \
     "" using @middle:(column("weibull")*1e-6) with lines lw 2 lc rgb red title "Weibull fit", \
     thesis(x) with lines dt 2 lw 2 lc rgb grey title "thesis (2-17)"

set terminal pngcairo size 1400,700 font "sans,11"
set output "fig18.png"
unset xlabel; unset ylabel; unset key
set multiplot layout 2,4 title "Figure 18: sizes at 50 N, step by step, and Weibull fits (density in 1/um over um)"
do for [step = 2:9] {
	set title sprintf("step %d", step)
	plot sprintf("sizes.%d", step) using @middle:(column("density")*1e-6):(10) with boxes lc rgb blue, \
	     "" using @middle:(column("weibull")*1e-6) with lines lw 2 lc rgb red
}
unset multiplot

set output "fig19.png"
set multiplot layout 2,4 title "Figure 19: aspect ratios at 50 N, step by step (%)"
set xrange [*:*]; set yrange [0:100]; set boxwidth 0.9
set xtics rotate by -60
do for [step = 2:9] {
	set title sprintf("step %d", step)
	plot sprintf("aspects.%d", step) using (column("share")*100):xticlabels(sprintf("%g-%g", column("low"), column("high"))) \
		with boxes lc rgb blue
}
unset multiplot

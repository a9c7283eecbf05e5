# Figures 7 to 10 and 12 of chapter 2; heights and depths in um
set terminal pngcairo size 900,700 font "sans,13"
set border 3; set tics nomirror; set key noautotitle
side = 1000.0; n = 128
x(i) = (i + 0.5) / n * side

set output "fig07.png"
set title "Figure 7: the surface on its convex"
set palette defined (0 "#2b3a67", 0.5 "#e8e1d3", 1 "#b23a48")
set view 55, 35; set hidden3d; set ticslevel 0
set xlabel "x, um"; set ylabel "y, um"; set cblabel "height, um"
splot "before.txt" matrix using (x($1)):(x($2)):($3*1e6) with pm3d
unset hidden3d

set size ratio -1
set xrange [0:side]; set yrange [0:side]
set palette defined (0 "#ffffff", 0.02 "#fee0d2", 0.5 "#ef3b2c", 1 "#67000d")
set output "fig08.png"
set title "Figure 8: contact pressure of the first step"
set cblabel "pressure, GPa"
plot "pressure.txt" matrix using (x($1)):(x($2)):($3*1e-9) with image
set output "fig09.png"
set title "Figure 9: von Mises stress in the first layer, logarithmic"
set cblabel "von Mises stress over yield stress"
set logscale cb; set cbrange [0.01:*]
plot "mises.txt" matrix using (x($1)):(x($2)):($3/355e6) with image
unset logscale cb; set cbrange [*:*]

set terminal pngcairo size 1200,1200 font "sans,11"
unset xlabel; unset ylabel; unset cblabel; set xtics 250; set ytics 250
set output "fig10.png"
set palette defined (0 "#2b3a67", 0.5 "#e8e1d3", 1 "#b23a48")
set multiplot layout 3,3 title "Figure 10: the surface after steps 1 to 9, height in um"
do for [step = 1:9] {
	set title sprintf("step %d", step)
	plot sprintf("worn%d.txt", step) matrix using (x($1)):(x($2)):($3*1e6) with image
}
unset multiplot
set output "fig12.png"
set palette defined (0 "#ffffff", 0.01 "#dbe9f6", 1 "#08306b")
set multiplot layout 3,3 title "Figure 12: depth of what steps 1 to 9 took away, um"
do for [step = 1:9] {
	set title sprintf("step %d", step)
	plot sprintf("removed%d.txt", step) matrix using (x($1)):(x($2)):($3*1e6) with image
}
unset multiplot

set terminal pngcairo size 900,400
set output "fig-lives.png"
set key top left
set xlabel "time, h"
set multiplot layout 1,2
set ylabel "worn volume, mm^3"
plot for [c in "alone feedback filtered"] "seed-1/".c.".tsv" using 1:($2 * 1e9) with lines lw 2 title c, end * 1e9 with lines dt 2 lc "black" title "end of life"
set ylabel "debris in the oil over that of the code"
plot for [c in "alone feedback filtered"] "seed-1/".c.".tsv" using 1:3 with lines lw 2 title c
unset multiplot

# Figures 1 and 39 to 49 of chapter 3; milliseconds, volts, micrometres
set terminal pngcairo size 1100,640 font "sans,11"
set border 3; set tics nomirror; set key top right
blue = "#2b3a67"; red = "#b23a48"; grey = "#888888"

header(file) = int(system(sprintf("od -An -tu1 -j6 -N2 %s | awk '{ print $1 * 256 + $2 }'", file)))
skip8 = "%*double%*double%*double%*double%*double%*double%*double%*double"
skipped(k) = k > 1 ? substr(skip8, 1, 8 * (k - 1)) : ""
# Channel k of a stream; sensor 2 is moved ahead by 19.6 ms, as in the thesis.
channel(file, k, ahead) = sprintf("'%s' binary skip=%d format='%s%%double%s' endian=big using (column(0) / 10 - 600 - %g):1", \
	file, header(file), skipped(k), rest(file, k), ahead)
channels(file) = int(system(sprintf("od -An -tu1 -j23 -N1 %s", file)))
rest(file, k) = skipped(channels(file) - k + 1)

signals(s, n) = sprintf("set output 'fig%d.png'; set title 'Figure %d: section %s'; set xlabel 'time, ms'; set ylabel 'V'; set xrange [-10:25]; plot ", n, n, s) . \
	channel(s.".1.au", 1, 0) . " with lines lc rgb blue title 'sensor 1', " . \
	channel(s.".1.au", 2, 19.6) . " with lines lc rgb red title 'sensor 2, 19.6 ms ahead'"
sources(s, n, how, file, m) = sprintf("set output 'fig%d-%s.png'; set title 'Figure %d: section %s by %s'; set xlabel 'time, ms'; set ylabel 'V'; set xrange [-10:25]; plot for [k=1:%d] ", n, how, n, s, how, m) . \
	sprintf("'%s' binary skip=%d format='%%double%%double%%double%%double%%double%%double%%double%%double' endian=big using (column(0) / 10 - 600):(column(k)) with lines title sprintf('source %%d', k)", file, header(file))

set output "fig01.png"
set title "Figure 1: two pulses half a millisecond apart, and one"
set xlabel "time, ms"; set ylabel "V"; set xrange [90:112]
one(file) = sprintf("'%s' binary skip=%d format='%%double%%*double' endian=big using (column(0) / 10):1", file, header(file))
eval "plot " . one("sum.au") . " with lines lw 2 lc rgb red title 'both', " . one("one.au") . " with lines lw 2 lc rgb blue title 'the first alone'"

set output "fig39.png"
set title "Figure 39: sections a1 and a2 in their records, sensor 1"
set xrange [0:800]; set xlabel "time, ms"
set multiplot layout 2,1
do for [s in "a1 a2"] {
	set title "section ".s." at 600 ms"
	eval sprintf("plot '%s.1.au' binary skip=%d format='%%double%%*double' endian=big using (column(0) / 10):1 with lines lc rgb blue notitle", s, header(s.".1.au"))
}
unset multiplot

eval signals("a1", 40)
eval sources("a1", 42, "masks", "a1.1.masks.au", 2)
eval sources("a1", 42, "fit", "a1.1.fit.au", 2)
eval signals("a2", 43)
eval sources("a2", 45, "masks", "a2.1.masks3.au", 3)
eval sources("a2", 45, "fit", "a2.1.three.au", 3)
eval sources("a2", 47, "masks", "a2.1.masks4.au", 4)
eval sources("a2", 47, "fit", "a2.1.four.au", 4)
eval sources("a2", 48, "masks", "a2.1.masks.au", 4)
eval sources("a2", 48, "fit", "a2.1.fit.au", 4)

# The histogram of the section is that of the last one in the file; where three or four
# sources are asked for, its peaks are shared out among them.
set xrange [*:*]
set xlabel "delay beyond 19.635 ms, ms"; set ylabel "attenuation"; set zlabel "weight" rotate offset -3
set view 55, 30; set hidden3d; set border 31
do for [n in "41 44 46"] {
	s = n eq "41" ? "a1" : "a2"
	set output sprintf("fig%s.png", n)
	set title sprintf("Figure %s: weighted histogram of section %s", n, s)
	splot sprintf("< awk -F '\t' '/^[0-9]/ { if ($1 != s) { s = $1; n = 0 } line[n++] = $0 } END { for (i = 0; i < n; i++) { if (i %% 64 == 0 && i) print \"\"; print line[i] } }' %s.1.histogram.tsv", s) \
		using ($3 * 1e3):2:4 with lines lc rgb blue notitle
}
set border 3
set output "fig49.png"
set title "Figure 49: sizes without and with separation, 100 particles a second"
set xlabel "diameter, um (150: and above)"; set ylabel "per cent"
set style data histogram; set style fill solid 0.8; set yrange [0:*]; set xrange [*:*]
share(how) = sprintf("< awk -F '\t' '/^size[0-9]*_%s.100\t/ { c = $1; sub(/^size/, \"\", c); sub(/_.*/, \"\", c); print c \"\t\" $2 }' results.tsv | sort -n", how)
plot share("truth") using 2:xtic(1) title "truth" lc rgb grey, \
	share("counted") using 2 title "counted" lc rgb red, share("separated") using 2 title "separated" lc rgb blue
set output "fig49-density.png"
set title "Figure 49 by density: share above 150 um, where there is none"
set style data lines; set style fill empty
set xlabel "particles a second"; set ylabel "per cent above 150 um"
rate(how) = sprintf("< awk -F '\t' '/^above_%s/ { split($1, w, \".\"); print w[2] \"\t\" $2 }' results.tsv", how)
plot rate("counted") using 1:2 with linespoints pt 7 lw 2 lc rgb red title "counted", \
	rate("separated") using 1:2 with linespoints pt 7 lw 2 lc rgb blue title "separated", \
	17.9 with lines dt 2 lc rgb grey title "thesis: 17.9"

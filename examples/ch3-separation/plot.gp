# Figures 40 to 49 of chapter 3; milliseconds, volts, micrometres
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
	channel(s.".au", 1, 0) . " with lines lc rgb blue title 'sensor 1', " . \
	channel(s.".au", 2, 19.6) . " with lines lc rgb red title 'sensor 2, 19.6 ms ahead'"
sources(s, n, how, file, m) = sprintf("set output 'fig%d%s.png'; set title 'Figure %d: section %s by %s'; plot for [k=1:%d] ", n, how eq "masks" ? "" : "-fit", n, s, how, m) . \
	sprintf("'%s' binary skip=%d format='%%double%%double%%double%%double%%double%%double%%double%%double' endian=big using (column(0) / 10 - 600):(column(k)) with lines title sprintf('source %%d', k)", file, header(file))

eval signals("a1", 40)
eval sources("a1", 42, "masks", "a1.masks.au", 2)
eval sources("a1", 42, "fit", "a1.fit.au", 2)
eval signals("a2", 43)
eval sources("a2", 48, "masks", "a2.masks.au", 4)
eval sources("a2", 48, "fit", "a2.fit.au", 4)

# The histogram of the section is that of the last one in the file.
set xrange [*:*]
set xlabel "delay beyond 19.635 ms, ms"; set ylabel "attenuation"; set zlabel "weight" rotate
set view 55, 30; set hidden3d; set border 31
do for [s in "a1 a2"] {
	n = s eq "a1" ? 41 : 46
	set output sprintf("fig%d.png", n)
	set title sprintf("Figure %d: weighted histogram of section %s", n, s)
	splot sprintf("< awk -F '\t' '/^[0-9]/ { if ($1 != s) { s = $1; n = 0 } line[n++] = $0 } END { for (i = 0; i < n; i++) { if (i %% 64 == 0 && i) print \"\"; print line[i] } }' %s.histogram.tsv", s) \
		using ($3 * 1e3):2:4 with lines lc rgb blue notitle
}
set border 3
set output "fig49.png"
set title "Figure 49: sizes without and with separation"
set xlabel "diameter, um (150: and above)"; set ylabel "per cent"
set style data histogram; set style fill solid 0.8; set yrange [0:*]
plot "< grep -v all sizes.tsv" using 2:xtic(1) title "truth" lc rgb grey, \
	"" using 3 title "counted" lc rgb red, "" using 4 title "separated" lc rgb blue

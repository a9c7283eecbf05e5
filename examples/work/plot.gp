# Error of every program against its processor time, one line for each
set terminal svg size 900,620 dynamic font "sans,15" background "white"
set output "error-time.svg"
set datafile separator "\t"
set logscale xy; set format y "10^{%T}"; set key outside right
set xlabel "processor time, s"; set ylabel "error (of what: see the table)"
set border 3; set tics nomirror; set grid
programs = "roughgen bemcontact debrisgen debrisstat sensorsim bpfilter duet delaynet aopf rwl abrade debriscount wear-volume ballcal layout surfimport sigconvert pipeline"
plot for [i=1:words(programs)] sprintf("< awk -F '\t' '$1 == \"%s\" { print $7 + 0.0005 \"\t\" $4 }' error.tsv | sort -g", word(programs, i)) \
	using 1:2 with linespoints pt i lc i title word(programs, i)

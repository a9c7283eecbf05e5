# Tables 2 to 6 from the scores of single networks: awk -f summary.awk rows.tsv SCORE...
#
# Means over the repetitions beside the printed values, and which level that needs no data
# (1/24, 1/12, 1/8, 1/6) lies within two sampling errors of the clean score.  300 samples
# of three delays give a mean squared error near 1/12 to about 0.0025.
BEGIN {
	FS = OFS = "\t"
	split("1/24 1/12 1/8 1/6", name, " ")
	split("24 12 8 6", part, " ")
}
function level(x, i) {
	for (i = 1; i <= 4; i++)
		if (x > 1 / part[i] - 0.005 && x < 1 / part[i] + 0.005)
			return name[i]
	return "-"
}
/^#/ || $1 == "row" { next }
FNR == NR {
	order[++rows] = $1
	table[$1] = $2
	structure[$1] = $4
	mse[$1] = $6
	noisy[$1] = $7
	next
}
{
	n[$1]++
	for (i = 3; i <= 7; i++) {
		sum[$1, i] += $i
		square[$1, i] += $i * $i
	}
}
function mean(r, i) { return sum[r, i] / n[r] }
function spread(r, i, v) {
	if (n[r] < 2)
		return "nan"
	v = (square[r, i] - sum[r, i] ^ 2 / n[r]) / (n[r] - 1)
	return sprintf("%.4f", v > 0 ? sqrt(v) : 0)
}
END {
	print "# levels: constant 1/12 = 0.0833, sorted constants 1/24 = 0.0417, these against unsorted 1/8 = 0.1250, random 1/6 = 0.1667"
	print "table", "structure", "repeats", "printed", "ordered", "ordered_sd", \
		"unordered", "printed_noise", "ordered_noise", "ordered_noise_sd", \
		"unordered_noise", "printed_is", "ordered_is", "seconds"
	for (k = 1; k <= rows; k++) {
		r = order[k]
		if (!n[r])
			continue
		print table[r], structure[r], n[r], mse[r], sprintf("%.4f", mean(r, 3)), \
			spread(r, 3), sprintf("%.4f", mean(r, 5)), noisy[r], \
			sprintf("%.4f", mean(r, 4)), spread(r, 4), \
			sprintf("%.4f", mean(r, 6)), level(mse[r]), level(mean(r, 3)), \
			sprintf("%.2f", mean(r, 7))
	}
}

#!/bin/sh
# The streams that pipeline.sh left, drawn by gnuplot and put on one page
set -eu
here=$(dirname "$0")
if ! command -v gnuplot >/dev/null 2>&1; then
	echo "no gnuplot, hence no pictures; the results are in $PWD" >&2
	exit 0
fi

# What gnuplot reads: one record as text, particles by size, a piece of the signals.
records --pick 1 --field height -o text contact.nrrd >height.txt
records --pick 1 --field pressure -o text contact.nrrd >pressure.txt
awk -F '\t' '/^#/ { next } !k { for (i = 1; i <= NF; i++) if ($i == "diameter") k = i; next }
	{ print $k * 1e6 }' particles.tsv | sort -gr | awk '{ print $1, NR }' >made.txt
awk -F '\t' '/^#/ { next } !k { for (i = 1; i <= NF; i++) if ($i == "diameter") k = i; next }
	{ print $k * 1e6 }' found.tsv | sort -gr | awk '{ print $1, NR }' >found.txt
side=$(records --pick 1 contact.nrrd | awk -F '\t' '$1 == 1 { print $5 * $8 * 1e6; exit }')

# Where the piece of 1200 frames begins: shortly before the section with the most overlap.
begin=$(awk -F '\t' '/^#/ { next } !t { for (i = 1; i <= NF; i++) { if ($i == "time1") t = i
		if ($i == "sources") n = i }; next }
	$n <= 6 && $n > most { most = $n; at = $t } END { printf "%.4f", (at > 0.01 ? at - 0.01 : 0) }' found.tsv)
# at FILE CHANNELS: the byte of an AU file where that frame begins
at() {
	od -An -v -tu1 -j4 -N4 "$1" | awk -v c="$2" -v t="$begin" '{
		print (($1 * 256 + $2) * 256 + $3) * 256 + $4 + 8 * c * int(t * 10000 + 0.5) }'
}
gnuplot -e "side=$side; begin=$begin; rate=10e3; raw_at=$(at raw.au 2)" \
	-e "band_at=$(at band.au 2); pulses_at=$(at pulses.au 8)" "$here/plot.gp"

# A figure of the last row of the life table, and of the work done.
row() {
	awk -F '\t' -v c="$1" '/^#/ { next } !k { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
		{ v = $k } END { printf "%.4g", v }' "$2"
}
count() {
	grep -vc '^#' "$1" | awk '{ print $1 - 1 }'
}
hours() {
	row "$1" life.tsv | awk '{ printf "%.0f", $1 / 3600 }'
}
picture() {
	printf '<figure><img alt="%s" src="data:image/png;base64,' "$2"
	base64 <"$1" | tr -d '\n'
	printf '"><figcaption>%s</figcaption></figure>\n' "$2"
}
{
	cat <<EOF
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>wearpipe</title><style>
body { font: 16px/1.5 sans-serif; max-width: 70em; margin: 2em auto; padding: 0 1em; color: #222 }
figure { display: inline-block; margin: 0.5em; width: 31em; vertical-align: top }
img { width: 100% } figcaption { font-size: 90%; color: #555 }
pre { background: #f4f4f4; padding: 1em; overflow-x: auto }
</style></head><body>
<h1>From a rough surface to remaining wear life</h1>
<p>$(count particles.tsv) wear particles were torn off; $(count found.tsv) were found in the
record of the sensors.  After $(row t life.tsv | awk '{ printf "%.0f", $1 / 3600 }') hours the
pair has $(hours mean) hours left in the mean, and between $(hours q05) and $(hours q95) with
90 % probability.</p>
EOF
	picture surface.png "Surface before wear"
	picture pressure.png "Pressure where it touches"
	picture particles.png "Particles torn off, and particles found, of at least a size"
	picture signal.png "A piece of the record: as measured, band-passed, and separated"
	picture state.png "Volume worn off, as observed and filtered"
	picture life.png "Remaining wear life and its 90 % band"
	echo '<h2>The pipeline</h2><pre>'
	sed -e '1,/^set -eu/d' -e 's/&/\&amp;/g' -e 's/</\&lt;/g' "$here/pipeline.sh"
	echo '</pre></body></html>'
} >demo.html
echo "$PWD/demo.html"

#!/bin/sh
# The streams that pipeline.sh left, drawn by wearplot and put on one page
set -eu
here=$(dirname "$0")

# column NAME FILE: the values of one column of a table
column() {
	awk -F '\t' -v c="$1" '/^#/ { next } !k { for (i = 1; i <= NF; i++) if ($i == c) k = i; next }
		{ print $k }' "$2"
}
escaped() {
	sed -e 's/&/\&amp;/g' -e 's/</\&lt;/g' -e 's/>/\&gt;/g'
}

# --- What is known of the simulated pump, and what was found without knowing it.
area=$(records --pick 1 surface.nrrd | awk -F '\t' '$1 == 1 { printf "%.17g", $5 * $8 * $6 * $9 }')
limit=$(awk -v a="$area" 'BEGIN { printf "%.17g", 0.09 * a ^ 1.5 }')
# Volume of the particles put in, over hours of running (2 s of the record are an hour).
paste_volume() {
	awk -F '\t' '/^#/ { next } !k { for (i = 1; i <= NF; i++) { if ($i == "diameter") k = i
			if ($i == "time1") t = i; if ($i == "verdict") v = i } next }
		!v || $v == "alone" || $v == "overlap" { print $t * 1800, 0.5235987755982988 * $k ^ 3 }' "$1"
}
paste_volume truth.tsv >put-in.txt
paste_volume found.tsv >found.txt
end=$(awk -v w="$limit" '{ v += $2; if (v >= w) { printf "%.0f", $1; exit } }' put-in.txt)
put_in=$(awk '{ n++; v += $2 } END { printf "%d %.4g", n, v * 1e9 }' put-in.txt)
found=$(awk '{ n++; v += $2 } END { printf "%d %.4g", n, v * 1e9 }' found.txt)
# Rows before failure, and those whose 90 % interval holds the true remaining life.
held=$(awk -F '\t' -v end="${end:-0}" '/^#/ { next } !n { for (i = 1; i <= NF; i++) c[$i] = i; n = 1; next }
	$c["t"] < end { rows++; left = end - $c["t"]
		if ($c["q05"] <= left && left <= $c["q95"]) held++ }
	END { print held + 0, rows + 0 }' life.tsv)
hours() {
	awk -v t="$1" 'BEGIN { printf "%.1f", t / 3600 }'
}

# --- Pictures: each with the command behind it, two sentences, and its stream.
# Where the piece of the signal begins: shortly before the section with the most overlap.
begin=$(awk -F '\t' '/^#/ { next } !t { for (i = 1; i <= NF; i++) { if ($i == "time1") t = i
		if ($i == "sources") n = i } next }
	$n <= 6 && $n > most { most = $n; at = $t } END { printf "%.3f", (at > 0.01 ? at - 0.01 : 0) }' found.tsv)
last=$(awk -v b="$begin" 'BEGIN { printf "%.3f", b + 0.12 }')
# picture NAME STREAM SENTENCES OPTION...
picture() {
	picture=$1 stream=$2 text=$3
	shift 3
	wearplot --size 480x340 --output "$picture.svg" "$@" "$stream" || [ $? = 3 ] || return 0
	printf '<figure><img alt="%s" src="data:image/svg+xml;base64,' "${text%%.*}"
	base64 <"$picture.svg" | tr -d '\n'
	printf '">\n<figcaption>%s\n<details><summary>Command</summary><pre>%s\n%s</pre></details></figcaption></figure>\n' \
		"$text" "$(made "$stream" | escaped)" "$(echo "wearplot $* $stream" | escaped)"
}
# made STREAM: the command that its header records
made() {
	case $1 in
	*.nrrd) sed -n -e 's/^cmd:=//p' -e '/^$/q' "$1" | head -n 1 ;;
	*.au) dd if="$1" bs=4096 count=1 2>/dev/null | tr -d '\000' | sed -n 's/^.*cmd //p' | head -n 1 ;;
	*) sed -n 's/^# cmd: //p' "$1" | head -n 1 ;;
	esac
}
pictures() {
	picture surface surface.nrrd "The surface before wear. Its waves are drawn from a Gaussian \
spectrum and scaled to the roughness of a ground steel face." --relief
	picture pressure contact.nrrd "Contact pressure under the nominal load. A few per cent of the \
area carry all of it." --field pressure
	picture worn worn.nrrd "The surface after wear. Material whose stress exceeded the yield \
stress has left as particles."
	picture particles truth.tsv "Particles put into the oil and particles found in the record, by \
size. The two lines should coincide, although the separation knows neither number nor sizes." --found found.tsv
	if [ -e raw.au ]; then
		picture signal raw.au "A piece of the record of the two sensors. Mains and pump disturb \
it, and pulses overlap; triangles mark the particles found." --from "$begin" --to "$last" --found found.tsv
		picture band band.au "The same piece, band-passed. The line of the mains is taken out." \
			--from "$begin" --to "$last"
		picture pulses pulses.au "The pulses of each particle, separated. Each colour is one \
particle as the first sensor saw it." --from "$begin" --to "$last"
	fi
	picture state state.tsv "Volume worn off, observed and filtered. The dashed line is the volume \
at which the pair is worn out." --end "$limit"
	picture life life.tsv "Predicted remaining life with its 90 % band. The dashed line is the true \
remaining life, which the prediction does not know." ${end:+--truth "$end"}
}
if command -v gnuplot >/dev/null 2>&1; then
	pictures >pictures.html
else
	echo "no gnuplot, hence no pictures; the results are in $PWD" >&2
	: >pictures.html
fi
{
	cat <<'EOH'
<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>wearpipe: from a rough surface to remaining wear life</title>
EOH
	echo '<style>'
	cat "$here/../../share/page.css"
	cat <<'EOH'
</style></head><body>
<h1>From a rough surface to remaining wear life</h1>
EOH
	cat <<EOH
<p>A pair of steel faces is simulated until it is worn out. Its debris passes two sensors; the
programs find the particles in the record and predict the remaining life from them alone.</p>
<table><tr><th></th><th>put in</th><th>found</th></tr>
<tr><td>particles</td><td>${put_in% *}</td><td>${found% *}</td></tr>
<tr><td>volume, mm<sup>3</sup></td><td>${put_in#* }</td><td>${found#* }</td></tr></table>
EOH
	if [ -n "$end" ]; then
		echo "<p>The pair is worn out after $(hours "$end") h. The 90 % interval held the true remaining life in ${held% *} of ${held#* } predictions before.</p>"
	else
		echo "<p>The pair is not worn out when the record ends.</p>"
	fi
	echo '<main>'
	cat pictures.html
	echo '</main><h2>The pipeline</h2><pre>'
	sed -e '1,/^set -eu/d' "$here/pipeline.sh" | escaped
	echo '</pre></body></html>'
} >demo.html
echo "particles put in: ${put_in% *}, found: ${found% *}; volume: ${put_in#* } and ${found#* } mm3"
[ -z "$end" ] || echo "worn out after $(hours "$end") h; the 90 % interval held in ${held% *} of ${held#* } predictions"
echo "open $PWD/demo.html"

#!/bin/sh
# The demo: the pair wears out, what is found is what was put in, and the page shows it all
. "$(dirname "$0")/../tap.sh"

bin=${BIN:-$top/bin}
ok 'the demo runs' make -s -C "$top/examples/demo" BIN="$bin" OUT="$work/demo"
cp out said
word() { sed -n "s/$1/\\1/p" said; }
near 'the volume found is the volume put in, within 1 %' \
	"$(word '.*volume: .* and \([0-9.]*\) mm3')" "$(word '.*volume: \([0-9.]*\) and .*')" 0.001
is 'the pair wears out within the record' "$(word 'worn out after \([0-9]*\)\..*' | awk '{ print ($1 > 24 && $1 < 48) }')" 1
is 'most intervals of 90 % hold the true remaining life' \
	"$(word '.* held in \([0-9]* of [0-9]*\) predictions' | awk '{ print ($1 > 0.6 * $3) }')" 1
# One surface gives a life of status 3, with which the demo goes on.
roughgen --points 64 --length 0.5mm --sq 0.3um --corr 40um >'a surface.nrrd'
ok 'the demo runs on a measured surface in a path with a blank' make -s -C "$top/examples/demo" BIN="$bin" \
	OUT="$work/measured" SURFACE="$work/a surface.nrrd"
is 'the demo of a measured surface ends with the distribution of the life' \
	"$(column t "$work/measured/life.tsv" | wc -l)" "$(column t "$work/measured/state.tsv" | wc -l)"
page=$work/demo/demo.html
if ! command -v gnuplot >/dev/null; then
	skip 'the page has nine pictures' 'no gnuplot'
	done_testing
fi
is 'the page has nine pictures' "$(grep -c '<figure>' "$page")" 9
is 'each figure has its command' "$(grep -c '<summary>Command' "$page")" 9
is 'the page has no link to elsewhere' "$(grep -cE '(src|href)="?https?:' "$page")" 0
for browser in chromium chromium-browser google-chrome ''; do
	[ -z "$browser" ] || ! command -v "$browser" >/dev/null || break
done
if [ -z "$browser" ]; then
	skip 'all pictures are drawn in a browser' 'no Chromium'
	done_testing
fi
# The page with a script that says, when all is loaded, how many pictures were drawn and by
# how much the widest thing exceeds the window.
{
	cat "$page"
	echo '<script>addEventListener("load", () => { const d = document.documentElement
	document.title = [...document.images].filter(i => i.complete && i.naturalWidth).length +
		" pictures, " + (d.scrollWidth - d.clientWidth) + " too wide" })</script>'
} >probe.html
for width in 400 800 1400; do
	"$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
		--disable-background-networking --disable-component-update --disable-sync --disable-dev-shm-usage \
		--user-data-dir="$work/profile" --enable-logging=stderr --window-size=$width,900 \
		--dump-dom "file://$work/probe.html" >dom 2>log
	is "$width pixels wide: all pictures are drawn, nothing is wider" \
		"$(sed -n 's/.*<title>\(.*\)<\/title>.*/\1/p' dom)" '9 pictures, 0 too wide'
	is "the console has no error at a width of $width pixels" "$(grep 'CONSOLE' log)" ''
done
done_testing

#!/bin/sh
# Manual pages: they agree with --help, lint clean, and their examples run
. "$(dirname "$0")/tap.sh"

programs=$(sed -n 's/^PROGRAMS = //p' "$top/Makefile")

version=$(sed -n 's/^VERSION = //p' "$top/Makefile")

# Examples of a page: .Dl lines and literal displays of the EXAMPLES section.
examples() {
	awk '/^\.Sh / { on = $2 == "EXAMPLES" }
	!on { next }
	/^\.Dl / { sub(/^\.Dl /, ""); print; next }
	/^\.Bd -literal/ { show = 1; next }
	/^\.Ed/ { show = 0; next }
	show { print }' "$1" | sed -e 's/\\e/\\/g' -e 's/\\&//g' -e 's/\\(dq/"/g' -e 's/\\(aq/'\''/g' -e 's/\\-/-/g' -e 's/\\(ha/^/g' -e 's/\\(ti/~/g'
}

# Options of a page: ".It Fl n , Fl -points Ar ..." as "n points", ".It Fl -sa" as "- sa".
page_options() {
	sed -n -e 's/^\.It Fl \([^-]\) , Fl -\([a-z0-9-]*\).*/\1 \2/p' \
		-e 's/^\.It Fl -\([a-z0-9-]*\).*/- \1/p' "$1" | sort
}

help_options() {
	sed -n -e 's/^  -\(.\), --\([a-z0-9-]*\).*/\1 \2/p' \
		-e 's/^      --\([a-z0-9-]*\).*/- \1/p' | sort
}

for p in $programs wearwatch; do
	page=$top/man/$p.1
	if [ ! -e "$page" ]; then
		fail "$p has a manual page"
		continue
	fi
	page_options "$page" >page.options
	"$p" --help | help_options >help.options
	is "$p: the page and --help have the same options" "$(diff page.options help.options)" ""
done
for page in "$top"/man/*.[1-9]; do
	name=${page##*/}
	if command -v mandoc >/dev/null; then
		is "$name: mandoc finds no fault" "$(mandoc -T lint -W warning "$page" 2>&1)" ""
	else
		skip "$name: mandoc finds no fault" "no mandoc"
	fi
	# groff reads a macro's name within a reference where mandoc reads a word.
	if command -v groff >/dev/null; then
		groff -mandoc -Tascii -P-cbou -wall "$page" >rendered 2>warnings
		is "$name: groff renders every section" "$(sed -n 's/^\([A-Z][A-Z ]*\)$/\1/p' rendered |
			tr '\n' '|')" "$(sed -n 's/^\.Sh //p' "$page" | tr '\n' '|')"
		is "$name: groff finds no fault" "$(cat warnings)" ""
	else
		skip "$name: groff renders every section" "no groff"
		skip "$name: groff finds no fault" "no groff"
	fi
	is "$name: names the version" "$(sed -n 's/^\.Os wearpipe //p' "$page")" "$version"
	# The reader of the page must see what the test runs: mdoc eats a bare backslash.
	is "$name: the examples are printed as they run" \
		"$(awk '/^\.Sh / { on = $2 == "EXAMPLES" } on' "$page" | grep '\\[^e&(-]')" ""
	examples "$page" >examples.sh
	[ -s examples.sh ] || continue
	dir=$work/${name%.*}
	mkdir "$dir"
	if (cd "$dir" && sh -e ../examples.sh </dev/null >../out 2>../err); then
		pass "$name: the examples run"
	else
		fail "$name: the examples run" "exit status $?" "$(tail -5 err)"
	fi
done
done_testing

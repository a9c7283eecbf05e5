#!/bin/sh
# The layers of lib/: no circle of modules or of rooms, domains that neither print nor exit,
# and a library that does not know its programs
. "$(dirname "$0")/tap.sh"
# not in the tree, where ok leaves what a command prints
ln -s "$top/lib" "$top/Makefile" . || exit 1

# A module is a source with its header and what x_state.h shares of it; a room is a folder.
# The inputs are pairs "user used", one a line.
name() { sed -E 's/\.[cho]( |$)/\1/g; s/_state( |$)/\1/g; s/^lib\///'; }
modules() { awk '$1 != $2' | sort -u; }
rooms() { sed -E 's|/[^/ ]*( \|$)|\1|g' | modules; }
# The members of the circles.
circles() { tsort 2>&1 >"$work/order" | grep -v 'input contains a loop' | sed 's/^tsort: //' | sort -u | paste -s -d ' ' -; }

is "a circle of modules is found" \
	"$(printf '%s\n' 'io/a num/b' 'num/b io/c' 'io/c io/a' 'io/d io/a' | modules | circles)" "io/a io/c num/b"
is "a circle of rooms is found" \
	"$(printf '%s\n' 'io/a num/b' 'num/c io/d' 'io/d io/a' | rooms | circles)" "io num"

# no_circle WHAT FILE
no_circle() {
	ok "$1: many modules use each other" [ "$(modules <"$2" | wc -l)" -gt 100 ]
	is "$1: modules form no circle" "$(modules <"$2" | circles)" ""
	is "$1: rooms form no circle" "$(rooms <"$2" | circles)" ""
	is "$1: domains use neither streams nor options" \
		"$(rooms <"$2" | awk '$1 !~ /^(io|cli)$/ && $2 ~ /^(io|cli)$/')" ""
}

sources=$(find lib/ -name '*.[ch]')
# shellcheck disable=SC2086
awk -F '"' '/^#include "/ { print FILENAME, $2 }' $sources | name >"$work/includes"
no_circle "by #include" "$work/includes"
is "no source of the library includes one of a program" "$(awk '$2 ~ /\// { print $2 }' "$work/includes" |
	sort -u | while read -r m; do [ -e "lib/$m.h" ] || echo "$m"; done)" ""

# The objects of this build; those of sources that are gone do not count.
objects=${BIN:-$top/bin}
case $objects in */build/*) objects=${objects%/bin} ;; *) objects=$top/build ;; esac
find lib/ -name '*.c' | while read -r f; do
	o=$objects/${f%.c}.o
	[ ! -e "$o" ] || echo "$o"
done | tr '\n' '\0' | xargs -0 nm -P -A | sed 's|^.*/\(lib/[^:]*\):|\1|' | name >"$work/symbols"
awk '$3 ~ /[TDBRVW]/ { print $2, $1 }' "$work/symbols" | sort >"$work/defined"
awk '$3 == "U" { print $2, $1 }' "$work/symbols" | sort >"$work/used"
join -o 1.2,2.2 "$work/used" "$work/defined" >"$work/calls"
no_circle "by nm" "$work/calls"
is "domains do not print, exit or read the environment" "$(awk '$1 !~ /^(io|cli)\// &&
	$3 == "U" && $2 ~ /^(stdout|stderr|stdin|printf|puts|putchar|fopen|exit|_exit|abort|getenv|perror)$/ { print $1, $2 }' \
	"$work/symbols")" ""

programs=$(sed -n 's/^PROGRAMS = //p' Makefile)
# As words in quotes, where the code could act by them; "layout" is also a word of its own.
is "the library does not know its programs" "$(for p in $programs; do
	[ "$p" = layout ] || grep -rn -e "\"$p\"" -e "\"$p " lib
done)" ""
done_testing

#!/bin/sh
# What every program of the suite promises of its options, streams and exit statuses
. "$(dirname "$0")/tap.sh"

programs=$(sed -n 's/^PROGRAMS = //p' "$top/Makefile")
for p in $programs; do
	command -v "$p" >/dev/null || {
		fail "$p is built"
		continue
	}
	ok "$p --help exits with 0" "$p" --help
	cp out "$p.help"
	ok "$p --version exits with 0" "$p" -V
	is "$p states its name and version" "$(awk '{ print $1, $2 }' out)" "$p (wearpipe)"
	fails "$p refuses an unknown option" 2 "^$p: --no-such-option" "$p" --no-such-option
	case $p in
	roughgen) needed='--measure' ;;
	bemcontact) needed='--load 1N --estar 1GPa' ;;
	debrisgen | debrisfit) needed='--yield 355MPa' ;;
	rwl) needed='--wear no-such-file --threshold-gap 1um' ;;
	delaynet) needed='--task score' ;;
	abrade) needed='--gap 1um --hardness 1GPa --friction 0' ;;
	ballcal) needed='--balls no-such-file:1mm' ;;
	layout) needed='--coils 0 --snr 40dB --arrivals 1' ;;
	*) needed= ;;
	esac
	file=no-such-file
	grep -q '^usage: .*\[file' "$p.help" || file=
	fails "$p opens --stats before any work" 1 "^$p: /nonexistent/x: " \
		"$p" $needed --stats /nonexistent/x $file
	[ -z "$file" ] || fails "$p names a missing file" 1 "^$p: .*no-such-file" "$p" $needed $file
done

# A list has as many members as its placeholder shows: one less or more is refused.
ones() {
	awk -v n="$1" -v by="$2" 'BEGIN { for (i = 0; i < n; i++) printf "%s1", i ? by : "" }'
}
for p in $programs; do
	[ -e "$p.help" ] && sed -n "s/^ *\(-., \)*--\([a-z0-9-]*\) \([^ ]*[:,x][^ ]*\).*/\2 \3/p" "$p.help" |
		grep -v -e '\.\.\.' -e '|' -e FILE >lists
	while read -r word shape; do
		case $shape in *:*) by=: ;; *,*) by=, ;; *) by=x ;; esac
		most=$(echo "$shape" | awk -F "$by" '{ print NF }')
		least=$(echo "${shape%%\[*}" | awk -F "$by" '{ print NF }')
		message="^$p: --$word .*: want $(echo "$shape" | sed 's/\[/\\[/g')$"
		fails "$p --$word of too many" 2 "$message" "$p" "--$word" "$(ones $((most + 1)) $by)"
		[ "$least" = 1 ] ||
			fails "$p --$word of too few" 2 "$message" "$p" "--$word" "$(ones $((least - 1)) $by)"
	done <lists
done
fails "bounds of a fraction are no percentage" 2 '^debrisstat: --confidence 95: want 0.01 to 0.9999$' \
	debrisstat --confidence 95
for c in 0.01 0.9999; do
	ok "the bound $c of an option is accepted" debrisstat --confidence $c --help
done
fails "a number next to a bound" 2 '^debrisstat: --confidence 0.99991: want 0.01 to 0.9999$' \
	debrisstat --confidence 0.99991 --help
fails "other bounds have a unit" 2 '^sensorsim: --bore 20: want 1um to 10m$' sensorsim --bore 20

if command -v python3 >/dev/null; then
	python3 -c 'import pty, sys; sys.exit(pty.spawn(["timeout", "5", "debrisstat"]) >> 8)' >tty </dev/null
	is "a program without arguments does not wait for a terminal" \
		"$? $(grep -c 'nothing to read: usage: debrisstat' tty)" "2 1"
	python3 -c 'import pty, sys; sys.exit(pty.spawn(["timeout", "5", "debrisgen", "--yield", "1GPa"]) >> 8)' >tty </dev/null
	is "a program with options does not wait for a terminal" "$? $(grep -c 'nothing to read: name a file' tty)" "2 1"
	printf 't\ty\n0\t1\n1\t2\n\004' |
		python3 -c 'import pty, sys; sys.exit(pty.spawn(["timeout", "5", "wear-volume", "-"]) >> 8)' >tty
	is "a terminal named as - is read" "$(grep -c 'nothing to read' tty)" 0
else
	skip "a program without arguments does not wait for a terminal" "no python3"
fi

# The same word has the same letter everywhere, and reserved letters keep their meaning.
for p in $programs; do
	[ -e "$p.help" ] && sed -n "s/^  -\(.\), --\([a-z0-9-]*\).*/\2 \1 $p/p" "$p.help"
done >letters
at_most "the letters of all programs are read from their help" 100 "$(wc -l <letters | tr -d ' ')"
is "a word has one letter in the whole suite" \
	"$(sort -u -k1,2 letters | awk '$1 == w && $2 != l { print w, l, $2, $3 } { w = $1; l = $2 }')" ""
is "a letter has one word in the whole suite" \
	"$(awk '{ print $2, $1 }' letters | sort -u | awk '$1 == l { print l, w, $2 } { l = $1; w = $2 }')" ""
is "a word has its letter in every program or in none" \
	"$(awk '{ print $1 }' letters | sort -u | while read -r word; do
		grep -lE -- "^      --$word( |$)" ./*.help; done)" ""
is "reserved letters have the same meaning in all programs" \
	"$(awk 'BEGIN { split("s seed c count f first j threads v verbose h help V version S stats", a)
		for (i = 1; i < 16; i += 2) want[a[i]] = a[i + 1] }
		$2 in want && want[$2] != $1 { print $3, $2, $1 }' letters)" ""
is "no default is shown that could not be given" "$(grep -hE 'default (-1|-?inf|-?nan)\b' ./*.help)" ""
is "the members of a default are separated as on the command line" \
	"$(grep -o 'default 70Hz:130Hz' bpfilter.help)" 'default 70Hz:130Hz'
is "every option has a description" \
	"$(cat ./*.help | awk '/^ *--*[a-zA-Z]/ && NF < 2 + /^  -/ { getline more; if (more !~ /^   /) print }')" ""
done_testing

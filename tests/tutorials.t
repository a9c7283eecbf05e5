#!/bin/sh
# The tutorials run as printed
. "$(dirname "$0")/tap.sh"


for page in "$top"/doc/tutorials/*.md; do
	name=$(basename "$page" .md)
	mkdir "$name"
	sed -n '/^```sh$/,/^```$/p' "$page" | sed '/^```/d' >"$name/commands"
	if ! command -v gnuplot >/dev/null; then
		sed -i '/wearplot/d' "$name/commands"
	fi
	if (cd "$name" && sh -e commands) >out 2>err; then
		pass "every command of the tutorial '$name' runs"
	else
		fail "every command of the tutorial '$name' runs" "$(tail -5 err)"
	fi
	is "the commands of the tutorial $name give no warning" "$(cat err)" ''
done
done_testing

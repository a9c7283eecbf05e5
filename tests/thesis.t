#!/bin/sh
# Every item of the thesis has a row with a value or a reason, what the rows name exists, and
# the numbers of the examples' pages are numbers of the tables
. "$(dirname "$0")/tap.sh"
table=$top/examples/thesis.tsv
rows() { awk -F '\t' '!/^#/ && $1 != "item"' "$table"; }

is 'every row has ten columns' "$(rows | awk -F '\t' 'NF != 10' | wc -l)" 0
is 'no item comes twice' "$(rows | cut -f 1 | sort | uniq -d)" ''
is 'the 17, 21 and 32 numbered equations of the chapters are there' \
	"$(rows | sed -n 's/^equation \([234]-[0-9]*\).*/\1/p' | sort -u | cut -d - -f 1 | sort | uniq -c | awk '{ printf "%s ", $1 }')" \
	'17 21 32 '
is 'the page has 83 equations with the lines of the systems (2-5), (2-8) and (2-9)' "$(rows | grep -c '^equation')" 83
# as they are numbered, from 1 on without a gap
for kind in figure:68 table:13; do
	is "the page has all of ${kind#*:} ${kind%:*}s" "$(rows | sed -n "s/^${kind%:*} \([0-9]*\)	.*/\1/p")" "$(seq "${kind#*:}")"
done
is 'every row has a value or a reason' "$(rows | awk -F '\t' '$4 == "-" && ($10 == "-" || $10 == "") { print $1 }')" ''
is 'a value is a number' "$(rows | awk -F '\t' '$4 != "-" && $4 !~ /^[-+]?[0-9.]+(e[-+]?[0-9]+)?$/ { print $1, $4 }')" ''
is 'a verdict is computed, or one of the list with its reason' "$(rows | awk -F '\t' '
	$9 == "-" && $6 == "-" || $9 !~ /^(-|print inconsistent|data unpublished|scheme only)$/ || $9 != "-" && $10 == "-" { print $1 }')" ''
is 'every computed row has a value to compare with or is a test' "$(rows | awk -F '\t' '
	$9 == "-" && $4 == "-" && $6 !~ /^unit\// { print $1 }')" ''
is 'every experiment is a unit test or a folder with a Makefile' "$(rows | cut -f 6 | sort -u | while read -r e; do
	case $e in
	-) ;;
	unit/*) [ -e "$top/tests/$e.c" ] || echo "$e" ;;
	*) [ -e "$top/examples/$e/Makefile" ] || echo "$e" ;;
	esac
done)" ''
for e in $(rows | cut -f 6 | grep -v -e '^-' -e '^unit/' | sort -u) grid work; do
	case $top in
	*' '*)
		fails "$e in a path with a blank" 2 'the experiments do not run in a path with a blank' \
			sh -c "make -n -C '$top/examples/$e' results 2>&1 >/dev/null | grep -F '***' >&2; exit 2"
		continue
		;;
	esac
	is "$e: make finds a way to its results" "$(make -n -C "$top/examples/$e" OUT="$work/$e" results 2>&1 >/dev/null | head -n 3)" ''
done
cp "$table" thesis.tsv

# --- A test named by the beginning of its line must be one that the source can print.
is 'every unit test prints the line that a row names' "$(rows | awk -F '\t' '$6 ~ /^unit\// && $7 != "-" { print $6 "\t" $7 }' |
	sort -u | while IFS='	' read -r unit line; do
	[ -x "$top/build/$unit" ] || continue
	[ -e "${unit##*/}.tap" ] || (cd "$top" && "build/$unit") >"${unit##*/}.tap" 2>/dev/null
	sed -n 's/^ok [0-9]* - //p' "${unit##*/}.tap" | awk -v k="$line" 'index($0, k) == 1 { n++ } END { exit !n }' ||
		echo "$unit: $line"
done)" ''

# --- Numbers of the READMEs: one of the rows of the experiment, one of its options, or one of its
# results to as many digits as the page gives.  Numbers of figures, tables, sections and
# equations are names.
# unknown FILE: its numbers that are none of these
unknown() {
	awk 'function digits(x) { sub(/^[-+]/, "", x); sub(/e.*/, "", x); sub(/^0*\.?0*/, "", x); gsub(/\./, "", x); return length(x) }
		FILENAME == "exact" { known[$1 + 0]; next }
		FILENAME == "results" { list[n++] = $1 < 0 ? -$1 : $1 + 0; next }
		$1 + 0 in known || -$1 in known { next }
		{ d = digits($1); f = "%." (d > 1 ? d : 1) "g"; want = sprintf(f, $1) + 0; if (want < 0) want = -want
			for (i = 0; i < n; i++) if (sprintf(f, list[i]) + 0 == want) next
			print $1 }' exact results "$1"
}
number='[-+]?[0-9]+(\.[0-9]+)?(e-?[0-9]+)?'
changed=0 found=0
for page in "$top"/examples/*/README.md; do
	e=$(basename "$(dirname "$page")")
	sed -e '/^```/,/^```/d' -e 's/`[^`]*`//g' -e 's/ISO [0-9]*//g' -e 's/([2-4]-[0-9]*)//g' -e 's,[0-9]*/[0-9][0-9]*,,g' \
		-e 's/\([Ff]igure\|[Tt]able\|[Cc]hapter\|[Ss]ection\)s\{0,1\} [0-9.]*\(\( to \|, \| and \)[0-9][0-9.]*\)*//g' "$page" |
		grep -oE "(^|[^A-Za-z0-9_.])$number" | sed 's/^[^-+0-9]//' | sort -u >numbers
	{ awk -F '\t' -v e="$e" '$6 == e || $6 == "arithmetic" { print $3, $4, $10 }' "$table"
	find "$top/examples/$e" -type f ! -name README.md -exec cat {} +; } | grep -oE "$number" | sort -u >exact
	{ awk -F '\t' -v e="$e" '$1 == e || $1 == "arithmetic" { print $3; print $4; print $5 }' "$top/examples/results.tsv"
	awk -F '\t' -v e="$e" '$6 == e { print $4 }' "$table"; } | grep '[0-9]' | sort -u >results
	is "$e: the numbers of the page are numbers of the tables" "$(unknown numbers | tr '\n' ' ')" ''
	# each with another last digit: those of one or two digits may well be others'
	awk '!/e/ && length($1) > 2 { n = length($1); print substr($1, 1, n - 1) (substr($1, n) + 3) % 10 }' numbers >others
	changed=$((changed + $(wc -l <others))) found=$((found + $(unknown others | wc -l)))
done
ok "most numbers with a wrong last digit are found: $found of $changed" test $((2 * found)) -gt "$changed"

# --- Verdicts: by interval, by a tenth, under a reading, of most cases.
{
	printf 'item\tchapter\tstates\tvalue\tunit\texperiment\tkey\treading\tverdict\treason\n'
	printf 'number 1\t2\ta\t5\tm\te\tinside\t-\t-\t-\n'
	printf 'number 2\t2\ta\t5\tm\te\tnear\t-\t-\t-\n'
	printf 'number 3\t2\ta\t5\tm\te\tfar\t-\t-\t-\n'
	printf 'number 4\t2\ta\t5\tm\te\tfar\tother=near\t-\t-\n'
	printf 'number 5\t2\ta\t1\tshare of runs\te\tmost\t-\t-\t-\n'
	printf 'number 6\t2\ta\t1\tshare of runs\te\tfew\t-\t-\t-\n'
	printf 'number 7\t2\ta\t5\tm\te\tinside\t-\tprint inconsistent\twhy\n'
	printf 'number 8\t2\ta\t5\tm\te\tnothing\t-\t-\t-\n'
	printf 'number 9\t2\ta\t0.1\tm\te\tabove\t-\t-\t-\n'
} >small.tsv
{
	printf 'inside\tmean\t2\ninside\tmean\t7\ninside\tmean\t9\nnear\texact\t5.4\nfar\texact\t5.6\n'
	printf 'most\tshare\t%s\n' 1 1 1 0
	printf 'few\tshare\t%s\n' 0 1 0 0
	printf 'above\tpositive\t%s\n' 1 10 100
} >values.tsv
"$top/examples/results" values.tsv >results.tsv
is 'the verdicts follow the rule' "$("$top/examples/compare" small.tsv e results.tsv | sed 1d | cut -f 10)" 'agrees
agrees
differs
agrees under reading: other
agrees
differs
print inconsistent
not run
agrees'
# 2, 7, 9: mean 6, standard deviation sqrt 13, t = 4.30265: 6 -+ 4.30265 sqrt(13 / 3)
near 'the interval of a mean is that of Student' "$(awk -F '\t' '$1 == "inside" { print $4 }' results.tsv)" 14.9567 0.001
# logarithms -1, 0 and 1 about that of ten: exp(-4.30265 ln(10) sqrt(4 / 3)) * 10
near 'the interval of a positive quantity is that of its logarithm' "$(awk -F '\t' '$1 == "above" { print $3 * 1e5 }' results.tsv)" 10.7579 0.001
fails 'a quantity that is not positive is refused' 1 'not above zero' sh -c "printf 'a\tpositive\t0\n' >bad.tsv && '$top/examples/results' bad.tsv"
# Wilson, 3 of 4
near 'the interval of a share is that of Wilson' "$(awk -F '\t' '$1 == "most" { print $3 }' results.tsv)" 0.30064 0.001
fails 'an unknown kind of result is refused' 1 'no such kind' sh -c "printf 'a\tmedian\t1\n' >bad.tsv && '$top/examples/results' bad.tsv"
done_testing

# shellcheck shell=sh
# tap.sh - functions for shell tests; read it with: . "$(dirname "$0")/tap.sh"
#
#	is NAME GOT WANT           equal strings
#	like NAME GOT PATTERN      GOT matches a basic regular expression
#	near NAME GOT WANT TOL     |got - want| <= tol, all three numbers
#	at_most NAME GOT LIMIT     got <= limit, both numbers
#	rising NAME NUMBER...      two numbers or more, none below the one before (nan is none)
#	ok NAME COMMAND...         command succeeds
#	fails INPUT STATUS PATTERN COMMAND...
#	                           exits with STATUS, one line on stderr matching PATTERN;
#	                           INPUT names what is refused
#	same NAME FILE FILE        equal bytes, and some
#	skip NAME WHY
#	done_testing
#
# The working directory is a fresh one, removed at the end; $top is the project,
# bin/ is on PATH.
set -u
LC_ALL=C
export LC_ALL
case $0 in
/*) test_file=$0 ;;
*) test_file=$PWD/$0 ;;
esac
top=${test_file%/tests/*}
PATH=${BIN:-$top/bin}:$PATH
export PATH
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' HUP INT TERM
cd "$work" || exit 1
tests=0
bad=0

# The description of a test from its name; scenes.sh has another.
describe() {
	described=$1
}

pass() {
	tests=$((tests + 1))
	describe "$1"
	echo "ok $tests - $described${suffix:-}"
}

fail() {
	tests=$((tests + 1))
	bad=$((bad + 1))
	describe "$1"
	echo "not ok $tests - $described${suffix:-}"
	line=$(grep -nF -m 1 -e "$1" "$test_file" | cut -d: -f1)
	echo "# at ${test_file#"$top"/}${line:+:$line}"
	shift
	for line in "$@"; do
		printf '%s\n' "$line" | sed 's/^/# /'
	done
}

skip() {
	tests=$((tests + 1))
	echo "ok $tests - $1 # SKIP $2"
}

is() {
	if [ "$2" = "$3" ]; then pass "$1"; else fail "$1" "got:  $2" "want: $3"; fi
}

like() {
	if printf '%s\n' "$2" | grep -q -e "$3"; then pass "$1"; else fail "$1" "got:  $2" "want: $3"; fi
}

near() {
	if awk -v g="$2" -v w="$3" -v t="$4" 'BEGIN {
		number = "^[-+]?[0-9.]+([eE][-+]?[0-9]+)?$"
		if (g !~ number || w !~ number || t !~ number) exit 1
		d = g - w; if (d < 0) d = -d; exit !(d <= t) }'; then
		pass "$1"
	else
		fail "$1" "got:  $2" "want: $3 +- $4"
	fi
}

at_most() {
	if awk -v g="$2" -v l="$3" 'BEGIN {
		number = "^[-+]?[0-9.]+([eE][-+]?[0-9]+)?$"
		exit !(g ~ number && l ~ number && g + 0 <= l + 0) }'; then
		pass "$1"
	else
		fail "$1" "got:  $2" "want: at most $3"
	fi
}

rising() {
	name=$1
	shift
	# A word that is empty is no number either.
	if printf '%s\n' "${@:-none}" | awk 'NF == 0 { bad = 1 }
		{ for (i = 1; i <= NF; i++) {
			if ($i !~ /^[-+]?[0-9.]/ || n++ && $i + 0 < last) bad = 1
			last = $i + 0 } }
		END { exit bad || n < 2 }'; then
		pass "$name"
	else
		fail "$name" "got: $*"
	fi
}

ok() {
	name=$1
	shift
	if "$@" >out 2>err; then pass "$name"; else fail "$name" "$*: exit status $?" "$(head -5 err)"; fi
}

fails() {
	name=$1
	want=$2
	pattern=$3
	shift 3
	"$@" >out 2>err </dev/null
	got=$?
	# status 3 is a doubtful result, not a refusal
	case $want,$name in 3,* | *refuse*) ;; *) suffix=': the program refuses it in one line' ;; esac
	if [ "$got" != "$want" ]; then
		fail "$name" "$*: exit status $got, want $want" "$(head -5 err)"
	elif [ "$(wc -l <err)" != 1 ]; then
		fail "$name" "$*: want one line, got:" "$(head -5 err)"
	elif ! grep -q -e "$pattern" err; then
		fail "$name" "message: $(cat err)" "want:    $pattern"
	else
		pass "$name"
	fi
	suffix=''
}

same() {
	if ! [ -s "$2" ]; then
		fail "$1" "$2 is empty or missing"
	elif cmp "$2" "$3" >err 2>&1; then
		pass "$1"
	else
		fail "$1" "$(cat err)"
	fi
}

# column NAME FILE: the values of one column of a table, or a word where there is no table
column() {
	awk -F '\t' -v c="$1" '/^#/ { next }
	!seen { for (i = 1; i <= NF; i++) if ($i == c) k = i; seen = 1; next }
	k { print $k }
	END { if (!seen) print "no table" }' "$2"
}

# live BYTES FILE: a record that stands still after so many bytes until live.tsv, which is
# made of it, has a row; first.tsv: what it has then
live() {
	head -c "$1" "$2"
	waited=0
	until grep -q alone live.tsv || [ $waited = 600 ]; do
		sleep 0.1
		waited=$((waited + 1))
	done
	cp live.tsv first.tsv
	tail -c +$(($1 + 1)) "$2"
}

done_testing() {
	echo "1..$tests"
	[ "$bad" = 0 ]
	exit
}

# shellcheck shell=sh
# scenes.sh - functions for tests of extreme scenes; read it after tap.sh
#
# A name reads "scene | expectation | outcome | error", the row of a table; it is printed
# as a sentence, from which rows.sed makes the row again.
# shellcheck disable=SC2034 # described is read by tap.sh
describe() {
	case $1 in
	*' | '*' | '*' | '*)
		rest=${1#*' | '}
		end=${rest#*' | '}
		described="the scene \"${1%%' | '*}\" leads to \"${end%%' | '*}\" where \"${rest%%' | '*}\" is expected (error ${end#*' | '})"
		;;
	*) described=$1 ;;
	esac
}

# outcome NAME EXPECTATION OUTCOME ERROR LIMIT: an error measured elsewhere, at most LIMIT
outcome() {
	near "$1 | $2 | $3 | $4" "$4" 0 "$5"
}

# scene NAME EXPECTATION WANT TOLERANCE GOT: a number within its tolerance
scene() {
	error=$(awk -v g="$5" -v w="$3" 'BEGIN { if (g !~ /^[-+]?[0-9.]/) print "none"
		else { d = g - w; printf "%.1e", d < 0 ? -d : d } }')
	outcome "$1" "$2" "$5" "$error" "$4"
}

# relative NAME EXPECTATION WANT TOLERANCE GOT: within its tolerance times what is wanted,
# or within its tolerance of 0
relative() {
	error=$(awk -v g="$5" -v w="$3" 'BEGIN { if (g !~ /^[-+]?[0-9.]/) print "none"
		else { d = (g - w) / (w == 0 ? 1 : w); printf "%.1e", d < 0 ? -d : d } }')
	outcome "$1" "$2" "$5" "$error" "$4"
}

# exactly NAME EXPECTATION WANT GOT: equal text, such as inf or nan
exactly() {
	is "$1 | $2 | $4 | 0" "$4" "$3"
}

# refused NAME STATUS PATTERN COMMAND...
refused() {
	name=$1
	shift
	fails "$name | refused in one line | status $1: $2 | none" "$@"
}

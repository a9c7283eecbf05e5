# shellcheck shell=sh
# scenes.sh - what scenes at the edge are told with; read it after tap.sh.  A description
# reads: scene | expectation | outcome | error

# scene NAME EXPECTATION WANT TOLERANCE GOT: a number within its tolerance
scene() {
	error=$(awk -v g="$5" -v w="$3" 'BEGIN { if (g !~ /^[-+]?[0-9.]/) print "none"
		else { d = g - w; printf "%.1e", d < 0 ? -d : d } }')
	near "$1 | $2 | $5 | $error" "$error" 0 "$4"
}

# relative NAME EXPECTATION WANT TOLERANCE GOT: within its tolerance times what is wanted,
# or within its tolerance of 0
relative() {
	error=$(awk -v g="$5" -v w="$3" 'BEGIN { if (g !~ /^[-+]?[0-9.]/) print "none"
		else { d = (g - w) / (w == 0 ? 1 : w); printf "%.1e", d < 0 ? -d : d } }')
	near "$1 | $2 | $5 | $error" "$error" 0 "$4"
}

# refused NAME STATUS PATTERN COMMAND...
refused() {
	name=$1
	shift
	fails "$name | refused in one line | status $1: $2 | none" "$@"
}

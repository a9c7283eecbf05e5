#!/bin/sh
#SBATCH --job-name=wearpipe
#SBATCH --array=0-9
#SBATCH --cpus-per-task=1
# slurm.sh - the members of an ensemble as a Slurm job array
#
# usage: sbatch [--array=0-LAST] scripts/slurm.sh COMMAND [DIR [PER]]
#
# Task K computes member K of the ensemble in DIR (default ensemble.d), PER realisations
# (default 10): COMMAND sees $FIRST and $COUNT.  A task whose member is whole ends at
# once, so that the same line may be submitted again after whatever happened.  When all
# are done, this checks the members, computes what may be missing and joins them:
#
#	ensemble -d DIR -n PER LAST+1 COMMAND >all
#
# COMMAND stands between single quotes; it is an argument, so that it may hold commas.
set -eu
: "${SLURM_ARRAY_TASK_ID:?run by sbatch, with --array}"
COMMAND=${1:?usage: sbatch [--array=0-LAST] slurm.sh COMMAND [DIR [PER]]}
dir=${2:-ensemble.d}
per=${3:-10}
K=$SLURM_ARRAY_TASK_ID
FIRST=$((K * per))
COUNT=$per
export K FIRST COUNT

fail() {
	echo "slurm.sh: member $K (FIRST=$FIRST): $1: $COMMAND" >&2
	exit 1
}
manifest() {
	echo "# an ensemble of wearpipe: the command, its checksum and size, realisations a member"
	printf '%s\n' "$COMMAND"
	printf '%s' "$COMMAND" | cksum
	echo "$per"
}
mkdir -p "$dir"
part=$dir/$K.part.$(uname -n).$$
trap 'rm -f "$part" "$part.err" "$part.sum"' EXIT
trap 'exit 143' HUP INT TERM
# Tasks that begin at the same time write the same manifest.
[ -s "$dir/manifest" ] || {
	manifest >"$part"
	mv "$part" "$dir/manifest"
}
manifest | cmp -s - "$dir/manifest" || fail "$dir belongs to another command"
if [ -s "$dir/$K.done" ] && [ -s "$dir/$K.sum" ] &&
	[ "$(cksum <"$dir/$K.done")" = "$(cat "$dir/$K.sum")" ]; then
	exit 0
fi
shell='sh'
! command -v bash >/dev/null 2>&1 || shell='bash -o pipefail'
# The pipeline is waited for, so that a task that is cancelled leaves at once.
$shell -c "$COMMAND" >"$part" 2>"$part.err" </dev/null &
status=0
wait $! || status=$?
cat "$part.err" >&2
[ "$status" = 0 ] || fail "exit status $status"
[ "$(head -c 4 "$part")" != .snd ] || fail "signals cannot be joined"
records --check "$part" >/dev/null || [ $? = 3 ] || fail "no whole stream"
cksum <"$part" >"$part.sum"
mv "$part.sum" "$dir/$K.sum"
mv "$part" "$dir/$K.done"

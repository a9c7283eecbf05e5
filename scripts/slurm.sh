#!/bin/sh
#SBATCH --job-name=wearpipe
#SBATCH --array=0-99
#SBATCH --cpus-per-task=1
# slurm.sh - an ensemble as a Slurm job array: ten realisations a task
#
#	sbatch --export=ALL,COMMAND='roughgen -f $FIRST -c 10 ... | bemcontact ...' scripts/slurm.sh
#	cat part.*      (the names are in order)
set -eu
: "${COMMAND:?give the pipeline in COMMAND; it uses FIRST}"
FIRST=$((${SLURM_ARRAY_TASK_ID:?run by sbatch} * 10))
export FIRST
part=part.$(printf %05d "$SLURM_ARRAY_TASK_ID")
bash -o pipefail -c "$COMMAND" >"$part.tmp"
mv "$part.tmp" "$part"

#!/bin/sh
# A sweep as a job array of Slurm, on nodes that share DIR: sh slurm.sh PLAN DIR [SHARDS] [TIME]
# A shard that its time limit ends goes on from its last chunk when this is given again.
set -eu
plan=$1 dir=$2 shards=${3:-64} time=${4:-04:00:00}
program=${DELTAZERO:-deltazero}

case $plan$dir$program in
*\'*) echo "slurm.sh: a path with a ' cannot be handed on" >&2 && exit 2 ;;
esac
mkdir -p "$dir"
array=$(sbatch --parsable --job-name=sweep --array="1-$shards" --cpus-per-task=1 --time="$time" \
    --output="$dir/slurm-%a.log" \
    --wrap="exec '$program' sweep '$plan' --out '$dir' --shard \$SLURM_ARRAY_TASK_ID/$shards --threads 1 --quiet")
# After the array, whatever became of it: the merge names the shards that are missing.
sbatch --job-name=sweep-merge --dependency="afterany:${array%%;*}" --time="$time" --output="$dir/slurm-merge.log" \
    --wrap="exec '$program' sweep '$plan' --out '$dir' --merge"

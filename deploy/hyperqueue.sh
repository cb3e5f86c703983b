#!/bin/sh
# A sweep as a task array of HyperQueue, whose server and workers run and share DIR: sh hyperqueue.sh PLAN DIR [SHARDS]
# A task whose worker is lost is started anew elsewhere, and goes on from its last chunk.
set -eu
plan=$1 dir=$2 shards=${3:-64}
program=${DELTAZERO:-deltazero}

mkdir -p "$dir"
# HyperQueue puts the number of the task into the environment, so a shell makes the argument of it.
# shellcheck disable=SC2016
hq submit --name sweep --array "1-$shards" --cpus 1 --crash-limit 20 --stdout none --stderr "$dir/hq-%{TASK_ID}.log" --wait \
    -- sh -c 'exec "$1" sweep "$2" --out "$3" --shard "$HQ_TASK_ID/$4" --threads 1 --quiet' \
    sweep "$program" "$plan" "$dir" "$shards"
"$program" sweep "$plan" --out "$dir" --merge

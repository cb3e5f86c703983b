#!/bin/sh
# A sweep in shards over the machines that GNU parallel knows, which share DIR: sh parallel.sh PLAN DIR [SHARDS] [SSHLOGINFILE]
# Without a file of machines: on this one. Given again, it makes what is missing.
set -eu
plan=$1 dir=$2 shards=${3:-8} machines=${4:-}
program=${DELTAZERO:-deltazero}

mkdir -p "$dir"
set -- -q --halt now,fail=1 --joblog "${dir%/}.joblog"
if [ -n "$machines" ]; then
    set -- "$@" --sshloginfile "$machines" --workdir .
fi
# A thread each: parallel starts as many shards at once as a machine has cores.
seq "$shards" | parallel "$@" "$program" sweep "$plan" --out "$dir" --shard "{}/$shards" --threads 1 --quiet
"$program" sweep "$plan" --out "$dir" --merge

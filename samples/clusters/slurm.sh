#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A batch as an array of Slurm jobs, a shard each:
#
#   INPUT=/data/ModelNet40 OUTPUT=/data/grids SHARDS=16 OPTIONS="-r 64" sbatch --array=0-15 slurm.sh
#
# A shard whose time runs out is queued again and goes on; so does all of it by the same command. FIRST is added to the
# numbers of the array, where there are more shards than an array may have jobs (MaxArraySize, often 1001):
#
#   FIRST=1000 ... SHARDS=2000 ... sbatch --array=0-999 slurm.sh
#SBATCH --job-name=voxmend
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=8
#SBATCH --mem=16G
#SBATCH --time=04:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@120
set -u
: "${INPUT:?the folder of meshes}" "${OUTPUT:?the folder of what is made}" "${SHARDS:?how many shards}"
shard=$((${FIRST:-0} + SLURM_ARRAY_TASK_ID))

# Two minutes before the end of its time it is told to finish what is in flight.
# shellcheck disable=SC2086 # the options are words
voxmend batch "$INPUT" -o "$OUTPUT" --shard "$shard/$SHARDS" -j "${SLURM_CPUS_PER_TASK:-1}" --progress never ${OPTIONS:-} &
child=$!
is_told=false
trap 'is_told=true; kill -TERM "$child"' TERM
while :; do
  wait "$child"
  status=$?
  kill -0 "$child" 2>/dev/null || break # a signal ends the waiting, not the child
done
if $is_told && [ "$status" -ne 0 ]; then
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}"
fi
exit "$status"

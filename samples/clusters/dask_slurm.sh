#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A batch over Dask within one job of Slurm: the first node has the scheduler too.
#
#   INPUT=/data/ModelNet40 OUTPUT=/data/grids SHARDS=64 OPTIONS="-r 64" sbatch --nodes=4 dask_slurm.sh
#SBATCH --job-name=voxmend-dask
#SBATCH --ntasks-per-node=1
#SBATCH --cpus-per-task=8
#SBATCH --mem=16G
#SBATCH --time=04:00:00
set -eu
: "${INPUT:?the folder of meshes}" "${OUTPUT:?the folder of what is made}" "${SHARDS:?how many shards}"
scheduler=$PWD/voxmend-dask-$SLURM_JOB_ID.json
trap 'kill $(jobs -p) 2>/dev/null; rm -f "$scheduler"' EXIT

dask scheduler --scheduler-file "$scheduler" &
srun --cpus-per-task="$SLURM_CPUS_PER_TASK" dask worker --scheduler-file "$scheduler" --nthreads 1 --memory-limit 0 &
# shellcheck disable=SC2086 # the options are words
python3 -m voxmend.batch "$INPUT" -o "$OUTPUT" --dask "$scheduler" --shards "$SHARDS" -- ${OPTIONS:-}

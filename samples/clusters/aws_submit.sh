#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# A batch as an array of AWS Batch, a shard each. The job definition names the image and the file system.
#
#   QUEUE=my-queue SHARDS=16 RESOLUTION=64 aws_submit.sh
set -eu
: "${QUEUE:?the job queue}" "${SHARDS:?how many shards, 2 to 10000}"
aws batch register-job-definition --cli-input-json "file://$(dirname "$0")/aws_job_definition.json"
aws batch submit-job --job-name voxmend --job-queue "$QUEUE" --job-definition voxmend --array-properties "size=$SHARDS" \
  --parameters "shards=aws/$SHARDS,resolution=${RESOLUTION:-64}"

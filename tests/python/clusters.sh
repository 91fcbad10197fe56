#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The samples for clusters: they are whole, and the commands in them do what they are to do.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c "import yaml" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no yaml (Debian: python3-yaml)"
  exit 77
fi
clusters=$SRCDIR/samples/clusters
for script in "$clusters"/*.sh; do
  bash -n "$script"
done
PATH=$BUILDDIR:$PATH
mkdir in
cp cube.off sphere.off torus.off soup.off in
voxmend batch in -o wanted -r 16 --progress never >/dev/null

# Slurm's script, as an array would run it; then with numbers that begin elsewhere.
INPUT=in OUTPUT=slurm SHARDS=3 OPTIONS='-r 16' SLURM_CPUS_PER_TASK=1 SLURM_ARRAY_JOB_ID=7
export INPUT OUTPUT SHARDS OPTIONS SLURM_CPUS_PER_TASK SLURM_ARRAY_JOB_ID
for SLURM_ARRAY_TASK_ID in 0 1; do
  export SLURM_ARRAY_TASK_ID
  bash "$clusters/slurm.sh" >/dev/null
done
FIRST=2 SLURM_ARRAY_TASK_ID=0 bash "$clusters/slurm.sh" >/dev/null
cmp slurm/sphere.binvox wanted/sphere.binvox
voxmend batch verify slurm >/dev/null
# One that is told that its time runs out is queued again, and only then.
mkdir bin
printf '#!/bin/sh\necho "$@" >>requeued\n' >bin/scontrol
printf '#!/bin/sh\ntrap "exit 1" TERM\nwhile :; do sleep 0.1; done\n' >bin/voxmend
chmod +x bin/*
SLURM_ARRAY_TASK_ID=5 PATH=$PWD/bin:$PATH bash "$clusters/slurm.sh" &
script=$!
sleep 1
kill -TERM "$script"
! wait "$script"
[ "$(cat requeued)" = "requeue 7_5" ]
! SLURM_ARRAY_TASK_ID=9 PATH=$PWD/bin:$PATH SHARDS=3 INPUT= bash "$clusters/slurm.sh" 2>/dev/null
[ "$(cat requeued)" = "requeue 7_5" ]

# The commands of the others, with the folders of this test.
cat >commands.py <<'END'
import json, os, subprocess, sys
import yaml
folder = sys.argv[1]

def run(words, output, variable, count):
    for index in range(count):
        here = [{"/data/in": "in", "/data/out": output, "64": "16"}.get(word, word) for word in words]
        done = subprocess.run(here, env=dict(os.environ, **{variable: str(index)}), capture_output=True, text=True)
        assert done.returncode == 0, (here, done.stderr)

with open(os.path.join(folder, "kubernetes.yaml")) as file:
    job = yaml.safe_load(file)
assert (job["kind"], job["apiVersion"], job["spec"]["completionMode"]) == ("Job", "batch/v1", "Indexed")
pod = job["spec"]["template"]["spec"]
words, count = pod["containers"][0]["command"], job["spec"]["completions"]
assert "kubernetes/%d" % count in words
assert {mount["name"] for mount in pod["containers"][0]["volumeMounts"]} == {volume["name"] for volume in pod["volumes"]}
assert words[words.index("-j") + 1] == pod["containers"][0]["resources"]["limits"]["cpu"]
run(words, "kubernetes", "JOB_COMPLETION_INDEX", count)

with open(os.path.join(folder, "aws_job_definition.json")) as file:
    job = json.load(file)
values = {"Ref::" + name: value for name, value in job["parameters"].items()}
words = [values.get(word, word) for word in job["containerProperties"]["command"]]
assert not any(word.startswith("Ref::") for word in words)
run(words, "aws", "AWS_BATCH_JOB_ARRAY_INDEX", 16)
END
"$PYTHON" commands.py "$clusters"
for made in kubernetes aws; do
  cmp $made/torus.binvox wanted/torus.binvox
  [ -f $made/summary.json ]
done

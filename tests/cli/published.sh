#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend bench on an OpenCL device: the published program and the transfers of voxels. Skipped without a device.
. "$SRCDIR/tests/cli/lib.sh"
without_leak_check
quick='--time 0 --threads 1'
if ! voxmend voxelize in/cube.off -o c.npy -r 8 -q --engine opencl 2>why.txt; then
  cat why.txt
  exit 77
fi

# results OPTION...: phase, engine, resolution, bytes and voxels of each measurement.
results() {
  voxmend bench "$@" $quick --json |
    sed -n -E '/results/,/left_out/s/^ *"(phase|engine|resolution|bytes|voxels)": ([^,]*),?$/\2/p' | paste -d ' ' - - - - -
}

# left OPTION...: what is left out, and why.
left() {
  voxmend bench "$@" $quick | sed -n -E 's/ +/ /g; s/about [0-9.e+-]+ s/about N s/; s/by [0-9.e+-]+ s/by N s/; /left out/p'
}

run 'results in/rocket.off -r 9,24 --engine opencl --phases published,transfer'
run 'results in/rocket.off -r 8 --engine cpu,opencl,opencl/tiles --phases transfer,surface_conservative'
run 'results in/torus.off -r 8 --engine opencl | cut -d " " -f 1 | paste -s -d " " -'
run 'results in/torus.off -r 8 --engine opencl --phases solid,transfer_map | cut -d " " -f 1 | paste -s -d " " -'
run 'results in/torus.off -r 8 | grep -c -E "published|transfer"'

say "# as a file; the stages of tiles and octrees"
figures() {
  sed -E 's/_ms": [0-9][0-9.e+-]*/_ms": T/; s/"(work_group|profiled|pairs|tiles)": [^,]*/"\1": N/'
}
for approach in faieghi faieghi-voxels; do
  run "voxmend voxelize in/rocket.off -o $approach.npy --voxel-size 0.2 --engine opencl --baseline $approach --json | figures | sed -n '/\"dims\"/,/]/p; /\"baseline\"/,/}/p; /\"voxels\"/p'"
done
run 'cmp faieghi.npy faieghi-voxels.npy'
run 'voxmend bench in/torus.off -r 64 --engine opencl/tiles --phases solid_x,sparse $quick --json | figures | grep -A 9 "\"figures\""'

say "# what is left out"
run 'left in/torus.off -r 512 --engine opencl --phases memset,transfer_map --memlimit 24M | sed "s/:.*/: .../"'
run 'left in/torus.off -r 8 --phases memset,transfer,published_facets'
run 'voxmend bench in/torus.off -r 8 --phases transfer $quick'
run 'voxmend bench in/torus.off -r 8 --phases transfers --engine opencl $quick 2>&1 | cut -c 1-60'
run 'voxmend bench in/torus.off -r 8,16 --engine cpu,opencl --phases solid_x,transfer $quick | grep -A 9 "^opencl, " | sed -E "s/[0-9.]+ [KMG]iB/N MiB/g; s/[0-9]+\.[0-9]+/N/g; s/ +/ /g"'
finish

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Engines: what holds on every machine, whatever drivers it has.
. "$SRCDIR/tests/cli/lib.sh"
without_leak_check
run 'voxmend engines | head -n 1'
run 'voxmend engines --json | grep -c "\"name\": \"opengl"  | grep -c "[1-9]"'
run 'voxmend engines in/cube.off'
run 'voxmend voxelize in/cube.off -o c.npy -r 8 --engine cpu'
run 'voxmend voxelize in/cube.off -o c.npy -r 8 --engine cpu --json | grep -A 4 engine'
run 'voxmend voxelize in/cube.off -o c.npy -r 8 --engine auto -q'
run 'voxmend voxelize in/cube.off -o c.npy -r 8 --engine auto --json | grep -c "\"note\""'
run 'voxmend voxelize in/cube.off -o d.npy --engine vulkan'
run 'ls d.npy'
run 'voxmend voxelize in/cube.off -o d.npy --gl-method slices'
run 'voxmend voxelize in/cube.off -o d.npy --engine cpu --gl-axis x'
run 'voxmend voxelize in/cube.off -o d.npy --engine opengl --gl-axis x'
run 'voxmend voxelize in/cube.off -o d.npy --engine opengl --gl-method lines'
run 'voxmend voxelize in/cube.off -o d.npy --engine opengl --gl-method slices --gl-axis w'
run 'voxmend voxelize in/cube.off -o d.npy --engine opengl --gl-method slices --gl-displace -1'
run 'voxmend voxelize in/cube.off -o d.npy --engine opengl --gl-method slices --gl-displace 1,x'
run 'voxmend engines --json | grep -c "\"name\": \"opencl"  | grep -c "[1-9]"'
run 'voxmend voxelize in/cube.off -o d.npy --device 0'
run 'voxmend voxelize in/cube.off -o d.npy --engine opengl --cl-method tiles'
run 'voxmend voxelize in/cube.off -o d.npy --engine opencl --gl-method columns'
run 'voxmend voxelize in/cube.off -o d.npy --engine opencl --cl-method fast'
run 'voxmend voxelize in/cube.off -o d.npy --engine opencl:0 --device 0'
run 'voxmend bench in/cube.off -r 8 --engine cpu/tiles'
run 'voxmend bench in/cube.off -r 8 --engine opencl/columns'

say "# colours"
for by in noise position part; do
  for format in npy ply vox; do
    run "voxmend voxelize in/l_prism.off -o $by.$format -r 12 --color $by -q && cksum <$by.$format"
  done
done
run 'voxmend voxelize in/l_prism.off -o c.vox -r 300x20x20 --fit tight --color position | grep -E "^(colour|output)"'
run 'voxmend voxelize in/cube.off -o c.npy -r 4 --color position --json | grep -A 3 -E "color|voxels"'
run 'voxmend voxelize in/cube.off -o d.npy --color red'
run 'voxmend voxelize in/cube.off -o d.npy --color none.frag'
echo 'vec3 color(vec3 p, vec3 u, uint part) { return u; }' >plain.frag
run 'voxmend voxelize in/cube.off -o d.npy --color plain.frag'
run 'voxmend voxelize in/cube.off -o d.binvox --color part'
run 'voxmend voxelize in/cube.off -o d.npy --color part --labels part'
finish

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend voxelize --engine opengl, in every context that this machine has: the bits of the CPU. Skipped without any.
. "$SRCDIR/tests/cli/lib.sh"
contexts=
for context in osmesa egl-surfaceless egl-device0; do
  if voxmend voxelize in/cube.off -o c.npy -r 8 -q --engine "opengl:$context" 2>>why.txt; then
    contexts="$contexts $context"
  fi
done
if [ -z "$contexts" ]; then
  cat why.txt
  exit 77
fi

# same OPTION...: whether each context makes the file that the CPU makes.
same() {
  voxmend voxelize "$@" -o cpu.npy -q
  for context in $contexts; do
    voxmend voxelize "$@" -o gl.npy -q --engine "opengl:$context" $tuned
    cmp cpu.npy gl.npy
  done
}
tuned=
# Bits of all kinds of grids are held by tests/gpu; here, that each option reaches the engine.
run 'same in/cube.off -r 64'
run 'same in/missing.off -r 48 --vote all --parts group'
run 'same in/rocket.off -r 50x40x90 --mode both --surface thin'
run 'same in/rocket.off -r 64 --mode surface --surface shell18'
run 'same in/rocket.off -r 41x30x20 --coverage 8'
run 'same in/missing.off -r 40 --method winding'
run 'same in/rocket.off -r 300 --memlimit 64M'
for tuned in '--gl-method slices' '--gl-method slices --gl-axis x' '--gl-method tetra-vertex --gl-axis z'; do
  run "same in/rocket.off -r 33 # $tuned"
done
tuned=
run 'voxmend voxelize in/rocket.off -o a.npy -r 64 --engine opengl | sed -E "s/opengl:[a-z0-9-]+ on .*/opengl:CONTEXT on RENDERER/"'
run 'voxmend voxelize in/rocket.off -o a.npy -r 64 -q --engine opengl --gl-method slices --gl-displace 2,7'
run 'voxmend voxelize in/rocket.off -o b.npy -r 64 -q --engine opengl --gl-method slices --gl-displace 2,7'
run 'voxmend voxelize in/rocket.off -o c.npy -r 64 -q --engine opengl --gl-method slices --gl-displace 2,8'
run 'cmp a.npy b.npy'
run 'cmp -s a.npy c.npy'
run 'voxmend voxelize in/rocket.off -o b.npy -r 64 -q --engine opengl --gl-method slices --gl-displace 2,7 --thin drop 2>/dev/null; cmp a.npy b.npy'
say "# variants: a vertex shader moves and displaces the points, tetrahedra are cut slice by slice"
all='--rotate any --scale 0.5 --displace 0.02 --mirror xyz --translate 1'
run "voxmend augment in/rocket.off -o - -n 6 -r 48 $all -q >cpu.bin"
for tuned in '--gl-method columns' '--gl-method slices --gl-axis x' '--gl-method tetra-vertex'; do
  run "voxmend augment in/rocket.off -o - -n 6 -r 48 $all -q --engine opengl $tuned | cmp - cpu.bin && echo equal"
done
run 'voxmend augment in/rocket.off -o x --gl-method slices'
say "# the bench compares"
run 'voxmend bench in/rocket.off -r 24 --phases solid_vote,surface_thin --engine cpu,opengl --time 0 --threads 1 --json |
  sed -n -E "s/^ *\"(phase|engine|voxels)\": //p" | paste -d " " - - -'
run 'voxmend bench in/rocket.off -r 8,16 --phases solid_x --engine cpu,opengl --time 0 --threads 1 |
  grep -A 2 "^opengl" | sed -E "s/ [0-9.]+\.[0-9]+/ N/g; s/ +/ /g"'
run 'voxmend bench in/rocket.off -r 8 --phases solid_x --engine cpu,opengl --time 0 --threads 1 -q --plot p.svg && grep -c "<polyline" p.svg'

say "# colours"
cat >stripes.frag <<'GLSL'
vec3 color(vec3 position, vec3 unit, uint part) {
  return vec3(step(0.5, fract(position.z * 4.0)), 0.5 + 0.5 * noise(unit * 9.0), float(part) / 15.0);
}
GLSL
echo 'vec3 color(vec3 position, vec3 unit, uint part) { return vec3(unit.w); }' >ill.frag
run 'voxmend voxelize in/rocket.off -o s.npy -r 32 --color stripes.frag --engine opengl | grep -E "^(colour|voxels)"'
run 'voxmend voxelize in/rocket.off -o s.ply -r 16 --color stripes.frag --engine opengl -q'
run 'voxmend voxelize in/rocket.off -o s.vox -r 16 --color stripes.frag --engine opengl -q'
run 'head -c 4 s.vox; voxmend info s.ply | sed -n 2,4p'
run 'voxmend voxelize in/rocket.off -o t.npy -r 32 --color ill.frag --engine opengl 2>&1 | cut -c 1-50'
run 'ls t.npy'

run 'voxmend voxelize in/rocket.off -o c.npy -r 64 --engine opengl --memlimit 1M'
finish

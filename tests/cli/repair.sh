#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend repair: table, JSON, formats, options, and nothing left behind after a failure.
. "$SRCDIR/tests/cli/lib.sh"
run 'voxmend repair in/doubled.off -o doubled.ply'
run 'voxmend info doubled.ply'
run 'voxmend repair in/degenerate.off -o degenerate.off && cat degenerate.off'
run 'voxmend repair in/nonfinite.off -o nonfinite.obj --json && cat nonfinite.obj'
run 'voxmend repair in/cracks.off -o cracks.off -q && voxmend info cracks.off'
run 'voxmend repair in/cracks.off -o off.off -q --weld off && voxmend info off.off'
run 'voxmend repair in/cracks.off -o eps.off -q --weld 1e-6 && voxmend info eps.off'
run 'voxmend repair in/repeated.off -o kept.off -q --keep-duplicates && voxmend info kept.off'
run 'voxmend repair in/l_prism.off -o l.stl --ascii -q && voxmend info l.stl'
run 'voxmend repair in/l_prism.off -o l.obj --ascii -q && voxmend repair in/l_prism.off -o text.obj -q && cmp l.obj text.obj'
run 'voxmend repair in/rocket.off -o rocket.stl --ascii -q && voxmend repair rocket.stl -o rocket2.stl --ascii && cmp rocket.stl rocket2.stl'
run 'voxmend repair in/rocket.off -o binary.stl -q && voxmend repair binary.stl -o text.stl --ascii -q && cmp rocket.stl text.stl'
# what others write: more digits than a float has, and the fewest that tell a float
printf 'solid\n' >digits.stl
for x in 0.1 0.12345678901234567; do
  printf 'facet normal 0 0 0\nouter loop\nvertex %s 0 0\nvertex 1 0.3 0\nvertex 0 1 0.7\nendloop\nendfacet\n' $x
done >>digits.stl
echo endsolid >>digits.stl
run 'voxmend repair digits.stl -o once.stl --ascii -q && voxmend repair once.stl -o again.stl --ascii && cmp once.stl again.stl && cat once.stl'
run 'voxmend repair in/l_prism.off -o l.anything --format ply --ascii -q && cat l.anything'

say "# once repaired, nothing is left to do"
run 'voxmend repair in/rocket.off -o once.off'
run 'voxmend repair once.off -o twice.off'
run 'cmp once.off twice.off'

say "# polygons that are bent"
# a ring of quads, whose positions floats hold: the triangles that are written have the same voxels
awk 'BEGIN {
  for (r = 0; r < 14; r++)
    for (s = 0; s < 8; s++) {
      across = 10 + 4 * cos(s * 0.785398) + (r * 7 + s * 5) % 11 / 4
      printf "v %.6f %.6f %.6f\n", int(64 * across * cos(r * 0.448799)) / 64, int(64 * across * sin(r * 0.448799)) / 64,
        int(256 * sin(s * 0.785398)) / 64 + (r * 3 + s * 7) % 13 / 8
    }
  for (r = 0; r < 14; r++)
    for (s = 0; s < 8; s++)
      print "f", r * 8 + s + 1, (r + 1) % 14 * 8 + s + 1, (r + 1) % 14 * 8 + (s + 1) % 8 + 1, r * 8 + (s + 1) % 8 + 1
}' >bent.obj
run 'voxmend voxelize bent.obj -o bent.npy -q -r 40 && voxmend repair bent.obj -o bent.stl -q &&
  voxmend voxelize bent.stl -o again.npy -q -r 40 && cmp bent.npy again.npy && voxmend info bent.stl'

say "# small components"
run 'voxmend repair in/overlapping.off -o all.off -q --polygons keep && voxmend repair all.off -o one.off --drop-parts faces:7 --polygons keep'
run 'voxmend repair in/rocket.off -o large.off -q --drop-parts faces:50 && voxmend info large.off'
run 'voxmend repair in/cavity.off -o hollow.off -q --drop-parts volume:2 && voxmend info hollow.off'
run 'voxmend repair in/cavity.off -o both.off -q --drop-parts volume:0.5 --drop-parts faces:6 --polygons keep && cmp both.off in/cavity.off'
run 'voxmend repair in/cube.off -o x.off --force --drop-parts 50'
run 'voxmend repair in/cube.off -o x.off --force --drop-parts faces:0'
run 'voxmend repair in/cube.off -o x.off --force --drop-parts volume:much'

say "# something far off"
awk 'NR == 2 { print $1 + 3, $2 + 1, 0; next } NF == 3 { at++ } { print } at == 8 && NF == 3 { print "1e9 0 0\n1000000001 0 0\n1e9 1 0" } END { print "3 8 9 10" }' in/cube.off >outlier.off
run 'voxmend repair outlier.off -o inlier.off -q --strict'
run 'voxmend voxelize outlier.off -o outlier.npy -r 8 --strict'
sed 's/^1e9/1e20/' outlier.off >beyond.off
run 'voxmend info beyond.off'

say "# streams"
run 'voxmend repair - -o - --format off <in/unused.off'
run 'voxmend repair in/cube.off -o - --format obj -q | voxmend info -'

say "# failures leave nothing"
mkdir out
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' >flat.off
run 'voxmend repair flat.off -o out/x.off'
printf 'OFF\n2 0 0\n0 0 0\n1 0 0\n' >points.off
run 'voxmend repair points.off -o out/x.off'
run 'voxmend voxelize points.off -o out/x.npy'
awk 'NR > 2 && NF == 3 { printf "%.17g %.17g %.17g\n", $1 + 1e9, $2 + 1e9, $3 + 1e9; next } { print }' in/cube.off >far.off
run 'voxmend repair far.off -o out/x.stl'
run 'voxmend repair missing.off -o out/x.off'
run 'voxmend repair in/cube.off -o no/such/x.off'
run 'voxmend repair in/torus.off -o out/x.off --memlimit 64K'
run 'voxmend repair in/cube.off -o out/x.off --report no/such/r.json'
run 'voxmend repair in/cube.off -o - --format off >/dev/full'
run 'ls out'

say "# what asks for a module says which one is missing"
# without COMMAND...: voxmend where no module is installed
without() {
  VOXMEND_MODULES=$work/none "$VOXMEND" "$@"
}
run 'without repair in/cube.off -o a.ply --force --level closed -q'
for option in '--level solid' --union '--wrap 0.1' --intersections; do
  run "without repair in/cube.off -o a.ply --force $option"
done
run 'without info in/cube.off --intersections'
finish

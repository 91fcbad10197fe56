#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What repair and info do with the module for CGAL: self-intersections, unions, wraps, smooth fillings.
. "$SRCDIR/tests/cli/lib.sh"
[ -e "$BUILDDIR/.libs/voxmend-cgal.so" ] || exit 77

# box NAME X Y Z SIDE FIRST: a cube with an edge of SIDE, whose vertices begin with number FIRST
box() {
  awk -v name="$1" -v x="$2" -v y="$3" -v z="$4" -v s="$5" -v n="$6" 'BEGIN {
    print "o " name
    for (i = 0; i < 8; i++)
      printf "v %g %g %g\n", x + s * (i % 2), y + s * (int(i / 2) % 2), z + s * int(i / 4)
    split("1 3 4 2  5 6 8 7  1 2 6 5  3 7 8 4  1 5 7 3  2 4 8 6", c, " +")
    for (i = 1; i <= 24; i += 4)
      printf "f %d %d %d %d\n", n + c[i] - 1, n + c[i + 1] - 1, n + c[i + 2] - 1, n + c[i + 3] - 1
  }'
}
# facts: the lines of a summary that tell most
facts() {
  grep -E '^  (faces|components|boundary|closed|volume|self|inconsistent|union|wrap|closing|[a-z]+ +[0-9]+ +[0-9]+ +[0-9])|^Level|could not|were not|by fans'
}

box left 0 0 0 2 1 >left.obj
box right 1 1 1 2 9 >right.obj
cat left.obj right.obj >two.obj
{
  cat two.obj
  printf 'o plate\nv -1 -1 1.5\nv 5 -1 1.5\nv 2 5 1.5\nf 17 18 19\n'
} >plate.obj

say "# --intersections"
run 'voxmend info two.obj --intersections | facts'
run 'voxmend info two.obj --intersections --list 1 --json | grep -A 40 self_intersections'
run 'voxmend info two.obj plate.obj left.obj --intersections --json | grep -E "file|self"'
printf 'OFF\n4 2 0\n0 0 0\n1 0 0\n0 nan 0\n0 0 1\n3 0 1 3\n3 0 1 2\n' >nan.off
run 'voxmend info nan.off --intersections | facts'
run 'voxmend info two.obj --intersections --locate where.ply -q && grep -c "^3 .* 220 20 60" where.ply'
run 'voxmend repair two.obj -o a.ply --force --intersections --max-change 0.001 --json -q | grep self'

say "# --union"
run 'voxmend repair two.obj -o a.ply --force --union | facts'
run 'voxmend repair plate.obj -o a.obj --force --union | facts'
run 'voxmend info -v a.obj --intersections | facts'
run 'voxmend repair plate.obj -o a.ply --force --union --json -q | grep -E "\"(name|union_failed|self_intersections|union_failures)\""'
run 'voxmend repair two.obj -o a.ply --force --union --max-change 0.01'
box inner 0.5 0.5 0.5 1 9 | cat left.obj - >nested.obj
run 'voxmend repair nested.obj -o a.ply --force --union | facts'
run 'voxmend repair nested.obj -o a.ply --force --union --keep-orientation | facts'

say "# united again, nothing changes: two cubes meet along an edge, which a third covers half of"
{
  cat left.obj
  box b 2 2 0 2 9
  box c 1 1 0 2 17 | awk '$1 == "v" && $4 == 2 { $4 = 1 } { print }'
} >edge.obj
run 'voxmend repair edge.obj -o a.off --union | facts'
run 'voxmend repair a.off -o b.off --union -q && cmp a.off b.off'

# two octahedra that cut through themselves and each other: beside slivers of their union vertices stay together
cat >crossed.off <<'END'
OFF
12 16 0
0.5 0.75 0.75  1 0.75 1  0 0.5 1  0.75 1 0  0.5 0.25 0.5  0.5 0 0.25
0.25 1 0.75  0.25 0.75 0.25  0.5 0.25 0  0.75 0.25 0.25  1 0.75 0.25  1 0.5 0.75
3 4 0 1  3 5 1 0  3 4 1 2  3 5 2 1  3 4 2 3  3 5 3 2  3 4 3 0  3 5 0 3
3 10 6 7  3 11 7 6  3 10 7 8  3 11 8 7  3 10 8 9  3 11 9 8  3 10 9 6  3 11 6 9
END
run 'voxmend repair crossed.off -o c.ply --level closed --union'
run 'voxmend repair crossed.off -o c.ply --level solid | facts'

say "# --level solid"
run 'voxmend repair two.obj -o a.ply --force --level solid | facts'
run 'voxmend repair two.obj -o a.stl --level solid | facts'
run 'voxmend repair plate.obj -o no.ply --force --level solid --sheets keep'
run 'test -e no.ply'
run 'voxmend repair plate.obj -o a.ply --force --level solid --sheets keep --best-effort | facts'
run 'voxmend repair plate.obj -o a.ply --force --level solid --thickness 0.25 | facts'
run 'voxmend repair plate.obj -o a.ply --force --level solid --drop-parts faces:2 | facts'
say "# a closed part without a volume, through a cube"
{
  cat left.obj
  printf 'o flat\nv -1 -1 1.5\nv 5 -1 1.5\nv 5 5 1.5\nv -1 5 1.5\nf 9 10 11\nf 9 11 12\nf 9 12 10\nf 10 12 11\n'
} >flat.obj
run 'voxmend repair flat.obj -o no.ply --force --level solid'
run 'voxmend repair flat.obj -o a.ply --force --level solid --fallback wrap:0.1 --json -q | grep -E "union_failures|wrapped_parts|\"reached\""'
run 'voxmend repair flat.obj -o a.ply --force --level solid --fallback wrapped'
run 'voxmend repair flat.obj -o a.ply --force --level closed --fallback wrap'
run 'voxmend repair nested.obj -o a.ply --force --level solid | facts'
say "# a cube upon a cube, one beside along an edge, and one at a corner"
box b 0 0 2 2 9 | cat left.obj - >upon.obj
box b 2 2 0 2 9 | cat left.obj - >beside.obj
box b 2 2 2 2 9 | cat left.obj - >corner.obj
for mesh in upon beside corner; do
  run "voxmend repair $mesh.obj -o a.ply --force --level solid | facts && voxmend info a.ply --intersections | facts"
done

say "# more than are counted"
awk 'BEGIN { n = 2060
  print "OFF"; print 6 * n, 2 * n, 0
  for (i = 0; i < n; i++) { x = (i + 0.5) / n; print x, -1, 0; print x, 2, 0; print x, 0.5, 1 }
  for (i = 0; i < n; i++) { y = (i + 0.5) / n; print -1, y, 0.1; print 2, y, 0.1; print 0.5, y, -1 }
  for (i = 0; i < 2 * n; i++) print 3, 3 * i, 3 * i + 1, 3 * i + 2 }' >comb.off
run 'voxmend info comb.off --intersections --report comb.json | grep self; grep self comb.json'
run 'voxmend repair comb.off -o a.ply --force --intersections --keep-orientation --report comb.json | grep "^  self"; grep -c at_least comb.json'

say "# --wrap"
run 'voxmend repair plate.obj -o a.obj --force --wrap 0.05,0.002 --level solid | facts'
run 'voxmend info -v a.obj | grep -E "tags|closed" && grep -c -E "^[og] (left|right|plate)" a.obj'
run 'voxmend repair plate.obj -o a.ply --force --wrap 0.05 --level solid --json -q | grep "\"name\""'
run 'voxmend repair plate.obj -o a.ply --force --wrap 0.0001 --memlimit 256M'
for option in '--fill smooth' '--fill-holes all' '--union' '--max-change 0.1'; do
  run "voxmend repair plate.obj -o a.ply --force --level closed --wrap 0.05 $option"
done
run 'voxmend repair two.obj -o a.ply --force --wrap 0'
run 'voxmend repair two.obj -o a.ply --force --wrap 0.05,2'

say "# --fill smooth"
awk 'NR == 2 { print $1, $2 - 6, $3; next } { print }' in/sphere.off | head -n -6 >open.off
run 'voxmend info open.off | facts'
run 'voxmend repair open.off -o a.ply --force --level closed --fill smooth | facts'
run 'voxmend repair open.off -o a.ply --force --level solid --fill smooth | facts'
run 'voxmend repair two.obj -o a.ply --force --fill smooth'
say "# an octahedron: two holes touch at a vertex, where their rim passes twice"
printf 'OFF\n6 6 0\n1 0 0\n0 1 0\n-1 0 0\n0 -1 0\n0 0 1\n0 0 -1\n3 1 2 4\n3 3 0 4\n3 1 0 5\n3 2 1 5\n3 3 2 5\n3 0 3 5\n' >twice.off
run 'voxmend repair twice.off -o a.ply --force --level closed --fill smooth | facts; voxmend repair a.ply -o b.ply --level closed --fill smooth -q && cmp a.ply b.ply'
run 'voxmend repair twice.off -o a.ply --force --level closed --fill smooth --json -q | grep -E "(unfilled_holes|fan_fallbacks)"'
finish

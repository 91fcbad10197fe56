#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend repair: levels, what keeps one from being reached, what was wrong and where, and how much may change.
. "$SRCDIR/tests/cli/lib.sh"

say "# an open box"
sed -e '2s/.*/8 5 0/' -e '$d' in/cube.off >open.off
run 'voxmend repair open.off -o closed.off --level closed -q && voxmend info closed.off | grep -E "boundary|watertight"'
run 'voxmend repair open.off -o x.off --force --level closed --fill-holes 3 --sheets keep'
run 'voxmend repair open.off -o x.off --force --level closed --fill-holes 3 --sheets keep --json -q | grep -A 20 verified'
run 'grep -c . x.off'
run 'voxmend repair open.off -o x.off --force --level closed --fill-holes 3 --sheets keep -q --report r.json; grep -A 4 verified r.json'
run 'voxmend repair open.off -o best.off --level closed --fill-holes 3 --sheets keep --best-effort -q && voxmend info best.off | grep boundary'
rm -f x.off r.json

say "# what was wrong, and where"
run 'voxmend repair open.off -o x.off --force --list 2'
run 'voxmend info open.off --list 9'
run 'voxmend info in/cube.off --list 9 | tail -2'
run 'voxmend repair open.off -o x.off --force --locate wrong.ply -q && ls *.ply && rm wrong.ply'
run 'voxmend repair open.off -o x.off --force --locate wrong.ply --level closed --fill-holes 3 --sheets keep -q; ls *.ply; rm wrong.ply'
run 'voxmend repair in/cube.off -o no/such.off --locate wrong.ply; ls *.ply'

say "# the picture takes no other file's place"
voxmend repair open.off -o in.ply -q
ln -s in.ply link.ply
ln in.ply hard.ply
for name in in.ply ./in.ply "$PWD/in.ply" link.ply hard.ply; do
  run "voxmend repair in.ply -o x.off --force --locate $(echo "$name" | sed "s|$PWD|\$PWD|")"
done
run 'voxmend info in.ply --locate ./in.ply'
run 'voxmend repair open.off -o new.ply --force --locate ./new.ply'
run 'voxmend repair open.off -o x.off --force --report new.ply --locate ../$(basename "$PWD")/new.ply'
run 'voxmend repair open.off -o new.ply --force --report ./new.ply'
run 'voxmend voxelize open.off -o new.npy --report ./open.off'
run 'voxmend info open.off --report open.off'
run 'ls new.ply'

say "# how much may change"
sed -e '5s/.*/4 4 5 1 0/' open.off >turned.off
awk 'NR == 2 { print "8 6 0" } NR > 2 && NR < 11 { print } NR == 1' in/cube.off >flip.off
tail -n 6 in/cube.off | awk 'NR == 3 { print $1, $2, $5, $4, $3; next } { print }' >>flip.off
run 'voxmend repair flip.off -o x.off --force --max-change 1e-9 --json | grep flipped'
{ echo OFF; echo 16 12 0; sed -n 3,10p in/cube.off; sed -n 3,10p in/cube.off; tail -n 6 in/cube.off
  tail -n 6 in/cube.off | awk '{ print $1, $2 + 8, $3 + 8, $4 + 8, $5 + 8 }'; } >twice.off
run 'voxmend repair twice.off -o x.off --force --max-change 1e-9 -q && voxmend info x.off | grep faces'
{ echo OFF; echo 16 12 0; sed -n 3,10p in/cube.off; sed -n 3,10p in/cube.off | awk '{ print $1 / 10 + 5, $2 / 10, $3 / 10 }'
  tail -n 6 in/cube.off; tail -n 6 in/cube.off | awk '{ print $1, $2 + 8, $3 + 8, $4 + 8, $5 + 8 }'; } >small.off
run 'voxmend repair small.off -o x.off --force --weld 0.3 --max-change 0.5'
refused() { # COMMAND...: what the report says, and that nothing else was written
  rm -f x.off x.json
  "$@" -o x.off --report x.json || echo "status $?"
  [ ! -e x.off ] || echo 'x.off is written'
  grep -E '"(output|refused|reached)"|"after"|"faces"' x.json
}
run 'refused voxmend repair small.off --weld 0.3 --max-change 0.5'
run 'voxmend repair small.off -o x.off --force --weld 0.3 --max-change 0.5 --locate found.ply --json -q | grep refused; ls found.ply'
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' >flat.off
run 'refused voxmend repair flat.off'
run 'refused voxmend repair open.off --level closed --fill-holes 3 --sheets keep'
run 'voxmend repair small.off -o x.off --force --drop-parts volume:0.5 --max-change 0.5 -q && voxmend info x.off | grep components'

say "# .stl: triangles and 32-bit floats"
printf 'OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 2 1 0\n' >pillow.off
run 'voxmend repair pillow.off -o pillow.stl'
edge() { # two unit cubes that share an edge along z, from a corner at $1 $1 $2
  { echo OFF; echo 16 12 0; for at in 0 1; do for v in 0 1 2 3 4 5 6 7; do
      echo "$(($1 + at + v % 2)) $(($1 + at + v / 2 % 2)) $(($2 + v / 4))"; done; done
    for at in 0 8; do for f in '0 2 3 1' '4 5 7 6' '0 1 5 4' '2 6 7 3' '0 4 6 2' '1 3 7 5'; do
      printf 4; for v in $f; do printf ' %d' $((v + at)); done; echo; done; done; }
}
edge 1000000 0 >edge.off
run 'voxmend repair edge.off -o edge.stl --level manifold --max-change 1e-6'
edge 1000000 1000000 >far.off
run 'voxmend repair far.off -o far.stl --level manifold'
run 'voxmend repair far.off -o far.ply --level manifold --max-change 1e-6 -q && voxmend info far.ply | grep -E "components|volume"'

say "# a closed standard output"
run 'voxmend repair in/cube.off -o - --format off >&-'
finish

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# binvox's command line: what it prints, how files are named, what is refused, and the command lines of public scripts.
. "$SRCDIR/tests/cli/lib.sh"
binvox() {
  "$BUILDDIR/binvox" "$@"
}
# What is said of voxels and files.
short() {
  grep -E '^(dimensions|counted|area|writing)'
}
run 'binvox --help'
run 'voxmend help binvox | head -n 3'
run 'voxmend help --table binvox'
run 'binvox -license'

say "# output and names"
run 'binvox -d 16 in/torus.off'
run 'binvox -d 16 -e in/torus.off | tail -n 2 && binvox in/torus.off -d 16 -e | tail -n 2'
run 'voxmend binvox -d 8 -t raw in/torus.off | tail -n 2'
mkdir a.b
cp in/cube.off a.b/model
run 'binvox -d 8 a.b/model | tail -n 2'
run 'cd a.b && binvox -d 8 -cb model | tail -n 2 && ls'
run 'head -n 5 in/torus.binvox | tr -d "\000-\011\013-\037\200-\377" | head -n 4'
run 'binvox -d 8 -o here.binvox in/cube.off | tail -n 2; binvox -d 8 -o here.binvox in/cube.off | tail -n 2; ls here*'
run 'binvox -d 8 -bb 0 0 0 3 2 1.5 in/cube.off'
run 'binvox -d 8 -rotx -rotz in/l_prism.off | head -n 7'

say "# the command lines of public scripts"
for name in mesh.ply mesh.stl mesh.obj; do
  voxmend repair in/star_prism.off -o $name -q
done
for words in '-d 24 -cb mesh.obj' '-pb -d 32 mesh.obj' '-e -d 20 -rotz -rotx -rotz -rotz -t vtk mesh.ply' '-e -d 20 -t vtk mesh.stl' \
  '-d 64 -dc -pb -down -down -dmin 2 mesh.obj' '-d 64 -e -pb -down -down -dmin 1 mesh.obj' '-d 32 -e -fit mesh.obj' \
  '-e -bb -1 -1 -1 1 1 1 -d 100 -rotx mesh.stl' \
  '-bb -0.5 -0.5 -0.5 0.5 0.5 0.5 -d 64 -e mesh.obj' '-c -d 30 -t msh mesh.stl' '-cb -d 24 mesh.obj' '-cb -e -d 24 mesh.obj' \
  '-rotx -rotx -rotz -aw -pb -e -d 24 mesh.obj' '-t nrrd -e -ri -d 25 mesh.stl' '-e -fit mesh.obj -d 40 -rotz -rotz -rotz -ri' \
  '-cb -mb -e -d 16 binvox mesh.stl' '-d 16 -e -bb -5 -5 -5 5 5 5 -t binvox -e -mb mesh.obj' \
  '-cb -bb -0.5 -0.5 -0.5 0.5 0.5 0.5 -rotz -rotz -rotz -rotx -pb -d 32 mesh.ply' '-d 20 -v -fit mesh.ply' \
  '-c -d 16 -e -t binvox -cb mesh.obj'; do
  run "binvox $words | short"
done

say "# what is refused"
for words in '' '-d 0 in/cube.off' '-d 8.5 in/cube.off' '-d' '-d 8 -bb 0 0 0 1 1' '-bb 0 0 0 1 0 1 in/cube.off' '-bb 0 0 0 1 nan 1 in/cube.off' \
  '-t mira in/cube.off' '-t hips in/cube.off' '-t stl in/cube.off' '-cd in/cube.off' '-rotX in/cube.off' '-nf 0.9 in/cube.off' '-rx in/cube.off' \
  '-ncs in/cube.off' '-dmin 9 in/cube.off' '-bi 256 in/cube.off' '-mb -t schematic in/cube.off' '-o in/cube.off in/cube.off' 'in' 'missing.off' \
  '-d 8 -o no/such/x in/cube.off'; do
  run "binvox $words"
done
run 'binvox -d 8 -o - in/cube.off'
run 'binvox -d 8 - <in/cube.off'
run 'binvox -d 8 -o from_input.binvox - <in/cube.off | short'
printf 'OFF 4 2 0\n-1e308 0 0\n1e308 0 0\n0 1e308 0\n0 -1e308 1e308\n3 0 1 2\n3 0 1 3\n' >huge.off
printf 'OFF 3 1 0\n1 2 3\n1 2 3\n1 2 3\n3 0 1 2\n' >point.off
printf 'OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >sheet.off
run 'binvox -d 8 huge.off | short'
run 'binvox -d 8 point.off | short'
run 'binvox -d 8 sheet.off | short; binvox -d 8 -e sheet.off | short; binvox -d 8 -v sheet.off | short; binvox -d 8 -v -fit -ri -down sheet.off | short'
run 'binvox -d 8 in/cube.off >/dev/full; ls in/cube*'
finish

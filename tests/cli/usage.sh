#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Help, version and wrong usage: exit status 2 with one line that names the option.
. "$SRCDIR/tests/cli/lib.sh"
run 'voxmend'
run 'voxmend --help'
run 'voxmend --version'
run 'voxmend -V'
run 'voxmend help'
run 'voxmend help engines'
run 'voxmend help --table'
run 'voxmend help --table compare'
run 'voxmend help hlep'
run 'voxmend help info repair'
run 'voxmend voxelise'
run 'voxmend --versoin'
run 'voxmend --nonsense'
run 'voxmend nonsense'
for command in info repair voxelize convert combine compare augment view bench; do
  run "voxmend $command --help"
done

say "# options"
run 'voxmend info'
run 'voxmend info --mode solid in/cube.off'
run 'voxmend info -z in/cube.off'
run 'voxmend info -qz in/cube.off'
run 'voxmend info --quiet=yes in/cube.off'
run 'voxmend info --threads'
run 'voxmend info --threads 0 in/cube.off'
run 'voxmend info --threads 2x in/cube.off'
run 'voxmend info --threads 257 in/cube.off'
run 'voxmend info --threads -1 in/cube.off'
run 'voxmend info --memlimit 5Q in/cube.off'
run 'voxmend info --memlimit 0 in/cube.off'
run 'voxmend info --memlimit 99999999999999T in/cube.off'
run 'voxmend info --progress sometimes in/cube.off'
run 'voxmend info --report - in/cube.off'
run 'voxmend info --force in/cube.off'

for option in --resoluton --resolutoin=64 --size --co --thim --overwrite --x --; do
  run "voxmend voxelize in/cube.off $option"
done

say "# folders"
mkdir -p empty mixed/inner
cp in/cube.off mixed/b.off
cp in/cube.off mixed/a.OFF
: >mixed/notes.txt
run 'voxmend info mixed'
run 'voxmend info mixed in/cube.off'
run 'voxmend voxelize mixed/ -o x.npy'
run 'voxmend voxelize empty -o x.npy'
run 'voxmend compare mixed/inner x.npy'
run 'voxmend view . -o x.png'

say "# repair"
run 'voxmend repair in/cube.off'
run 'voxmend repair -o x.off'
run 'voxmend repair in/cube.off in/torus.off -o x.off'
run 'voxmend repair in/cube.off -o x.dwg'
run 'voxmend repair in/cube.off -o x.npy'
run 'voxmend repair in/cube.off -o -'
run 'voxmend voxelize in/cube.off -o -'
run 'voxmend repair in/cube.off -o - --format off --json'
run 'voxmend repair in/cube.off -o x --format dwg'
run 'voxmend repair in/cube.off -o x.off --weld 0'
run 'voxmend repair in/cube.off -o x.off --weld -1'
run 'voxmend repair in/cube.off -o x.off --weld 1e-3x'
run 'voxmend repair in/cube.off -o x.off --weld nan'
run 'voxmend repair in/cube.off -o x.off --level perfect'
run 'voxmend repair in/cube.off -o x.off --fill soap'
for options in '--thickness 0' '--max-change -0' '--max-change 1e999' '--wrap 0.1 --keep-duplicates' '--wrap 0.1 --keep-orientation'; do
  run "voxmend repair in/cube.off -o x.off $options"
done

say "# voxelize"
run 'voxmend voxelize in/cube.off'
run 'voxmend voxelize -o x.npy'
run 'voxmend voxelize in/cube.off -o x.dwg'
run 'voxmend voxelize in/cube.off -o x.vox'
for option in '-r 0' '-r 8.5' '-r 8x8' '-r 8x8x8x8' '-r 8x8x' '-r 0x8' '-r -8' '-r 1048577' '-r 99999999999999999999' \
  '--voxel-size 0' '--voxel-size -1' '--voxel-size 1,5' '--voxel-size 1,5,0' '--voxel-size 1,1,1,1' '--voxel-size inf' '--voxel-size 0x1' '--voxel-size ""' \
  '--fit round' '--pad -1' '--pad 1.5' '--bounds 0,0,0,1,1' '--bounds 0,0,0,1,1,1,1' '--bounds 0,0,0,1,0,1' \
  '--bounds 0,0,0,1,1,nan' '--mode hollow' '--method w' '--vote most' '--parts some' '--thin 18' '--cavities some' '--labels some' '--weld near' \
  '--coverage 3' '--surface shell9' '--engine steam' '--hollow' '--scalar int' '--distance near' '--band -1' '--band x'; do
  run "voxmend voxelize in/cube.off -o x.npy $option"
done
for options in '-r 8 --voxel-size 1' '--like y.npy -r 8' '--like y.npy --pad 1' '--bounds 0,0,0,1,1,1 --pad 1' \
  '--bounds 0,0,0,1,1,1 --fit tight' '--method x --vote any' '--parts group --cavities fill' '--cavities auto --parts whole' \
  '--mode surface --method vote' '--mode surface --surface thin --vote any' '--distance unsigned --method x' '--distance unsigned --vote any' \
  '--distance unsigned --parts whole' '--distance unsigned --cavities keep' '--surface thin' '--mode solid --surface thin' '--mode both --surface shell6' '--mode surface --thin keep' '--mode surface --surface thin --thin drop' '--coverage 4 --thin keep' '--distance signed --thin 26' '--no-repair --weld off' '--no-repair --keep-duplicates' \
  '--coverage 4 --distance signed' '--scalar uint8' '--band 3' '--coverage 4 --confidence c.npy' '--labels part --dry-run' \
  '--confidence ./x.npy' '--coords in/../x.npy' \
  '--distance unsigned --mode surface' '--coverage 2 --format rle'; do
  run "voxmend voxelize in/cube.off -o x.npy $options"
done
run 'voxmend voxelize in/cube.off -o x.binvox --coverage 4'
run 'voxmend voxelize in/cube.off -o x.stl --polygons keep'
run 'voxmend repair in/cube.off -o x.stl --polygons keep'

say "# convert, compare, view"
run 'voxmend convert x.npy'
run 'voxmend convert x.npy -o y.png'
run 'voxmend compare x.npy'
run 'voxmend compare x.npy y.npy z.npy'
run 'voxmend view x.npy'
run 'voxmend view x.npy -o y.html'
run 'voxmend view x.npy -o y.png --size 800'
run 'voxmend view x.npy -o y.png --size 0x600'
run 'voxmend view x.npy -o y.png --azimuth north'
run 'voxmend view x.npy -o y.png --elevation 91'
run 'voxmend view x.npy -o y.png --up w'

say "# bench"
run 'voxmend bench'
run 'voxmend bench in/cube.off in/torus.off'
run 'voxmend bench -'
for option in '-r 0' '-r 64,' '-r ""' '-r 8x8x8' '-r 8,1048577' '--threads 0' '--threads 1,257' '--threads 2x' '--phases hollow' \
  '--phases load,,repair' '--engine gpu' '--time -1' '--time 5s' '--plot x.png' '--plot svg' '--phases load --plot x.svg' \
  '--plot x.svg --report x.svg' '--plot x.svg --report ./x.svg' '--mode solid'; do
  run "voxmend bench in/cube.off $option"
done
run 'ls'
finish

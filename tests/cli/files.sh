#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What is written never costs what is read, what is there already, or anybody's rights.
. "$SRCDIR/tests/cli/lib.sh"
cp in/cube.off rocket.off
cp in/cube.off other.off
run "voxmend voxelize rocket.off -o rocket.binvox -r 8 -q"
run "voxmend convert rocket.binvox -o rocket.raw -q"

# An output that is an input, by whatever name.
ln rocket.off hard.obj
ln -s rocket.off soft.ply
ln -s . here
run "voxmend repair rocket.off -o rocket.off"
run "voxmend repair rocket.off -o here/./rocket.off"
run "voxmend repair rocket.off -o hard.obj"
run "voxmend repair soft.ply -o rocket.off"
run "voxmend repair - -o rocket.off <rocket.off"
run "voxmend repair rocket.off -o - --format off 1<>rocket.off"
run "voxmend repair rocket.off -o fixed.off --locate soft.ply"
run "voxmend voxelize rocket.off -o rocket.off --force"
run "voxmend voxelize rocket.off -o a.npy --like rocket.binvox --coords rocket.npy --report rocket.binvox"
run "voxmend voxelize rocket.off -o rocket.binvox --like rocket.binvox"
run "voxmend convert rocket.binvox -o rocket.binvox"
run "voxmend compare rocket.binvox rocket.raw --report rocket.raw"
run "voxmend info rocket.off other.off --report other.off"
run "voxmend view rocket.off -o a.png --report soft.ply"
run "voxmend bench rocket.off --plot a.svg --report rocket.off"
printf '1 0 0 0 1 0 0 0 1' >turns
run "voxmend augment rocket.off -o many --rotate turns --report turns"
mkdir many
ln rocket.off many/000003.rle
run "voxmend augment rocket.off -o many -n 8 -r 8"
run "voxmend augment rocket.off -o many -n 3 -r 8 -q; ls many"
run "voxmend augment rocket.off -o many -n 3 -r 8 --report many/000001.rle"

# What belongs to an input; a file that only has the name of it does not.
run "voxmend convert rocket.raw -o b.npy --report rocket.raw.json"
run "voxmend convert rocket.binvox -o b.npy --report rocket.binvox.json -q"
run "voxmend convert rocket.binvox -o b.npy --report rocket.binvox.json -q"
printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"the%%20data.raw","byteLength":4}]}' >scene.gltf
printf abcd >'the data.raw'
run "voxmend voxelize scene.gltf -o 'the data.raw'"
# What is no code is part of the name.
printf '{"asset":{"version":"2.0"},"buffers":[{"uri":"the%% 5.raw"}]}' >scene.gltf
printf abcd >'the% 5.raw'
run "voxmend voxelize scene.gltf -o 'the% 5.raw'"
touch rocket.mtl coat.mtl
ln -s rocket.off rocket.obj
run "voxmend info rocket.obj --report rocket.mtl"

# Two outputs that are one, also where neither is there yet.
run "voxmend voxelize rocket.off -o new.npy --confidence here/new.npy"
run "voxmend voxelize rocket.off -o new.raw --report new.raw.json"
ln -s new.npy dangling
run "voxmend voxelize rocket.off -o dangling --format npy --coords new.npy"

# A surface does not replace a file that is there, but with --force.
run "voxmend convert rocket.binvox -o other.off"
run "voxmend voxelize rocket.off -o other.off"
run "voxmend voxelize rocket.off -o other.off --dry-run -q"
run "cmp other.off in/cube.off"
run "voxmend convert rocket.binvox -o surface.off -q"
run "voxmend convert rocket.binvox -o surface.off -q --force"
run "voxmend convert rocket.binvox -o - --format off 2>/dev/null | cmp - surface.off"
run "cmp rocket.off in/cube.off"

# Rights: of the file that is replaced, but never setuid, setgid and sticky; of a new one by the umask.
umask 027
run "voxmend convert rocket.binvox -o mode.rle -q; stat -c %a mode.rle"
chmod 7754 mode.rle
run "voxmend convert rocket.binvox -o mode.rle -q; stat -c %a mode.rle"
chmod 600 mode.rle
run "voxmend convert rocket.binvox -o mode.rle -q; stat -c %a mode.rle"
run "voxmend voxelize rocket.off -o dangling --format npy -r 8 -q --report report.json; stat -c '%a %F' dangling new.npy report.json"

# A failure late in a run costs nothing: what was there is there, and nothing else.
mkdir late
voxmend voxelize rocket.off -o late/a.raw -r 8 -q
cksum late/* >before
run "voxmend voxelize rocket.off -o late/a.raw -r 16 --coords late/a.npy --report /dev/full"
run "voxmend voxelize rocket.off -o late/a.raw -r 16 >/dev/full"
run "(ulimit -f 1; voxmend voxelize rocket.off -o late/a.npy -r 32 -q)"
run "(ulimit -f 1; voxmend augment rocket.off -o late/many -n 3 -r 64 --format npy -q)"
run "cksum late/* | cmp - before"

# Room on the disk is looked for before the work.
run "voxmend voxelize rocket.off -o huge.nrrd -r 4096x4096x1048576 -q 2>&1 | sed 's/and .* are free/and N are free/'"
run "test ! -e huge.nrrd"
run "(ulimit -f 8; voxmend augment rocket.off -o - -n 1000000 -r 1024 --format float32 >stream) 2>&1 | sed 's/and .* are free/and N are free/'"
finish

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend augment: the same variants as files and as a stream, with any number of threads, from any first one on; and what is
# refused. tests/api/test_sampler.c makes the variants of the checksum too.
. "$SRCDIR/tests/cli/lib.sh"
all='-r 32 --pad 1 --seed 1311768467463790320 --epoch 2 --rotate any --scale 0.5 --displace 0.03 --mirror xyz --translate 1'

# The summary without times and with N for the bytes of files, which differ between machines for no format.
timeless() {
  sed -E -e 's/^(time +).*/\1T/' -e 's/("(read|repair|prepare|make|total)": )[0-9][0-9.e+-]*/\1T/'
}

# record FILE SIZE NUMBER: the voxels of a record of so many bytes.
record() {
  tail -c +$((64 + $3 * ($2 + 16) + 16 + 1)) "$1" | head -c "$2"
}

say "# a stream"
run 'voxmend augment in/l_prism.off -o - -n 24 $all -q >a.bin; head -c 64 a.bin | od -A d -t u4 | head -n 5'
run 'tail -c +65 a.bin | head -c 16 | od -A n -t u4; tail -c +$((65 + 23 * 4112)) a.bin | head -c 16 | od -A n -t u4; wc -c <a.bin'
run 'cksum <a.bin; voxmend augment in/l_prism.off -o - -n 24 $all -q --thin drop | cksum'
run 'for t in 1 2 3; do voxmend augment in/l_prism.off -o - -n 24 $all -q --threads $t | cmp - a.bin && echo equal; done'
run 'voxmend augment in/l_prism.off -o - -n 3 --first 20 $all -q | tail -c +65 >b.bin; tail -c +$((65 + 20 * 4112)) a.bin | head -c $((3 * 4112)) | cmp - b.bin && echo equal'
run 'voxmend augment - -o - -n 24 $all -q <in/l_prism.off | cmp - a.bin && echo equal'
run 'voxmend augment in/l_prism.off -o - -n 0 $all -q --progress never | head -c 98752 | tail -c +65 | cksum; tail -c +65 a.bin | cksum'
run 'voxmend augment in/l_prism.off -o - -n 2 $all --format uint8 2>&1 >c.bin | timeless; wc -c <c.bin'
run 'voxmend augment in/l_prism.off -o - -n 2 $all --format float32 -q >d.bin; wc -c <d.bin'

say "# files: the same voxels"
run 'voxmend augment in/l_prism.off -o npy -n 2 $all --format npy | timeless; ls npy'
run 'for i in 0 1; do record c.bin 32768 $i >x; tail -c 32768 npy/00000$i.npy | cmp - x && echo equal; done; rm x'
run 'for f in rle raw binvox nrrd; do voxmend augment in/l_prism.off -o $f -n 2 $all --format $f -q; voxmend compare $f/000001.$f npy/000001.npy --json; done | grep iou'
run 'voxmend augment in/l_prism.off -o rle -n 2 --first 999999 $all -q; ls rle'
run 'voxmend augment in/l_prism.off -o shares -n 2 $all --coverage 4 -q; ls shares; voxmend augment in/l_prism.off -o - -n 2 $all --coverage 4 -q | tail -c +65 | cksum'
run 'voxmend augment in/l_prism.off -o halves -n 1 $all --coverage 2 --format nrrd -q && voxmend convert halves/000000.nrrd -o x.npy --threshold 128 -q && voxmend compare x.npy npy/000000.npy | tail -n 1'
for option in '--format rle' '--mode surface' '--thin keep' '-r 1025'; do run "voxmend augment in/l_prism.off -o shares -n 1 --coverage 4 $option"; done
run 'voxmend augment in/l_prism.off -o shares -n 1 --coverage 3'
run 'voxmend augment in/l_prism.off -o json -n 1 --json | timeless | sed -E "/peak_bytes|file_bytes/s/[0-9]+/N/"'

say "# several meshes: folders, or one stream"
mkdir -p set/chair/train set/table/test
cp in/l_prism.off set/chair/train/a.off
cp in/cube.off set/chair/train/b.off
cp in/torus.off set/table/test/c.off
echo 'OFF 1' >set/table/test/d.off
echo note >set/readme.md
run 'voxmend augment set -o many -n 2 $all --model 7 | timeless; find many -type f | LC_ALL=C sort; cat many/models.tsv'
run 'for m in chair/train/a:7 chair/train/b:8 table/test/c:9; do voxmend augment set/${m%:*}.off -o one -n 2 $all --model ${m#*:} -q --force; for i in 0 1; do cmp one/00000$i.rle many/${m%:*}/00000$i.rle && echo equal; done; done'
run 'voxmend augment set -o new -n 2 -r 8 --coverage 2 -q; find new -type f | LC_ALL=C sort'
run 'voxmend augment set/chair/train/a.off set/table/test/c.off -o - -n 3 $all --model 1 -q >m.bin; wc -c <a.bin; head -c 64 m.bin | od -A d -t u4 | sed -n 3p; for i in 0 2 3 5; do tail -c +$((65 + i * 4112)) m.bin | head -c 12 | od -A n -t u4; done'
run 'voxmend augment set/table/test/c.off -o - -n 3 $all --model 2 -q | tail -c +65 >b.bin; tail -c +$((65 + 3 * 4112)) m.bin | cmp - b.bin && echo equal'
run 'printf "set/chair/train/a.off\nset/table/test/c.off\n" >list.txt; for t in 1 2; do voxmend augment list.txt -o - -n 3 $all --model 1 -q --threads $t | cmp - m.bin && echo equal; done'
printf 'path,class,split\nset/chair/train/b.off,box,val\n' >table.csv
run 'voxmend augment table.csv -o listed -n 1 -r 8 -q --json | timeless | sed -E "/_bytes/s/[0-9]+/N/"; cat listed/models.tsv'
mkdir strange
cp in/cube.off "strange/$(printf 'a\tb\nc "d".off')"
run 'voxmend augment strange -o strange-out -n 1 -r 8 -q; cat strange-out/models.tsv; printf "path\tid\n\"strange/a\tb\nc \"\"d\"\".off\"\tagain\n" >strange.tsv; voxmend augment strange.tsv -o strange-again -n 1 -r 8 -q; cat strange-again/models.tsv'
run 'voxmend augment set -o - -n 2 -r 8 -q | wc -c'
cp set/table/test/d.off e.off
run 'voxmend augment set/table/test/d.off e.off -o none'
run 'ls -d none'
run 'voxmend augment "set/*/train/?.off" -o found -n 1 -r 8 -q; find found -type f | LC_ALL=C sort'
run 'voxmend augment set -o - -n 0'
run 'voxmend augment set -o x --model 4294967295'
run 'voxmend augment nothing.txt -o x'
printf 'path,options\nin/cube.off,-r 8\n' >options.csv
run 'voxmend augment options.csv -o x'
tar cf set.tar set
run "voxmend augment set.tar -o x 2>&1 | sed 's/: .*unpack it.*/: unpack it/'" # with libarchive, and without
run 'mkdir bare; voxmend augment bare -o x'

say "# a former run: refused, or replaced; further variants are none of it"
run 'voxmend augment in/cube.off -o again -n 3 -r 8 -q; voxmend augment in/cube.off -o again -n 1 --first 3 -r 8 --format npy -q; echo note >again/notes; ls again'
for options in '-n 2 -r 4' '-n 2 -r 4 --format binvox' '--first 2 -n 9' '--first 3 -n 1 --format raw'; do
  run "voxmend augment in/cube.off -o again $options"
done
run 'cksum again/* >before; voxmend augment in/nothing.off -o again -n 2 --force; cksum again/* | cmp - before'
run 'voxmend augment in/cube.off -o again -n 1 --first 2 -r 4 --force -q; ls again; for i in 1 2; do voxmend info again/00000$i.rle | grep "a grid"; done'
run 'voxmend augment in/cube.off -o again -n 2 -r 4 --format npy --force -q; ls again'
run 'voxmend augment set -o many -n 2 -r 8; voxmend augment set -o many -n 1 --first 2 -r 8 -q; voxmend augment set -o many -n 1 -r 8 --force -q; find many -type f | LC_ALL=C sort'
run 'cp in/cube.off again/000007.rle; voxmend augment again/000007.rle -o again -n 2 --force; voxmend augment in/cube.off -o - -n 1 --force'

say "# each augmentation"
printf '0 -1 0 1 0 0 0 0 1\n1,0,0, 0,0,-1, 0,1,0\n' >turns.txt
for option in '--rotate none' '--rotate x' '--rotate z' '--rotate 1,2,-2' '--rotate turns.txt' '--scale 0.3' '--displace 0.02' \
  '--displace 0.02,normal' '--displace 0.02 --noise 50' '--mirror y' '--translate 0.5 --pad 4' '--fill' '--pad 3' '--mode both' \
  '--mode surface' '--mode surface --surface shell6' '--thin drop --rotate x' '--thin 26 --rotate x' '--no-repair' '--weld off' '--model 7' '--keep-duplicates'; do
  run "voxmend augment in/l_prism.off -o - -n 4 -r 16 $option -q | tail -c +65 | cksum"
done
{ printf '\357\273\277'; cat turns.txt; } >marked.txt
run "voxmend augment in/l_prism.off -o - -n 4 -r 16 --rotate marked.txt -q | tail -c +65 | cksum"

say "# who makes them: the same bits"
run 'voxmend augment in/l_prism.off -o - -n 24 $all -q --engine cpu | cmp - a.bin && echo equal'
run 'voxmend augment in/l_prism.off -o - -n 2 -r 16 --engine cpu 2>&1 >/dev/null | grep engine'
for engine in opengl:osmesa opengl:egl-surfaceless opencl; do
  voxmend engines | grep -q "^$engine.* works" || continue
  voxmend augment in/l_prism.off -o - -n 24 $all -q --engine $engine | cmp - a.bin || say "$engine differs"
done
run 'voxmend augment in/l_prism.off -o x --engine cpu --device 0'
run 'voxmend augment in/l_prism.off -o x --engine vulkan'

say "# what is refused"
for options in '' '-o' '-o x -n -1' '-o x -n 0' '-o x -n 5000000000' '-o x --first 4294967295 -n 2' '-o x -r 0' '-o x -r 5000' '-o x --seed -3' \
  '-o x --rotate 0,0,0' '-o x --rotate no/such' '-o x --scale 1' '-o x --scale -0.1' '-o x --displace 2' '-o x --displace 0.1,uniform' \
  '-o x --displace 0.5' '-o x --mirror w' '-o x --translate 2' '-o x --fill --rotate any' '-o x --noise 5' '-o x --surface thin' \
  '-o x --mode both --surface shell6' '-o x --mode solid --surface thin' '-o x --mode surface --thin keep' '-o x --thin most' '-o x --format vdb' '-o - --format rle' '-o x --pad 32' \
  '-o - --json' '-o x --no-repair --weld off' '-o no/such/x' '-o in/cube.off'; do
  run "voxmend augment in/l_prism.off $options"
done
printf '1 0 0 0 1 0 0 0\n' >short.txt
printf '1 0 0 0 1 0 0 0 one\n' >word.txt
printf '1 0.5 0 0 1 0 0 0 1\n' >shear.txt
printf '1 0 0 0 1 0 0 0 -1\n' >mirror.txt
printf '\357\273X1 0 0 0 1 0 0 0 1\n' >odd.txt
run 'for f in short word shear mirror odd; do voxmend augment in/l_prism.off -o x --rotate $f.txt; done'
run 'voxmend augment missing.off -o x'
run 'voxmend augment in/l_prism.off -o - -n 3 -r 16 -q >/dev/full'
run 'voxmend augment in/l_prism.off -o x -n 3 --memlimit 20K'
mkdir -p x2/000001.rle
run 'voxmend augment in/l_prism.off -o x2 -n 3 --force; ls x2'
run 'ls -d x'
finish

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend batch on a small folder: what it makes, says and refuses, and how it goes on.
. "$SRCDIR/tests/cli/lib.sh"
# Times, and what a machine does in them.
mask_batch() {
  sed -E -e 's/^(time +)[0-9].*/\1T/' -e 's/("began": )"[^"]*"/\1"T"/' -e 's/("(wall_s|cpu_s|largest_peak_bytes|seconds|disk_bytes|peak_bytes)": )[0-9.e+-]+/\1N/' \
    -e 's/^((disk|memory|time) +)(about|up to) .*/\1\3 N/'
}
voxmend() {
  "$VOXMEND" "$@" >raw.txt 2>raw-err.txt && status=0 || status=$?
  mask_batch <raw.txt
  mask_batch <raw-err.txt >&2
  return "$status"
}
# Pictures are among what is made.
voxmend voxelize in/torus.off -o t.npy -r 8 -q
if voxmend view t.npy -o probe.png 2>err.log >/dev/null; then
  rm probe.png
elif grep -q libpng raw-err.txt; then
  exit 77
fi
mkdir -p data/a data/b
cp in/cube.off in/sphere.off in/open_box.off data/a/
cp in/cube.off data/b/again.off
cp in/torus.off data/b/
printf 'OFF\n3 1 0\n0 0 0\n' >data/b/broken.off
printf 'notes\n' >data/readme.txt
ln -s .. data/a/loop

run 'voxmend batch data -o grids -r 16 --reports --pictures 0 -j 2'
run 'cd grids && find . -type f | sort && cd ..'
run 'cat grids/failures.tsv'
run 'voxmend compare grids/a/cube.binvox grids/b/again.binvox'
run 'grep -c "page" grids/index.html'
# The same as alone.
run 'voxmend voxelize data/a/sphere.off -o sphere.binvox -r 16 -q && cmp sphere.binvox grids/a/sphere.binvox'
# It goes on where it was, and not with other options, inputs or shards.
run 'voxmend batch data -o grids -r 16 --reports --pictures 0'
run 'voxmend batch data -o grids -r 32 --reports'
run 'voxmend batch data/a -o grids -r 16 --reports'
run 'voxmend batch data -o grids -r 16 --reports --shard 0/2'
run 'rm grids/a/cube.binvox && voxmend batch verify grids'
run 'voxmend batch data -o grids -r 16 --reports --pictures 0'
run 'voxmend batch verify grids'
run 'printf x >>grids/b/torus.binvox && voxmend batch verify grids'
run 'voxmend batch status grids --json'
run 'cp in/torus.off data/b/broken.off && voxmend batch data -o grids -r 16 --reports'
run 'voxmend batch data -o grids -r 16 --reports --pictures 0 --retry unreadable && cmp grids/b/broken.binvox grids/b/torus.binvox && voxmend batch verify grids'
# Inputs that change. x and y have the same bytes at first, and so have d and e; x stays as long as it was.
mkdir mend
cp in/cube.off in/sphere.off in/torus.off mend/
sed '1s,OFF,OFX,; 3s,0 0 0,0 0 x,' in/cube.off >mend/x.off
sed '2s,8,9,' in/cube.off >mend/d.off
cp mend/x.off mend/y.off
cp mend/d.off mend/e.off
again='voxmend batch mend -o mended -r 16 --pictures 0'
statuses() {
  $again "$@" >all.txt || return
  grep -E '^(meshes|result|before)' all.txt
}
run 'statuses && cut -f 1-4 mended/failures.tsv'
# Another time alone is no change; once renewed the plan needs no more looking.
run 'cp mended/.batch/run.json old.json && touch -d 2001-01-01 mend/*.off && statuses && ! cmp -s old.json mended/.batch/run.json'
run 'cp mended/.batch/run.json old.json && statuses && cmp old.json mended/.batch/run.json && grep -c changed mended/.batch/*.jsonl'
# A mended one is done again when its status is asked for, and is no duplicate of what it was.
run 'cp in/cube.off mend/x.off && statuses'
run 'flock mended/.batch/journal-0-of-1.jsonl "$VOXMEND" batch mend -o mended -r 16 --pictures 0 --retry all; cmp old.json mended/.batch/run.json'
run 'statuses --retry timeout'
run 'cp -r mended/.batch before && statuses --retry unreadable && cut -f 1-4 mended/failures.tsv && cmp mended/x.binvox mended/cube.binvox'
# Ended at each of the steps of that: nothing but the journal; the list as well; all, and nothing done.
run 'cp before/run.json before/plan.jsonl mended/.batch/ && statuses && ! cmp -s before/run.json mended/.batch/run.json'
run 'cp before/run.json mended/.batch/ && statuses && ! cmp -s before/run.json mended/.batch/run.json'
run 'rm mended/x.binvox && sed -i "/\"changed\"/q" mended/.batch/journal-0-of-1.jsonl && voxmend batch status mended --json | grep -E "pending|unreadable|complete|duplicate"; voxmend batch verify mended'
run 'statuses && cmp mended/x.binvox mended/cube.binvox && voxmend batch verify mended'
run 'cp in/sphere.off mend/d.off && statuses'
run 'statuses --retry degraded && cmp mended/d.binvox mended/sphere.binvox && voxmend voxelize mend/e.off -o e.binvox -r 16 -q; cmp e.binvox mended/e.binvox'
# What is done stays, unless its outputs are taken away; other files are none of this batch.
run 'cp in/torus.off mend/sphere.off && statuses --retry all'
run 'cp in/torus.off mend/y.off && statuses'
run 'rm mended/sphere.binvox && statuses --retry unreadable && cmp mended/sphere.binvox mended/torus.binvox && voxmend batch verify mended'
run 'cp in/cube.off mend/a.off && statuses --retry all'
run 'mv mend/a.off a.off && mv mend/x.off x.off && statuses --retry all'
# Shards, which do not know each other, take the same bytes alone.
mv x.off mend/x.off
again='voxmend batch mend -o parts -r 16 --pictures 0 --shard 0/2'
run 'statuses && voxmend batch mend -o parts -r 16 --pictures 0 --shard 1/2 -q && cp parts/.batch/run.json old.json'
run 'touch mend/*.off && statuses && cmp old.json parts/.batch/run.json'
run 'cp in/cube.off mend/e.off && statuses --retry all'
run 'again="voxmend batch mend -o half -r 16 --pictures 0 --shard 0/2"; statuses && cp in/torus.off mend/d.off && statuses'
# A table, with options of its own; a list; members of a shard.
printf 'path,id,class,split,options\n../in/cube.off,"box, one",box,train,-r 4 --fit tight\n../in/sphere.off,ball,ball,test,\n../in/gone.off,gone,,,\n../in/cube.off,bad,,,-r none\n' >data/table.csv
run 'voxmend batch data/table.csv -o table -r 8 --format npy --pictures 0'
run 'cd table && find . -type f -name "*.npy*" | sort && cd ..'
run 'cut -f 1-4 table/failures.tsv'
run 'ls data/a/*.off | sed 1d >list.txt; voxmend batch list.txt -o listed -r 8 --shard 1/2 && find listed -name "*.binvox"'
run 'voxmend batch list.txt -o listed -r 8 --shard 0/2 --pictures 0 && find listed -name "*.binvox" | sort'
run '{ printf "\357\273\277"; head -1 list.txt; } >marked.txt; voxmend batch marked.txt -o marked -r 8 --pictures 0 && find marked -name "*.binvox"'
run 'printf "\357\273\277\"path\",\"id\"\r\n\"in/cube.off\",\"box\"\r\n" >marked.csv; voxmend batch marked.csv -o tabled -r 8 --pictures 0 && find tabled -name "*.binvox"'
# Of files with the same bytes those for training are the duplicates, whatever their names; a picture is drawn of the other.
mkdir -p splits/chair/train splits/chair/test splits/chair/val splits/chair/extra
for name in train/a test/b; do cp in/cube.off splits/chair/$name.off; done
for name in extra/a val/b train/c; do cp in/torus.off splits/chair/$name.off; done
run 'voxmend batch splits -o once -r 8 -q && grep -o "\"status\":\"duplicate\"[^}]*\"item\":\"[^\"]*\"" once/index.html | sed "s/.*:\"//" | sort'
run 'grep -o "\"picture\":\"" once/index.html | wc -l'
# With another .mtl beside them equal bytes are no duplicates where colours are made of them, and are where none are.
mkdir -p paint/a paint/b
for folder in a b; do
  printf 'mtllib m.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >paint/$folder/m.obj
done
printf 'newmtl paint\nKd 1 0 0\n' >paint/a/m.mtl
printf 'newmtl paint\nKd 0 0 1\n' >paint/b/m.mtl
printf 'path,id,options\na/m.obj,a,--color mesh\nb/m.obj,b,--color mesh\n' >paint/own.csv
run 'voxmend batch paint -o painted -r 8 --format npy --color mesh --pictures 0 | grep result; cmp painted/a/m.npy painted/b/m.npy'
run 'voxmend voxelize paint/b/m.obj -o m.npy -r 8 --color mesh -q && cmp m.npy painted/b/m.npy'
run 'rm painted/b/m.npy && voxmend batch paint -o painted -r 8 --format npy --color mesh --pictures 0 | grep result; cmp m.npy painted/b/m.npy'
run 'voxmend batch paint/own.csv -o own-paint -r 8 --format npy --pictures 0 | grep result; cmp m.npy own-paint/b.npy'
run 'voxmend batch paint -o plain -r 8 --format npy --pictures 0 | grep result'
# What was read beside a mesh belongs to it, and so do files that options name.
again='voxmend batch paint -o painted -r 8 --format npy --color mesh --pictures 0'
run 'touch -d 2001-01-01 paint/*/m.mtl && statuses'
run 'printf "newmtl paint\nKd 0 1 0\n" >paint/a/m.mtl && statuses'
run 'rm painted/a/m.npy && statuses && voxmend voxelize paint/a/m.obj -o m.npy -r 8 --color mesh -q && cmp m.npy painted/a/m.npy'
run 'rm paint/b/m.mtl && statuses'
run 'voxmend voxelize in/torus.off -o like.npy -r 8 -q && voxmend batch data/a/cube.off -o liked --like like.npy -q && voxmend batch data/a/cube.off -o liked --like like.npy -q'
run 'voxmend voxelize in/sphere.off -o like.npy -r 8 -q && voxmend batch data/a/cube.off -o liked --like like.npy'
# Folders of variants have links in them.
run 'voxmend batch splits -o varied --no-grid --augment "-n 2 -r 8" --pictures 0; voxmend batch verify varied; find varied -name "*.rle" | sort'
run 'find varied -name "*.rle" -links 1; find varied -name "*.rle" -links 2 | wc -l; find varied -name "*.rle" -links 3 | wc -l'
# Model numbers are those of 'augment FOLDER', whatever is made when, and where: in a shard, or anew.
mkdir -p kinds/a kinds/b
cp in/cube.off kinds/a/
cp in/sphere.off kinds/b/
cp in/torus.off kinds/
options='-n 2 -r 8 --rotate any --scale 0.4 --format npy --model 5'
each_variant() {
  (cd counted && find . -name '*.npy' | sort) | while read -r file; do
    cmp "counted/$file" "$1/${file%/*}.variants/${file##*/}"
  done
}
run 'voxmend augment kinds -o counted $options -q && cut -f 1,2 counted/models.tsv'
run 'voxmend batch kinds -o numbered --no-grid --augment "$options" -q && each_variant numbered && grep -oE "\"model\":[0-9]+" numbered/.batch/journal-0-of-1.jsonl | sort'
run 'rm -r numbered/torus.variants && voxmend batch kinds -o numbered --no-grid --augment "$options" -q && each_variant numbered'
run 'for s in 2 0 1; do voxmend batch kinds -o sharded --no-grid --augment "$options" --shard $s/3 -q; done; each_variant sharded'
run 'voxmend batch kinds -o beyond --no-grid --augment "-n 2 -r 8 --model 4294967294" --pictures 0 -q; cut -f 1-4 beyond/failures.tsv'
printf 'OFF\n3 x\n' >kinds/b/z.off
run 'voxmend batch kinds -o repeated --no-grid --augment "$options" --pictures 0 -q; cut -f 5 repeated/failures.tsv'
# Other products.
run 'voxmend batch "data/a/c*.off" -o made -r 8 --repair "--level closed --format obj" --remesh "-r 8" --augment "-n 2 -r 8 --format npy" --view "--size 40x30" --pictures 0'
run 'cd made && find . -type f -not -path "./.batch/*" | sort && cd ..'
run 'voxmend batch data/a -o fixed --no-grid --repair "--format off" --pictures 0 && find fixed -name "*.off" | sort'
run 'voxmend batch data/a --dry-run 2 -r 8'
# An open mesh is told of by its variants as by its grid.
mkdir holed
awk 'NR == 2 { $2 /= 2; n = $1 } NR <= 2 + n || (NR - n) % 2' in/cavity.off >holed/holed.off
cp in/cube.off holed/cube.off
told() { grep result; grep -o '"warnings":\["[^;]*' "$1"/.batch/journal-0-of-1.jsonl; }
run 'voxmend batch holed -o holed-grids -r 16 --pictures 0 | told holed-grids'
run 'voxmend batch holed -o holed-variants --no-grid --augment "-n 2 -r 16 --rotate z" --pictures 0 | told holed-variants'
# Up in pictures, of the grid and in the page, is what is usual in the mesh's format, or what --view says.
mkdir up
printf 'v 0 0 0\nv 1 0 0\nv 0 3 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >up/tall.obj
voxmend view up/tall.obj -o usual.png -r 16 --size 60x45 -q
voxmend view up/tall.obj -o other.png -r 16 --size 60x45 --up x -q
voxmend voxelize up/tall.obj -o tall.binvox -r 16 -q
for up in x y; do voxmend view tall.binvox -o page-$up.png --size 192x144 --up $up -q; done
drawn() { grep -o '"picture":"[^"]*"' "$1/index.html" | cut -d '"' -f 4 | base64 -d; }
run 'voxmend batch up -o upright -r 16 --view "--size 60x45" -q && cmp usual.png upright/tall.png && drawn upright | cmp - page-y.png'
run 'voxmend batch up -o sideways -r 16 --view "--size 60x45 --up x" -q && cmp other.png sideways/tall.png && drawn sideways | cmp - page-x.png'
run 'voxmend batch up -o no-grids --no-grid --repair "--level clean" -q && voxmend view up/tall.obj -o mesh.png --size 192x144 -q && drawn no-grids | cmp - mesh.png'
# Folders as in ModelNet tell class and split, also in a list made from above.
mkdir -p net/chair/train net/chair/test
cp in/cube.off net/chair/train/chair_1.off
cp in/torus.off net/chair/test/chair_2.off
run 'voxmend batch net -o netted -r 8 --pictures 0 -q && grep -oE "\"(item|class|split)\":\"[^\"]*\"" netted/.batch/plan.jsonl'
run 'find net -name "*.off" >net.txt && voxmend batch net.txt -o enlisted -r 8 --pictures 0 -q && grep -oE "\"(item|class|split)\":\"[^\"]*\"" enlisted/.batch/plan.jsonl'
# A link to nothing costs itself alone where it is named, also by a pattern, and is passed over in a folder.
mkdir hanging
cp in/cube.off hanging/a.off
ln -s nowhere.off hanging/b.off
run 'voxmend batch "hanging/*.off" -o hung -r 8 --pictures 0; cut -f 1-4 hung/failures.tsv'
run 'voxmend batch hanging/a.off hanging/b.off -o hung-named -r 8 --pictures 0 | grep result'
run 'voxmend batch hanging -o hung-folder -r 8 --pictures 0 | grep -E "result|passed"'
# A batch whose plan has other words for splits, as older ones had, goes on, with the words of today.
mkdir netted/keep && cp netted/.batch/plan.jsonl netted/keep
sed -i 's/"split":"test"/"split":"Testing"/' netted/.batch/plan.jsonl
sed -i 's/"plan_sha256": "[0-9a-f]*"/"plan_sha256": "of another"/' netted/.batch/run.json
run 'voxmend batch net -o netted -r 8 --pictures 0 && cmp netted/.batch/plan.jsonl netted/keep/plan.jsonl'
# In a table blanks around cells do not count, but in quotes those of paths do; what it leaves open folders tell, and a column
# that nobody knows is told.
cp in/sphere.off "net/chair/test/ 3.off"
printf 'Path, id ,"class ", split ,splits,note\nchair/train/chair_1.off, one, "seat ",Training ,x,\nchair/test/chair_2.off ,two,, \n \n"chair/test/ 3.off" , a/b,,\r\n' >net/spaced.csv
run 'voxmend batch net/spaced.csv -o spaced -r 8 --pictures 0 -q --strict'
run 'voxmend batch net/spaced.csv -o spaced -r 8 --pictures 0 && grep -oE "\"(item|class|split)\":\"[^\"]*\"" spaced/.batch/plan.jsonl'
run 'voxmend augment net/spaced.csv -o drawn -n 1 -r 8 && cat drawn/models.tsv'
# Inputs are never outputs, and no two outputs are the same.
mkdir clash
cp in/cube.off clash/a.off
cp in/cube.off clash/a.repaired.off
run 'cd clash && voxmend batch "*.off" -o . --no-grid --repair "--format off"; ls; cd ..'
run 'voxmend batch clash -o clashed --format ply --repair "--format ply"'
# Options of one mesh are about its grid; names that are no UTF-8, and too long ones, cost themselves alone.
printf 'path,id,options\n../in/cube.off,report,--rep=x.json\n../in/cube.off,help,--help\n../in/cube.off,dry,--dr\n../in/cube.off,v1.5,-r 4\n../in/cube.off,%s/long,\n' "$(printf '%0300d' 0)" >data/own.csv
run 'voxmend batch data/own.csv -o own -r 8 --pictures 0; cut -f 1-4 own/failures.tsv | sed "s/00*/0/"; find own -name "*.binvox"'
# The command that repeats a failure names its file, whatever the name.
mkdir odd
printf 'OFF\n3 x\n' >"odd/$(printf 'a\tb%%d\\n'"'"'.off')"
printf 'OFF\n4 x\n' >"odd/$(printf 'c\nd e.off')"
run 'voxmend batch odd -o odd-out -r 8 --pictures 0 -q; cut -f 2-5 odd-out/failures.tsv'
run 'cut -f 5 odd-out/failures.tsv | sed 1d >commands; while read -r line; do eval "$line" || true; done <commands'
# It is the command that failed, or all where that is not known.
mkdir strict && cp in/edge_cubes.off strict
run 'voxmend batch strict -o strict-out -r 8 --repair "--level closed --max-change 1e-12" --view "--size 40x30" -q; cut -f 3,5 strict-out/failures.tsv; eval "$(sed 1d strict-out/failures.tsv | cut -f 5)" 2>/dev/null'
run 'find strict-out -type f -not -path "*/.batch/*" | sort'
printf 'OFF\n3 x\n' >strict/edge_cubes.off
run 'voxmend batch strict -o stricter -r 8 --repair "--level closed" --view "--size 40x30" -q; cut -f 3,5 stricter/failures.tsv'
# Options that keep a command from writing are no success.
run 'voxmend batch clash/a.off -o helped -r 4 --view --help --pictures 0; cut -f 1-4 helped/failures.tsv'
mkdir latin
cp in/cube.off "latin/$(printf 'st\374hl.off')"
run 'voxmend batch latin -o latin-out -r 8 --pictures 0; cut -f 1-4 latin-out/failures.tsv'
run 'voxmend batch clash/a.off -o many -r 4 --augment "-n 1200 -r 4" --pictures 0 && voxmend batch verify many && ls many/clash/a.variants | wc -l'
# What cannot be read within a folder is told, not passed over.
run 'voxmend batch data/a/cube.off -o chunks -r 8 --format zarr --pictures 0 && voxmend batch verify chunks'
run 'find chunks -name 0.0.0 -exec ln -sf nowhere "{}" ";" && voxmend batch verify chunks'
# What is refused before anything is made.
run 'voxmend batch data'
run 'voxmend batch -o grids'
run 'voxmend batch data -o none -r many'
run 'voxmend batch data -o none --repair "--level best"'
run 'voxmend batch data -o none --view "--size"'
run 'voxmend batch data -o none --coords x.npy'
run 'voxmend batch data -o none --format docx'
run 'voxmend batch data -o none --shard 2/2'
run 'SLURM_ARRAY_TASK_ID=x voxmend batch data -o none --shard slurm/4'
run 'voxmend batch data -o none --retry all,lost'
run 'voxmend batch nothing -o none'
run 'voxmend batch "none*.off" -o none'
run 'mkdir empty && voxmend batch empty -o none'
mkdir twice && printf 'OFF\n1 0 0\n' >twice/a.off && cp twice/a.off twice/b.off
run 'voxmend batch twice -o failed -r 8 --pictures 0 -q; cut -f 1-4 failed/failures.tsv'
cp in/cube.off "twice/$(printf 'c\377').off"
run 'voxmend batch twice -o misnamed -r 8 --pictures 0 -q; cut -f 1,4,5 misnamed/failures.tsv | sed "s/[^	]*announced[^	]*/.../"; voxmend batch twice -o misnamed -r 8 --pictures 0 -q; wc -l <misnamed/failures.tsv'
run 'mkdir self && cp in/cube.off self && voxmend batch self -o self'
run 'voxmend batch status data'
run 'voxmend batch export grids --to sqlite'
run 'voxmend batch export grids --to sqlite -o grids.db'
run 'voxmend batch export grids --to sqlite -o grids.sqlite --shuffle 2'
run 'voxmend batch export once --to sqlite -o gone/grids.sqlite'
run 'voxmend batch export grids --to zarr -o arrays --max-bytes 0'
run 'voxmend batch export grids --to zarr -o arrays --content all'
run 'voxmend batch export grids --to sqlite -o grids.sqlite -r 8'
run 'voxmend batch verify grids -o more'
run 'voxmend batch data/a -o more --split train'
run 'test ! -e none'
finish

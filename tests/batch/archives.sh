#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Archives give what their folders give; damaged ones and such as unpack without end are told of.
set -eu
[ -x "$BUILDDIR/voxmend-unpack" ] || { echo "built without libarchive"; exit 77; }
[ -n "$TEST_PYTHON" ] || { echo "no Python"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-archives.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/data"
"$BUILDDIR/samples/generate_samples" "$work/data"
rm -f "$work/data"/stool.*
fail() {
  echo "FAILED: $1"
  exit 1
}
cd "$work"
PYTHONUTF8=1 "$TEST_PYTHON" - <<'END'
import os, tarfile, zipfile
names = sorted(n for n in os.listdir("data") if n.endswith(".off"))
for kind, name in (("w", "a.tar"), ("w:gz", "a.tar.gz"), ("w:xz", "a.tar.xz")):
    with tarfile.open(name, kind) as archive:
        for n in names:
            archive.add("data/" + n, n)
with zipfile.ZipFile("a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
    for n in names:
        archive.write("data/" + n, n)
    archive.writestr("../../above.off", open("data/cube.off").read())
    archive.writestr("readme.txt", "notes")
    archive.writestr("stühle/stuhl.off", open("data/torus.off").read())
with zipfile.ZipFile("endless.zip", "w", zipfile.ZIP_DEFLATED) as archive:
    archive.write("data/cube.off", "cube.off")
    with archive.open("endless.off", "w", force_zip64=True) as member:
        for _ in range(200):
            member.write(b"\n" * (1 << 20))
    archive.write("data/torus.off", "torus.off")
data = open("a.tar.gz", "rb").read()
open("short.tar.gz", "wb").write(data[:len(data) // 2])
open("noise.tar.gz", "wb").write(b"no archive at all" * 100)
END
batch() {
  "$VOXMEND" batch "$@" -r 16 --pictures 0 --progress never
}
batch data -o folder >/dev/null
for archive in a.tar a.tar.gz a.tar.xz a.zip; do
  batch "$archive" -o "from-$archive" >said
  (cd folder && find . -name '*.binvox') | while read -r file; do
    cmp "folder/$file" "from-$archive/$file" || fail "$archive: $file"
  done
done
[ -z "$(find . .. -maxdepth 3 -name 'above*')" ] && grep -q 'passed over *2 .*(names with ..) .txt' said || fail "a member leads out of the folder"
cmp folder/torus.binvox "from-a.zip/stühle/stuhl.binvox" || fail "a name beyond ASCII"
# Duplicates are found there as in folders, and between them; in train and test it is the one in train.
mkdir -p twice/chair/train twice/chair/test
cp data/cube.off twice/chair/train/a.off
cp data/cube.off twice/chair/test/b.off
cp data/torus.off twice/chair/train/c.off
cp data/cube.off twice/chair/train/d.off
sed '2s/8/9/' data/cube.off >twice/chair/train/e.off
duplicates() {
  sed -n 's/.*"duplicate_of":"\([^"]*\)".*/\1/p' "$1"/.batch/journal-*.jsonl
}
batch twice -o twice-folder >/dev/null
"$TEST_PYTHON" - <<'END'
import os, tarfile, zipfile
names = sorted(os.path.relpath(os.path.join(at, n), "twice") for at, _, files in os.walk("twice") for n in files)
with tarfile.open("twice.tar.gz", "w:gz") as tar, zipfile.ZipFile("twice.zip", "w", zipfile.ZIP_DEFLATED) as packed:
    for n in names:
        tar.add("twice/" + n, n)
        packed.write("twice/" + n, n)
END
for archive in twice.tar.gz twice.zip; do
  batch $archive -o from-$archive >said
  grep -q '2 duplicate' said || fail "duplicates in $archive"
  [ "$(duplicates from-$archive)" = "$(duplicates twice-folder)" ] || fail "originals in $archive"
  (cd twice-folder && find . -name '*.binvox') | while read -r file; do
    cmp "twice-folder/$file" "from-$archive/$file" || fail "$archive: $file"
  done
  rm from-$archive/chair/train/a.binvox
  batch $archive -o from-$archive >said
  grep -q '2 duplicate' said && cmp twice-folder/chair/train/a.binvox from-$archive/chair/train/a.binvox || fail "$archive anew"
done
batch data/cube.off twice.zip -o across >said
grep -q '3 duplicate' said || fail "a file and members"
# Odd members: as if the archive were unpacked and its folder given. What is passed over is counted.
PYTHONUTF8=1 "$TEST_PYTHON" - <<'END'
import io, tarfile, zipfile
sphere, torus = open("data/sphere.off", "rb").read(), open("data/torus.off", "rb").read()
def add(archive, name, data=b"", kind=tarfile.REGTYPE, target=""):
    info = tarfile.TarInfo(name)
    info.size, info.type, info.linkname = len(data), kind, target
    archive.addfile(info, io.BytesIO(data))
with tarfile.open("odd.tar", "w", format=tarfile.GNU_FORMAT) as archive:
    add(archive, "twice.off", sphere)
    add(archive, "./first/x.off", sphere)
    add(archive, "twice.off", torus)
    add(archive, "hard.off", b"", tarfile.LNKTYPE, "./first/x.off")
    add(archive, "other.ply", b"", tarfile.LNKTYPE, "./first/x.off")
    add(archive, "lost.off", b"", tarfile.LNKTYPE, "gone.off")
    add(archive, "soft.off", b"", tarfile.SYMTYPE, "twice.off")
    add(archive, "../../up.off", sphere)
    add(archive, "first/.hidden.off", sphere)
    add(archive, ".git/x.off", sphere)
    add(archive, "__MACOSX/first/._x.off", b"no mesh")
with zipfile.ZipFile("mac.zip", "w") as archive:
    archive.writestr("x.off", sphere)
    archive.writestr(".y.off", sphere)
    archive.writestr("__MACOSX/._x.off", b"no mesh")
END
batch odd.tar -o odd >said
cat said
grep -q '^meshes *4$' said && grep -q '^passed over *7 ' said && grep -q '1 duplicate' said || fail "odd members"
for name in twice:torus first/x:sphere hard:sphere; do
  cmp odd/${name%:*}.binvox folder/${name#*:}.binvox || fail "$name"
done
[ "$(sed 1d odd/failures.tsv | cut -f 1-3)" = "$(printf 'other.ply\tunreadable\tread')" ] || fail "another name of a member"
[ "$(grep -c '"class"' odd/.batch/plan.jsonl)" = 1 ] || fail "a class of a dot"
batch mac.zip -o mac >said
grep -q '^meshes *1$' said && grep -q '^passed over *2 .*hidden' said || fail "hidden members"
# What Assimp reads is told of in an archive by its name, as in a folder.
mkdir scenes
"$BUILDDIR/samples/generate_samples" scenes
rm -f scenes/*.off scenes/*.step
if "$VOXMEND" info -q scenes/stool.glb 2>/dev/null; then
  tar cf scenes.tar -C scenes stool.glb
  batch scenes -o scenes-folder >/dev/null
  batch scenes.tar -o scenes-archive >said
  cmp scenes-folder/stool.binvox scenes-archive/stool.binvox || fail "stool.glb"
fi
# Pictures of a member have that axis up that is usual in its format.
mkdir up
printf 'v 0 0 0\nv 1 0 0\nv 0 3 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >up/tall.obj
if "$VOXMEND" view up/tall.obj -o usual.png -r 16 --size 60x45 -q 2>/dev/null; then
  tar cf up.tar up
  batch up.tar -o up-grids --view "--size 60x45" >/dev/null
  cmp usual.png up-grids/up/tall.png || fail "up in pictures"
fi
# A mesh is read without the files beside it, and told so, whatever the option; but what is not wanted is not missed.
mkdir red
printf 'mtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >red/m.obj
printf 'newmtl red\nKd 1 0 0\n' >red/m.mtl
tar cf red.tar red
for external in folder any; do
  batch red.tar -o red-$external --format npy --color mesh --external $external >/dev/null
  grep -q '"m.mtl", .* a mesh in an archive is read without the files beside it; unpack the archive' red-$external/failures.tsv ||
    fail "companions of a member, --external $external"
done
batch red.tar -o red-none --format npy --color mesh --external none >/dev/null
grep -q '"m.mtl", which it refers to, was not opened: --external none' red-none/failures.tsv || fail "--external none"
batch red -o red-folder-none --format npy --color mesh --external none >/dev/null
grep -q '"m.mtl", which it refers to, was not opened: --external none' red-folder-none/failures.tsv || fail "--external none of files"
batch red -o red-files --format npy --color mesh >/dev/null
batch red.tar -o red-bits --format npy >/dev/null
[ -e red-files/m.npy ] && [ -e red-bits/red/m.npy ] || fail "red"
# Shards take their share of an archive each.
batch a.tar.gz -o shards --shard 0/3 >/dev/null
batch a.tar.gz -o shards --shard 2/3 >/dev/null
batch a.tar.gz -o shards --shard 1/3 >/dev/null
(cd folder && find . -name '*.binvox') | while read -r file; do
  cmp "folder/$file" "shards/$file" || fail "shards: $file"
done
# A member that unpacks to more than a mesh may take; its neighbours are made.
batch endless.zip -o endless --memlimit 64M >said
cut -f 1-4 endless/failures.tsv
grep -q '^endless.off	unreadable	unpack	it unpacks to more' endless/failures.tsv || fail "endless.off"
[ -e endless/cube.binvox ] && [ -e endless/torus.binvox ] || fail "the neighbours of endless.off"
for archive in short noise; do
  status=0
  batch "$archive.tar.gz" -o "$archive" >said 2>&1 || status=$?
  cat said
  [ "$status" -eq 1 ] && [ ! -e "$archive" ] && grep -q 'the archive is damaged' said || fail "$archive.tar.gz"
done

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The order of the folders: each folder of src/ includes only its own files and those of folders before it, so that no
# circle leaves a folder; the command line sees voxmend.h alone, and nothing below it prints or ends the program.
set -eu
cd "$SRCDIR/src"
bad=0
complain() {
  echo "FAILED: $1"
  printf '%s\n' "$2"
  bad=1
}

# What each folder may include comes before it. Of a folder with others in it what lies in it itself is the last.
order="voxmend base mesh sandbox
  meshio/common meshio/formats meshio/external meshio
  repair/external repair/state repair/clean repair/manifold repair/weld repair/holes repair/sheets repair/exact repair/bodies repair
  grid
  voxel/lattice voxel/parts voxel/parity voxel/winding voxel/surface voxel/closest voxel/engine voxel/thin voxel/solid voxel/model
  voxel/sparse voxel/fields voxel/labels
  gpu/common gpu/opencl gpu/opengl gpu
  gridio/common gridio/formats/octree gridio/formats/minecraft gridio/formats/vdb gridio/formats/vox gridio/formats
  gridio/mesh gridio/picture gridio/page gridio
  export remesh augment carve experimental api
  modules/assimp modules/images modules/occt modules/openmesh modules/cgal modules/openvdb modules/hdf5 modules/octomap"

# Modules share the folders that their makefile lists, and not each other.
listed=" $(echo $order) batch cli "
for folder in $(find . -name '*.[ch]' -o -name '*.cc' -o -name '*.inc' | sed 's|^\./||; s|/*[^/]*$||' | sort -u); do
  case $listed in
  *" $folder "*) ;;
  *) complain "src/$folder has no place in the order of tests/cli/structure.sh" "" ;;
  esac
done

seen=
for folder in $order; do
  [ -d "$folder" ] || continue
  allowed="$seen $folder"
  case $folder in
  modules/*) ;;
  *) seen=$allowed ;;
  esac
  pattern=$(echo $allowed | sed 's/ /|/g')
  found=$(grep -nE '#[[:space:]]*include[[:space:]]+"' $(find "$folder" -maxdepth 1 -name '*.[ch]' -o -maxdepth 1 -name '*.cc' -o -maxdepth 1 -name '*.inc') |
    grep -vE "\"(($pattern)/[^/\"]*|voxmend/[a-z]*\.h|voxmend\.h|config\.h|build_hash\.h|module_folder\.h|view_page\.inc|shaders/(kernels\.inc|shaders\.inc|rules\.h))\"" || true)
  [ -z "$found" ] || complain "$folder includes what does not come before it" "$found"
done
found=$(grep -rnE '#[[:space:]]*include[[:space:]]+"' batch | grep -vE '"(batch/[^"]*|voxmend\.h|config\.h|module_folder\.h|batch_page\.inc)"' || true)
[ -z "$found" ] || complain "batch includes more than voxmend.h and its own headers" "$found"
found=$(grep -rnE '#[[:space:]]*include[[:space:]]+"' cli | grep -vE '"(cli/[^"]*|batch/[^"]*|voxmend/experimental\.h|voxmend\.h|config\.h)"' || true)
[ -z "$found" ] || complain "cli includes more than voxmend.h and its own headers" "$found"

for folder in $order; do
  [ -d "$folder" ] || continue
  found=$(grep -nE '(^|[^a-zA-Z_])(printf|puts|putchar|vprintf|perror|exit|abort|_exit)[[:space:]]*\(|(^|[^a-zA-Z_<])std(out|err)[^a-zA-Z_]' \
    $(find "$folder" -maxdepth 1 -name '*.[ch]' -o -maxdepth 1 -name '*.cc' -o -maxdepth 1 -name '*.inc') /dev/null | grep -vE ':[[:space:]]*(/\*|\*|//)' || true)
  [ -z "$found" ] || complain "$folder prints or ends the program" "$found"
done

# Calls need no include: what api defines is declared in the public headers, which all may include.
public=$(grep -hE '^[a-z][a-z0-9_ *]* \**vxm_[a-z0-9_]*\(' api/*.c | grep -v '^static' | sed 's/(.*//; s/.*[ *]//' | sort -u | paste -sd '|')
found=$(grep -nE "(^|[^a-z0-9_])($public)\(" $(find . -name '*.[ch]' -o -name '*.cc' -o -name '*.inc' | grep -vE '^\./(api|batch|cli|voxmend)/') |
  grep -vE ':[[:space:]]*(/\*|\*|//)' || true)
[ -z "$found" ] || complain "what comes before api calls it" "$found"

found=$(for file in $(find . ../tests ../samples -name '*.[ch]' -o -name '*.cc'); do
  head -n 1 "$file" | grep -q 'SPDX-License-Identifier' || echo "$file"
done)
[ -z "$found" ] || complain "no licence line" "$found"
exit "$bad"

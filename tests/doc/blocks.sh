#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every block of the pages runs, or says why not (blocks.py).
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-blocks.XXXXXX")
trap 'rm -rf "$work"' EXIT
case $(sed -n 's/^VXM_CFLAGS = //p' "$BUILDDIR/Makefile") in
*-fsanitize=*) echo "programs would need the sanitizers of the library"; exit 77 ;;
esac
"${PYTHON:-$TEST_PYTHON}" -c 'import sys' 2>/dev/null || { echo "there is no Python that reads the pages"; exit 77; }

# The files that the pages name, which people have, and no sample is called.
mkdir "$work/bin" "$work/samples"
cd "$work/samples"
"$BUILDDIR/samples/generate_samples" .
cp rocket.off chair.off
cp stool.step assembly.step
"$VOXMEND" repair rocket.off -o model.stl -q
cp model.stl car.stl
"$VOXMEND" repair torus.off -o ball.stl -q
"$VOXMEND" repair cube.off -o block.stl -q
"$VOXMEND" repair open_box.off -o plane.obj -q
cp plane.obj model.obj
cp rocket.off bunny.ply # told by content
mkdir objaverse samples build-demo
cp stool.glb objaverse/
cp rocket.off samples/
printf '#!/bin/sh\n' >demo # it is built
chmod +x demo
for class in chair table; do
  mkdir -p ModelNet40/$class/train ModelNet40/$class/test
done
cp cube.off ModelNet40/chair/train/chair_0001.off
cp rocket.off ModelNet40/chair/train/chair_0002.off
echo "no mesh" >ModelNet40/chair/test/chair_0003.off
cp sphere.off ModelNet40/chair/test/chair_0004.off
cp torus.off ModelNet40/table/train/table_0001.off
cp open_box.off ModelNet40/table/train/table_0002.off
cp rocket.off ModelNet40/table/test/table_0003.off # again
cp rocket.off ModelNet40/table/test/table_0004.off
for model in 02691156/1a04e3 03001627/1a6f61; do
  mkdir -p ShapeNetCore.v2/$model/models
  { printf 'mtllib model_normalized.mtl\nusemtl paint\n'; cat plane.obj; } >ShapeNetCore.v2/$model/models/model_normalized.obj
  printf 'newmtl paint\nKd 1 0 0\n' >ShapeNetCore.v2/$model/models/model_normalized.mtl
done

ln -s "$VOXMEND" "$work/bin/voxmend"
ln -s "$VOXMEND" build-demo/voxmend
printf '#!/bin/sh\nexec "%s" binvox "$@"\n' "$VOXMEND" >"$work/bin/binvox"
chmod +x "$work/bin/binvox"
PATH=$work/bin:$PATH
PYTHONDONTWRITEBYTECODE=1
export PATH PYTHONDONTWRITEBYTECODE
[ -z "${PYTHON:-}" ] || { PYTHONPATH=$BUILDDIR/python-package; export PYTHONPATH; }

pages=${PAGES:-$(cd "$SRCDIR" && find README.md SECURITY.md python/README.md samples/README.md packaging/README.md doc tests/fuzz/README.md \
  -path doc/site/source -prune -o -name '*.md' -print | sort)}
for page in $pages; do
  set -- "$@" "$SRCDIR/$page"
done
"${PYTHON:-$TEST_PYTHON}" "$SRCDIR/tests/doc/blocks.py" "$work/samples" "$@"

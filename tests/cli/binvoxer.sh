#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# trimesh's Binvoxer calls binvox by its name; skipped where READERS_PYTHON has no trimesh, which ./check --all has from
# PyPI.
set -eu
python=${READERS_PYTHON:-$TEST_PYTHON}
"$python" -c 'import numpy, trimesh, scipy, rtree' 2>/dev/null || { echo "no Python with trimesh"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-binvoxer.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
printf '#!/bin/sh\nexec "%s" "$@"\n' "$BUILDDIR/binvox" >"$work/bin/binvox"
chmod +x "$work/bin/binvox"
zlib=no
grep -q '^#define HAVE_ZLIB 1' "$BUILDDIR/config.h" && zlib=yes
PATH=$work/bin:$PATH "$python" "$SRCDIR/tests/cli/binvoxer.py" "$work" "$zlib"

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Meshes and grids of trimesh, open3d, pyvista and meshio, those that there are.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c "import cffi, trimesh" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no trimesh (PyPI: trimesh, open3d, pyvista, meshio, scipy)"
  exit 77
fi
"$PYTHON" "$SRCDIR/tests/python/test_peers.py"

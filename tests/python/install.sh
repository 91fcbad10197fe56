#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The source distribution has all that pip needs, and the extension remembers no folder unless that is asked for.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -m venv --system-site-packages environment >/dev/null 2>&1; then
  echo "SKIPPED: $PYTHON makes no environments (Debian: python3-venv)"
  exit 77
fi
unset PYTHONPATH
python=$SAMPLES/environment/bin/python
library=$BUILDDIR/.libs

# As 'python -m build --sdist', whose part is to call this.
mkdir source sdist
(cd "$SRCDIR/python" && cp -r LICENSE MANIFEST.in README.md build_library.py build_voxmend.py pyproject.toml scripts setup.py voxmend "$SAMPLES/source")
chmod -R u+w source
(cd source && "$PYTHON" -c 'from setuptools import build_meta; build_meta.build_sdist("../sdist")' >../log 2>&1) || { cat log; exit 1; }
archive=$(ls "$SAMPLES"/sdist/voxmend-*.tar.gz)
tar -tzf "$archive" | sed 's/^[^/]*//' | sort >content
for file in /LICENSE /README.md /build_library.py /build_voxmend.py /setup.py /pyproject.toml /PKG-INFO /voxmend/py.typed; do
  grep -qxF "$file" content || { echo "FAILED: no $file in the archive"; exit 1; }
done
for file in "$SRCDIR"/python/voxmend/*.py; do
  grep -qxF "/voxmend/${file##*/}" content || { echo "FAILED: no $file in the archive"; exit 1; }
done
cmp "$SRCDIR/LICENSE" "$SRCDIR/python/LICENSE"

VOXMEND_INCLUDE=$SRCDIR/src VOXMEND_LIB=$library "$python" -m pip install --no-cache-dir --no-index --no-build-isolation \
  --disable-pip-version-check "$archive" >log 2>&1 || { cat log; exit 1; }
extension=$(find environment -name '_voxmend*.so')
[ -f "$extension" ]
if command -v readelf >/dev/null; then
  ! readelf -d "$extension" | grep -E 'RPATH|RUNPATH' || { echo "FAILED: the extension remembers a folder"; exit 1; }
  readelf -d "$(find "$BUILDDIR/python-package" -name '_voxmend*.so')" | grep -qE "(RPATH|RUNPATH).*[[]$library[]]"
fi
# Where the library is nowhere the package says so (where an older one is installed that is found).
"$python" -c 'import voxmend' 2>err || grep -q 'ImportError: libvoxmend.*LD_LIBRARY_PATH' err || { cat err; exit 1; }
LD_LIBRARY_PATH=$library "$python" - <<'EOF'
import importlib.metadata, voxmend
assert voxmend.__file__.startswith(__import__("sys").prefix), voxmend.__file__
assert importlib.metadata.version("voxmend") == voxmend.__version__
assert "BSD" in importlib.metadata.metadata("voxmend")["License"]
grid = voxmend.voxelize("rocket.off", 16, mode="both")
grid.save("rocket.npy")
assert voxmend.read("rocket.npy").hash == grid.hash
EOF

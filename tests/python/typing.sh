#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Types: mypy --strict on the package, and on a program that uses all of it, which runs, too.
. "$SRCDIR/tests/python/lib.sh"
"$PYTHON" "$SRCDIR/tests/python/typed_program.py" >out || { cat out; exit 1; }
if ! "$PYTHON" -c "import mypy" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no mypy (Debian: mypy)"
  exit 77
fi
# As a user has it, and none of whose other packages are looked into.
MYPYPATH=$PYTHONPATH "$PYTHON" -m mypy --strict --config-file "$SRCDIR/python/pyproject.toml" --cache-dir "$SAMPLES/cache" \
  -p voxmend >log || { cat log; exit 1; }
MYPYPATH=$PYTHONPATH "$PYTHON" -m mypy --strict --config-file= --cache-dir "$SAMPLES/cache-of-user" --follow-imports silent \
  "$SRCDIR/tests/python/typed_program.py" >log || { cat log; exit 1; }
# It does look: a number where a name is wanted, and what is said to be a grid and is a field.
sed -e 's/mode="both"/mode=3/' -e 's/labels: voxmend.VoxelField = /labels: voxmend.VoxelGrid = /' "$SRCDIR/tests/python/typed_program.py" >wrong.py
! MYPYPATH=$PYTHONPATH "$PYTHON" -m mypy --strict --config-file= --cache-dir "$SAMPLES/cache-of-user" --follow-imports silent wrong.py >log
grep -q 'error: Argument "mode" to "voxelize" has incompatible type "int"' log || { cat log; exit 1; }
grep -q 'error: Incompatible types in assignment.*"VoxelField".*"VoxelGrid"' log || { cat log; exit 1; }
# What the package gives has types of its own: no function that programs call returns Any.
"$PYTHON" "$SRCDIR/tests/python/no_any.py"

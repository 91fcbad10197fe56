#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Writes grids and has them read by readers.py, "plain" or "numpy". Skipped where there is no such Python.
set -eu
folder=$(mktemp -d "${TMPDIR:-/tmp}/gridio-readers.XXXXXX")
trap 'rm -rf "$folder"' EXIT
"$BUILDDIR/tests/gridio/write_grids" "$folder"
[ -n "$TEST_PYTHON" ] || { echo "no Python"; exit 77; }
"$TEST_PYTHON" "$SRCDIR/tests/gridio/readers.py" "$1" "$folder"

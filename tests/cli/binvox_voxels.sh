#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What binvox does with voxels, and its files, against numpy and readers made from descriptions of the formats.
set -eu
"$TEST_PYTHON" -c 'import numpy' 2>/dev/null || { echo "no Python with numpy"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-binvox.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$BUILDDIR/samples/generate_samples" "$work"
zlib=no
grep -q '^#define HAVE_ZLIB 1' "$BUILDDIR/config.h" && zlib=yes
"$TEST_PYTHON" "$SRCDIR/tests/cli/binvox_voxels.py" "$BUILDDIR/binvox" "$VOXMEND" "$work" "$zlib"

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Set operations on values: random labels, colours, numbers and distances, dense and as octrees, against what Python makes of
# each voxel.
set -eu
"$TEST_PYTHON" -c '' 2>/dev/null || { echo "no Python"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-combine.XXXXXX")
trap 'rm -rf "$work"' EXIT
"$TEST_PYTHON" "$SRCDIR/tests/cli/combine_values.py" "$VOXMEND" "$work"

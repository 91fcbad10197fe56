#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Octree files of labels, colours and distances, which are made node by node, against the same made of the whole grid.
set -eu
"$TEST_PYTHON" -c '' 2>/dev/null || { echo "no Python"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-nodes.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/in"
"$BUILDDIR/samples/generate_samples" "$work/in"
"$TEST_PYTHON" "$SRCDIR/tests/cli/octree_nodes.py" "$VOXMEND" "$work"

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The API reference is made of the public headers without a warning, so that all that they declare is described.
set -eu
command -v doxygen >/dev/null || { echo "doxygen is not installed"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-reference.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/doc"
cd "$work"
doxygen "$BUILDDIR/doc/reference.doxy" >log 2>&1 || { cat log; echo "FAILED: the headers are not described in full"; exit 1; }
for page in voxmend_8h.html mesh_8h.html structvxm__census.html; do
  [ -s "doc/reference/html/$page" ] || { echo "FAILED: there is no $page"; exit 1; }
done

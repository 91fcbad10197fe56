#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Exports of a batch, read by zarr.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c "import zarr" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no zarr (Debian: python3-zarr)"
  exit 77
fi
"$PYTHON" "$SRCDIR/tests/python/test_batch_exports.py" zarr

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Exports of a batch, read by webdataset.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c "import torch, webdataset" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no webdataset (PyPI: webdataset)"
  exit 77
fi
"$PYTHON" "$SRCDIR/tests/python/test_batch_exports.py" webdataset

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Exports of a batch, read by pyarrow.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c "import pyarrow" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no pyarrow (PyPI: pyarrow)"
  exit 77
fi
"$PYTHON" "$SRCDIR/tests/python/test_batch_exports.py" pyarrow

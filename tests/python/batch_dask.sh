#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend.batch over Dask: two workers, one of them killed, the scheduler killed, Ctrl-C. DASK_TESTS chooses some.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c "import distributed" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no distributed (Debian: python3-distributed)"
  exit 77
fi
"$PYTHON" "$SRCDIR/tests/python/test_batch_dask.py" ${DASK_TESTS:-}

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# voxmend.batch without Dask, and tars.
. "$SRCDIR/tests/python/lib.sh"
"$PYTHON" "$SRCDIR/tests/python/test_batch.py"

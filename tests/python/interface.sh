#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Fields, engines, octrees, sets, defects, progress and timeouts.
. "$SRCDIR/tests/python/lib.sh"
"$PYTHON" "$SRCDIR/tests/python/test_interface.py"

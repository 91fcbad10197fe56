#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The package voxmend with numpy.
. "$SRCDIR/tests/python/lib.sh"
"$PYTHON" "$SRCDIR/tests/python/test_voxmend.py"
"$PYTHON" "$SRCDIR/tests/python/test_fields.py"
"$PYTHON" "$SRCDIR/tests/python/test_robust.py"

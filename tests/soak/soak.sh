#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Forty cases of soak.py, which goes on for as long as it is told to: see there.
set -eu
[ -n "$TEST_PYTHON" ] || { echo "no Python"; exit 77; }
"$TEST_PYTHON" "$SRCDIR/tests/soak/soak.py" "$BUILDDIR/voxmend" --cases 40 --jobs 2

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The lines of Python in the pages run.
. "$SRCDIR/tests/python/lib.sh"
cp rocket.off chair.off # which people have, and no sample is called
for page in README.md python/README.md doc/python.md; do
  "$PYTHON" "$SRCDIR/tests/python/run_blocks.py" "$SRCDIR/$page" >log 2>&1 || { cat log; exit 1; }
  tail -n 1 log
done

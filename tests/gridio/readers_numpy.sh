#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Reads written grids by numpy; skipped where that is missing.
exec "$SRCDIR/tests/gridio/readers.sh" numpy

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The programs that make the tables of the papers, on samples and small grids: each says what does not hold of what the
# papers promise. Skipped without a Python. PAPERS="rueda faieghi" chooses some.
set -eu
[ -n "${TEST_PYTHON:-}" ] || { echo "no Python"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-papers.XXXXXX")
trap 'rm -rf "$work"' EXIT
# OpenCL's drivers keep what they make once, and LeakSanitizer stumbles over their threads.
ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
export ASAN_OPTIONS
mkdir "$work/samples"
"$BUILDDIR/samples/generate_samples" "$work/samples"
for paper in ${PAPERS:-chen_tu rueda ogayar schwarz_seidel faieghi}; do
  echo "==== $paper"
  "$TEST_PYTHON" -B "$SRCDIR/tests/papers/$paper.py" --quick --samples "$work/samples" >"$work/$paper.md"
  cat "$work/$paper.md"
  grep -q '^| ' "$work/$paper.md" || grep -q '^No OpenCL' "$work/$paper.md"
done

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The datasets for PyTorch.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c 'import torch'; then
  echo "SKIPPED: $PYTHON has no torch (Debian: python3-torch)"
  exit 77
fi
"$PYTHON" "$SRCDIR/tests/python/test_torch.py"

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The datasets for PyTorch.
. "$SRCDIR/tests/python/lib.sh"
if ! "$PYTHON" -c "import torch" 2>/dev/null; then
  echo "SKIPPED: $PYTHON has no torch (Debian: python3-torch)"
  exit 77
fi
"$PYTHON" "$SRCDIR/tests/python/test_torch.py"
"$PYTHON" "$SRCDIR/tests/python/test_torch_grids.py"
# The sample that trains a network, as short as it can be.
"$PYTHON" "$SRCDIR/samples/train_voxnet.py" --epochs 2 --models 3 --variants 2 --resolution 16 >out
cat out
grep -Eq '^24 models of 8 classes to train, 8 to test; 16\^3 voxels$' out
grep -Eq '^epoch  2  loss [0-9.]+  validation +[0-9.]+ %' out
grep -Eq '^96 variants; the network waited [0-9.]+ s of [0-9.]+ s for voxels, [0-9.]+ %$' out

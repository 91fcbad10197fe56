# SPDX-License-Identifier: BSD-3-Clause
# What the scripts here share: the package of the build folder, and sample meshes.
set -eu
if [ -z "${PYTHON:-}" ]; then
  echo "SKIPPED: this build is without the Python package (configure --with-python says what is missing)"
  exit 77
fi
SAMPLES=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-python.XXXXXX")
trap 'rm -rf "$SAMPLES"' EXIT
"$BUILDDIR/samples/generate_samples" "$SAMPLES"
PYTHONPATH=$BUILDDIR/python-package
PYTHONDONTWRITEBYTECODE=1
export SAMPLES PYTHONPATH PYTHONDONTWRITEBYTECODE
cd "$SAMPLES"

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The site is built without a warning, its links lead somewhere, and the search finds what people look for.
set -eu
site=$(sed -n 's/^SITE_PYTHON = //p' "$BUILDDIR/Makefile")
[ -n "$site" ] || { echo "built without the site (configure says what is missing)"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-site.XXXXXX")
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*"
  exit 1
}
"$SRCDIR/doc/site/build" "$SRCDIR" "$BUILDDIR" "$work" "$site" "$("$VOXMEND" --version | sed -n '1s/^voxmend //p')" || fail "warnings"
"$site" "$SRCDIR/tests/doc/links.py" "$work/html" || fail "links"

# Light and dark as the system says, and by the button.
grep -q prefers-color-scheme "$work/html/_static/styles/furo.css" || fail "the style does not know the system's choice"
if grep -q '^import' "$work/html/_static/scripts/furo.js"; then
  fail "a script is a module, which browsers do not load from files"
fi

# Each command, each public function and each public name of Python is described.
"$VOXMEND" help --table | cut -f 1 | while read -r command; do
  [ -s "$work/html/reference/commands/$command.html" ] || echo "the command $command"
done >"$work/missing"
sed -n '/global:/,/local:/s/^ *\(vxm_[a-z0-9_]*\);.*/\1/p' "$SRCDIR/src/api/voxmend.map" | while read -r name; do
  grep -qF "id=\"c.$name\"" "$work"/html/reference/c/*.html || echo "$name in C"
done >>"$work/missing"
PYTHONPATH=$BUILDDIR/python-package "$site" -c 'import voxmend; print("\n".join(voxmend.__all__))' | while read -r name; do
  case $name in Field | MeshLike) continue ;; esac # names of types that others stand for
  grep -qF "id=\"voxmend.$name\"" "$work/html/reference/python.html" || echo "$name in Python"
done >>"$work/missing"
[ ! -s "$work/missing" ] || fail "the reference lacks: $(cat "$work/missing")"
for word in modelnet watertight; do
  grep -q "\b$word\b" "$work/html/searchindex.js" || fail "the search does not know $word"
done

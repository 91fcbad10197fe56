#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Files of several gzip members, as pigz, bgzip and cat make them, hold what those of one do.
set -eu
grep -q '^#define HAVE_ZLIB 1' "$BUILDDIR/config.h" || { echo "built without zlib"; exit 77; }
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-gzip.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work"
"$BUILDDIR/samples/generate_samples" . >/dev/null
"$VOXMEND" voxelize sphere.off -o a.npy -r 20 -q
for format in nii.gz schem litematic; do
  "$VOXMEND" convert a.npy -o "a.$format" -q
  gzip -dc <"a.$format" >whole
  for cut in 1 2 100 360 "$(($(wc -c <whole) - 1))"; do # within the header, at its end, in the values
    { head -c "$cut" whole | gzip; printf '' | gzip; tail -c "+$((cut + 1))" whole | gzip; } >"b.$format"
    "$VOXMEND" convert "b.$format" -o b.npy -q
    cmp a.npy b.npy
    { cat "b.$format"; echo "what stands behind is not looked at"; } >"c.$format"
    "$VOXMEND" convert "c.$format" -o b.npy -q
    cmp a.npy b.npy
  done
  head -c "$cut" whole | gzip >"c.$format"
  ! "$VOXMEND" convert "c.$format" -o none.npy 2>error
  [ "$(wc -l <error)" = 1 ] && [ ! -e none.npy ]
done
# .nrrd: the values alone are compressed
"$VOXMEND" convert a.npy -o a.nrrd -q
sed -n '/^$/q;p' a.nrrd | grep -q 'encoding: raw'
size=$((20 * 20 * 20))
{ sed -n '/^$/q;p' a.nrrd | sed 's/encoding: raw/encoding: gzip/'; echo; tail -c $size a.nrrd | head -c 999 | gzip
  tail -c $((size - 999)) a.nrrd | gzip; } >b.nrrd
"$VOXMEND" convert b.nrrd -o b.npy -q
cmp a.npy b.npy

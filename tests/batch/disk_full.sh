#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A disk that is full in the middle of a batch: it ends with a clear line, no half file, and goes on when there is room.
# The disk is one in memory; making it takes the right to mount, if need be in a user namespace of its own.
set -eu
if [ "${1:-}" != inside ]; then
  unshare -rm true 2>/dev/null || { echo "no right to mount"; exit 77; }
  exec unshare -rm "$0" inside
fi
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-disk.XXXXXX")
trap 'umount "$work/disk" 2>/dev/null || true; rm -rf "$work"' EXIT
mkdir "$work/disk" "$work/in"
mount -t tmpfs -o size=300k none "$work/disk" || exit 77
"$BUILDDIR/samples/generate_samples" "$work/samples" 2>/dev/null || { mkdir "$work/samples" && "$BUILDDIR/samples/generate_samples" "$work/samples"; }
for n in 1 2 3 4 5 6 7 8 9; do
  for name in sphere torus cube rocket; do
    sed "3s/^\([-0-9.]*\)/\1$n/" "$work/samples/$name.off" >"$work/in/$name$n.off"
  done
done
batch() {
  "$VOXMEND" batch "$work/in" -o "$1" -r 32 --format npy --pictures 0 --progress never
}
fail() {
  echo "FAILED: $1"
  exit 1
}
batch "$work/calm" >/dev/null
status=0
batch "$work/disk/out" >"$work/said" 2>&1 || status=$?
cat "$work/said"
[ "$status" -eq 1 ] || fail "a full disk gives exit status $status"
grep -qiE 'no (room|space) ' "$work/said" || fail "it does not say that there is no room"
# What is there is whole.
for file in $(cd "$work/disk/out" && find . -name '*.npy'); do
  cmp "$work/disk/out/$file" "$work/calm/$file" || fail "$file is not whole"
done
mount -o remount,size=30m "$work/disk"
batch "$work/disk/out"
"$VOXMEND" batch verify "$work/disk/out"
for file in $(cd "$work/calm" && find . -name '*.npy*'); do
  cmp "$work/disk/out/$file" "$work/calm/$file" || fail "$file is another"
done

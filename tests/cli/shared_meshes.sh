#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every mesh of the shared collection goes through info, repair and voxelize; files of the malformed/ folder may be
# refused, with one line and exit status 1. Skipped where the collection is not there.
# RESOLUTION=N chooses another resolution than 64; MESH_BYTES=N leaves out what is larger; REFUSED=FILE keeps the list of the refused files and the reasons.
set -eu
meshes=$SRCDIR/../shared/meshes
[ -d "$meshes" ] || exit 77
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-meshes.XXXXXX")
trap 'rm -rf "$work"' EXIT
find "$meshes" -type f ! -name '*.tsv' ! -name '*.mtl' ! -name '*.md' ${MESH_BYTES:+-size -"$MESH_BYTES"c} | LC_ALL=C sort >"$work/list"
bad=0
count=0
: >"$work/refused"

# attempt MESH COMMAND...: success, or a refusal that is allowed.
attempt() {
  mesh=$1
  shift
  status=0
  "$VOXMEND" "$@" -q --threads 2 >"$work/out" 2>"$work/err" || status=$?
  lines=$(wc -l <"$work/err")
  short=${mesh#"$meshes"/}
  if [ "$status" -eq 0 ] && [ "$lines" -eq 0 ]; then
    return 0
  fi
  if [ "$status" -eq 1 ] && [ "$lines" -eq 1 ] && [ -z "$(ls "$work"/x.* 2>/dev/null)" ]; then
    case $short in
    malformed/*)
      printf '%s\t%s\t%s\n' "$short" "$1" "$(sed "s|$meshes/||g" "$work/err")" >>"$work/refused"
      return 0
      ;;
    esac
  fi
  echo "FAILED: $1 $short: exit status $status"
  cat "$work/err"
  bad=$((bad + 1))
}

while read -r mesh; do
  rm -f "$work"/x.*
  attempt "$mesh" info "$mesh"
  attempt "$mesh" repair "$mesh" -o "$work/x.ply"
  rm -f "$work"/x.*
  attempt "$mesh" voxelize "$mesh" -o "$work/x.rle" -r "${RESOLUTION:-64}"
  count=$((count + 1))
done <"$work/list"
[ -z "${REFUSED:-}" ] || cp "$work/refused" "$REFUSED"
echo "$count meshes, $(cut -f 1 "$work/refused" | sort -u | wc -l) refused, $bad failures"
cat "$work/refused"
[ "$bad" -eq 0 ] && [ "$count" -gt 0 ]

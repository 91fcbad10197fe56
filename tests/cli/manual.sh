#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The manual page describes every command, and every option that --help lists.
set -eu
page=$SRCDIR/doc/voxmend.1
plain=$(mktemp "${TMPDIR:-/tmp}/voxmend-manual.XXXXXX")
trap 'rm -f "$plain"' EXIT
sed -e 's/\\-/-/g' -e 's/\\f[A-Z]//g' "$page" >"$plain"
bad=0
commands=$("$VOXMEND" --help | sed -n 's/^  \([a-z]*\)  .*/\1/p')
[ "$(echo $commands | wc -w)" -ge 8 ] || { echo "FAILED: commands: $commands"; exit 1; }
for command in $commands; do
  # What the page says of this command, and of all of them.
  part=$(awk -v name="$command" '/^\.SS|^\.SH/ { inside = ($0 ~ "voxmend " name "( |\"|$)") || /COMMON OPTIONS/ } inside' "$plain")
  [ -n "$part" ] || { echo "FAILED: the manual page has no section on $command"; bad=1; continue; }
  for option in $("$VOXMEND" "$command" --help | grep -oE '^ {2,6}(-., )?--[a-z0-9-]+' | grep -oE -- '--[a-z0-9-]+'); do
    printf '%s\n' "$part" | grep -qE -- "$option([^a-z0-9-]|$)" || { echo "FAILED: the manual page of $command lacks $option"; bad=1; }
  done
done
exit "$bad"

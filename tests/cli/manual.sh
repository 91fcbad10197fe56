#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The manual pages say what --help says: each command has a page, made of its section of voxmend.1, with its summary,
# every option and every word that an option takes, and no option that is not there.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-manual.XXXXXX")
trap 'rm -rf "$work"' EXIT
bad=0
fail() {
  echo "FAILED: $1"
  bad=1
}
plain() {
  sed -e 's/\\-/-/g' -e 's/\\f[A-Z]//g' "$1"
}

"$VOXMEND" help --table >"$work/commands"
[ "$(wc -l <"$work/commands")" -ge 8 ] || fail "commands: $(cat "$work/commands")"
while IFS='	' read -r command summary; do
  page=$BUILDDIR/doc/voxmend-$command.1
  [ -s "$page" ] || { fail "there is no manual page doc/voxmend-$command.1: add it to doc/doc.am"; continue; }
  sed '1,/^\.SH SYNOPSIS/d; /^\.SH DESCRIPTION/,$d' "$SRCDIR/doc/voxmend.1" | grep -qE "^\.B voxmend $command( |$)" ||
    fail "the synopsis of voxmend(1) lacks $command"
  plain "$page" >"$work/page"
  grep -qxF "voxmend-$command - $summary" "$work/page" || fail "the summary of voxmend-$command(1) is not '$summary'"
  # Where options are explained: what stands before the text, at .TP, and the description where there is little to say.
  awk '/^\.SH/ { inside = $2 == "DESCRIPTION" } /^\.TP/ { getline; print; next } inside' "$work/page" >"$work/tags"
  "$VOXMEND" help --table "$command" >"$work/options"
  cut -f 1 "$work/options" >"$work/names"
  if [ ! -s "$work/options" ]; then # options of another kind, behind one dash
    "$VOXMEND" "$command" --help | sed -n 's/^  \(-[a-z]*\) .*/\1\t/p' >"$work/options"
    [ "$(wc -l <"$work/options")" -ge 8 ] || fail "$command --help lists no options"
  fi
  cut -f 1,3 "$work/options" | while IFS='	' read -r option argument; do
    grep -qE -- "(^|[^a-z0-9-])$option([^a-z0-9-]|$)" "$work/tags" || echo "voxmend-$command(1) lacks $option"
    for word in $(printf '%s' "$argument" | tr '|' '\n' | grep -xE '[a-z0-9][a-z0-9-]*'); do
      grep -qE -- "(^|[^a-z0-9-])$word([^a-z0-9-]|$)" "$work/page" || echo "voxmend-$command(1) lacks the $word of $option"
    done
  done >"$work/missing"
  # What stands before the text on an option, at .TP, are options of this command; the common ones are of most.
  sed '/^\.SH COMMON OPTIONS/,$d' "$work/page" | sed -n '/^\.TP/{n;p;}' | grep -oE -- '--[a-z0-9-]+' | sort -u |
    while read -r option; do
      grep -qxF -- "$option" "$work/names" || echo "voxmend-$command(1) has $option, which $command --help has not"
    done >>"$work/missing"
  while read -r line; do
    fail "$line"
  done <"$work/missing"
  if command -v man >/dev/null && man --warnings -l "$page" >/dev/null 2>"$work/warnings"; then
    [ ! -s "$work/warnings" ] || fail "voxmend-$command(1): $(cat "$work/warnings")"
  fi
done <"$work/commands"
# Macros of two fonts leave no blanks between their words: a sentence that begins on such a line has none.
! grep -nE '^\.[BIR]{2} .* [.,;:] [A-Za-z]' "$SRCDIR/doc/voxmend.1" >"$work/joined" ||
  fail "voxmend(1): $(cat "$work/joined")"
for page in "$BUILDDIR"/doc/voxmend-*.1; do
  command=${page##*/voxmend-}
  cut -f 1 "$work/commands" | grep -qxF "${command%.1}" || fail "$page is of no command"
done
exit "$bad"

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The order of the rooms: each includes only those before it, the command line sees voxmend.h alone, and nothing
# below it prints or ends the program.
set -eu
cd "$SRCDIR/src"
bad=0
complain() {
  echo "FAILED: $1"
  printf '%s\n' "$2"
  bad=1
}

seen=
for room in base mesh meshio repair grid voxel gpu gridio augment batch api; do
  seen="$seen $room"
  [ -d "$room" ] || continue
  allowed=$(echo "$seen" | sed 's/^ //; s/ /|/g')
  found=$(grep -rnE '#[[:space:]]*include[[:space:]]+"' "$room" --include='*.[ch]' --include='*.cc' --include='*.inc' |
    grep -vE "\"(($allowed)/[^\"]*|voxmend\.h|config\.h|shaders/(kernels|shaders)\.inc)\"" || true)
  [ -z "$found" ] || complain "$room includes what does not come before it" "$found"
done
found=$(grep -rnE '#[[:space:]]*include[[:space:]]+"' cli | grep -vE '"(cli/[^"]*|voxmend\.h|config\.h)"' || true)
[ -z "$found" ] || complain "cli includes more than voxmend.h and its own headers" "$found"

for room in $seen; do
  [ -d "$room" ] || continue
  found=$(grep -rnE '(^|[^a-zA-Z_])(printf|puts|putchar|vprintf|perror|exit|abort|_exit)[[:space:]]*\(|(^|[^a-zA-Z_<])std(out|err)[^a-zA-Z_]' "$room" \
    --include='*.[ch]' --include='*.cc' --include='*.inc' | grep -vE ':[[:space:]]*(/\*|\*|//)' || true)
  [ -z "$found" ] || complain "$room prints or ends the program" "$found"
done

found=$(for file in $(find . ../tests ../samples -name '*.[ch]' -o -name '*.cc'); do
  head -n 1 "$file" | grep -q 'SPDX-License-Identifier' || echo "$file"
done)
[ -z "$found" ] || complain "no licence line" "$found"
exit "$bad"

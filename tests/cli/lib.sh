# SPDX-License-Identifier: BSD-3-Clause
# Golden tests of the command line, sourced by the test scripts. A script runs commands with `run`, which writes down
# the command, what it printed and its exit status; `finish` compares the whole with expect/NAME.txt.
# REFRESH=1 writes the expectation anew: read the difference before it is committed.
#
#   $ voxmend info cube.off        the command
#   text                           what it wrote to standard output
#   ! voxmend: text                what it wrote to standard error
#   exit 1                         its status, where that is not 0
set -eu
name=$(basename "$0" .sh)
expected=$SRCDIR/tests/cli/expect/$name.txt
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-cli.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/in"
"$BUILDDIR/samples/generate_samples" "$work/in"
cd "$work"
voxmend() {
  "$VOXMEND" "$@"
}
: >transcript

# OpenCL's drivers keep what they make once, and LeakSanitizer stumbles over their threads.
without_leak_check() {
  ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
  export ASAN_OPTIONS
}

# Times, memory, the number of processors and what else is read differ between runs and machines.
mask() {
  sed -E \
    -e 's/^(time +)[0-9.]+ ms: read [0-9.]+, repair [0-9.]+, voxelize [0-9.]+, write [0-9.]+/\1T ms: read T, repair T, voxelize T, write T/' \
    -e 's/("(read|repair|voxelize|write|total)": )[0-9][0-9.e+-]*/\1T/' \
    -e 's/("(peak|memory)_bytes": )[0-9]+/\1N/' \
    -e 's/^(threads +)[0-9]+/\1N/' \
    -e '/memory limit/s/[0-9.]+ (bytes|KiB|MiB|GiB|TiB)/N bytes/g' \
    -e 's/(what is read here: off obj stl ply).*/\1 .../' \
    -e 's/^(memory +)[0-9.]+ [KMG]iB/\1N MiB/'
}

say() {
  printf '%s\n' "$*" >>transcript
}

run() {
  say "\$ $1"
  status=0
  (eval "$1") >out.txt 2>err.txt </dev/null || status=$?
  mask <out.txt >>transcript
  mask <err.txt | sed 's/^/! /' >>transcript
  if [ "$status" -ne 0 ]; then
    say "exit $status"
  fi
  say ""
}

finish() {
  if [ "${REFRESH:-}" = 1 ]; then
    mkdir -p "$SRCDIR/tests/cli/expect"
    cp transcript "$expected"
  fi
  diff -u "$expected" transcript
}

#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A signal in the middle of the work leaves no file, and the program ends by that signal; two at once are as one.
# A second one later ends the program at once.
set -eu
work=$(mktemp -d "${TMPDIR:-/tmp}/voxmend-interrupt.XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/in" "$work/out"
"$BUILDDIR/samples/generate_samples" "$work/in"

# interrupted COMMAND...: with a signal after some time. Runs may be done before that, but not all of them.
interrupted() {
  ended=0
  for delay in 0.05 0.1 0.2 0.3 0.4; do
    "$VOXMEND" "$@" --threads 1 >/dev/null 2>"$work/err" &
    job=$!
    sleep "$delay"
    kill -TERM "$job" 2>/dev/null || true
    kill -TERM "$job" 2>/dev/null || true
    status=0
    wait "$job" || status=$?
    if [ "$status" -ne 0 ]; then
      [ "$status" -eq 143 ] || { echo "FAILED: exit status $status"; cat "$work/err"; exit 1; }
      ended=$((ended + 1))
      [ -z "$(ls "$work/out")" ] || { echo "FAILED: left behind:"; ls "$work/out"; exit 1; }
    fi
    rm -f "$work/out/"*
  done
  [ "$ended" -gt 0 ] || { echo "FAILED: no signal ended voxmend $1"; exit 1; }
}

interrupted voxelize "$work/in/rocket.off" -o "$work/out/x.rle" -r 1400
interrupted bench "$work/in/rocket.off" --plot "$work/out/x.svg" --report "$work/out/x.json"

# The program that runs as $job is to end by the signal that comes after each of these delays, the second at the latest.
signal_twice() {
  for delay; do
    sleep "$delay"
    kill -TERM "$job" 2>/dev/null || true # gone where the first one came before the program had begun
  done
  (sleep 5; kill -KILL "$job") 2>/dev/null 3<&- &
  watch=$!
  status=0
  wait "$job" || status=$?
  kill "$watch" 2>/dev/null || true
  [ "$status" -eq 143 ] || { echo "FAILED: exit status $status"; cat "$work/err"; exit 1; }
}

# Where the work does not come to an end by itself: it waits for more to read.
mkfifo "$work/fifo"
exec 3<>"$work/fifo"
"$VOXMEND" info - <"$work/fifo" >/dev/null 2>"$work/err" 3<&- &
job=$!
signal_twice 0.3 0.8

# A batch, which lets what is in work come to its end at the first one: here it never does.
echo fifo >"$work/list.txt"
"$VOXMEND" batch "$work/list.txt" -o "$work/batch" -r 8 >/dev/null 2>"$work/err" 3<&- &
job=$!
signal_twice 1 0.5

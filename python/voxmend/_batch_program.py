# SPDX-License-Identifier: BSD-3-Clause
"""The program voxmend, and one shard of a batch by it: what a worker does."""
from __future__ import annotations

import collections
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from typing import Any, Callable, Dict, Optional, Sequence

from . import __version__, _program
from ._errors import ArgumentError, UnavailableError

WRONG_USAGE = 2
LOCKED = "another batch is at work there"
# Becomes the program, which is killed when this process dies, however that may be. (Not by preexec_fn: that runs between
# fork and exec of a process with threads.)
_GUARD = """
import ctypes, os, signal, sys
ctypes.CDLL(None).prctl(1, signal.SIGKILL, 0, 0, 0)
if os.getppid() != int(sys.argv[1]):
    sys.exit(1)
os.execv(sys.argv[2], sys.argv[2:])
"""


def find_program(given: Any = None) -> str:
    """Path of the program voxmend: the one given, or that of the package, or that on the PATH."""
    if given is not None:
        found = shutil.which(os.fsdecode(given))
        if not found:
            raise ArgumentError("batch: there is no program %s" % os.fsdecode(given))
        return os.path.abspath(found)
    own = _program.find()
    if not own:
        raise UnavailableError("batch: the program voxmend is neither beside the package nor on the PATH; name it: "
                               "program=... or --program")
    return own


def check_version(program: str) -> None:
    """Refuses a program of another version: its bytes may be other ones."""
    try:
        told = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=60).stdout.split()
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise UnavailableError("batch: %s cannot be run: %s" % (program, problem)) from None
    if told != ["voxmend", __version__]:
        raise UnavailableError("batch: %s is '%s', the package is of version %s: install the same everywhere" %
                               (program, " ".join(told), __version__))


# What became of a shard: {"shard", "rc", "line", "seconds", "host"}; `line` is its last word on standard error.
ShardResult = Dict[str, Any]


def _end(process: "subprocess.Popen[str]", patience: float) -> None:
    """Asks twice, then kills: the first signal lets it finish what is in flight, the second stops at once."""
    for number in (signal.SIGTERM, signal.SIGTERM, signal.SIGKILL):
        if process.poll() is not None:
            return
        process.send_signal(number)
        try:
            process.wait(patience)
        except subprocess.TimeoutExpired:
            pass


def _once(words: Sequence[str], folder: str, is_wanted: Callable[[], bool], patience: float) -> "tuple[int, str]":
    """Runs the program to its end; exit status, and its last line on standard error. It is ended when it is no longer
    wanted."""
    last: "collections.deque[str]" = collections.deque(maxlen=1)
    guarded = [sys.executable, "-c", _GUARD, str(os.getpid()), *words]
    with subprocess.Popen(guarded, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True, errors="replace") as process:
        reader = threading.Thread(target=lambda: last.extend(process.stderr or ()), daemon=True)
        reader.start()
        try:
            while process.poll() is None:
                if not is_wanted():
                    _end(process, patience)
                    break
                try:
                    process.wait(0.5)
                except subprocess.TimeoutExpired:
                    pass
        finally:
            _end(process, patience)
        reader.join(10)
        line = " ".join(last).strip()
        return process.returncode, line[len("voxmend: "):] if line.startswith("voxmend: ") else line


def run_shard(shard: int, shards: int, inputs: Sequence[str], output: str, options: Sequence[str], *, folder: str,
              jobs: int, program: Optional[str] = None, is_wanted: Callable[[], bool] = lambda: True,
              wait_for_lock: float = 600, patience: float = 10) -> ShardResult:
    """Runs one shard in this process's machine. Where another process is still at work at it (the one before may just be
    dying), that one's end is waited for, for `wait_for_lock` seconds."""
    start = time.monotonic()
    found = find_program(program)
    check_version(found)
    if not os.path.isdir(folder):
        raise ArgumentError("batch: %s is no folder of the machine %s: all have to see the same folders" %
                            (folder, os.uname().nodename))
    words = [found, "batch", *options, "-o", output, "--shard", "%d/%d" % (shard, shards), "-j", str(jobs),
             "--progress", "never", "--", *inputs]
    while True:
        rc, line = _once(words, folder, is_wanted, patience)
        if rc == 0 or LOCKED not in line or not is_wanted() or time.monotonic() - start > wait_for_lock:
            break
        time.sleep(2)
    return {"shard": shard, "rc": rc, "line": line, "seconds": time.monotonic() - start, "host": os.uname().nodename}

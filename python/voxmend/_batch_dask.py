# SPDX-License-Identifier: BSD-3-Clause
"""The shards of a batch by dask.distributed: a task for each, few in flight, done again where a worker dies.

A task may run twice, or half: the journal of its shard makes that harmless. So there is nothing to be collected but whether
each has come to its end.
"""
from __future__ import annotations

import contextlib
import inspect
import os
import time
import uuid
from typing import Any, Callable, Dict, Iterator, List, Optional

from . import _batch_program
from ._errors import ArgumentError, UnavailableError, VoxmendError

LOST_S = 30.0  # without a scheduler for so long, the client gives up


class BatchError(VoxmendError, RuntimeError):
    """Shards did not come to their end. The same call goes on with them."""


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise UnavailableError("batch: Dask is not installed (Debian: python3-distributed; PyPI: distributed)") from None
    return distributed


# ---- In a worker ----

def _processors() -> int:
    return len(os.sched_getaffinity(0))


def _host(address: str) -> str:
    return address.rsplit(":", 1)[0]


def _still_wanted() -> Callable[[], bool]:
    """Whether the task of this thread is still asked for: its client may have cancelled it, or be gone."""
    from distributed import get_worker
    from distributed.worker import thread_state
    worker, key = get_worker(), getattr(thread_state, "key", None)

    def is_wanted() -> bool:
        task = worker.state.tasks.get(key) if key is not None else None
        return key is None or (task is not None and task.state == "executing")
    return is_wanted


def shard_task(shard: int, slots: Dict[str, int], arguments: Dict[str, Any]) -> Dict[str, Any]:
    """What a worker is given. `slots` is how many tasks run at a time on each machine: they share its processors."""
    from distributed import get_worker
    own = dict(arguments)
    own["jobs"] = own["jobs"] or max(1, _processors() // max(1, slots.get(_host(get_worker().address), 1)))
    return _batch_program.run_shard(shard, is_wanted=_still_wanted(), **own)


# ---- In the client ----

@contextlib.contextmanager
def _client(where: Any) -> Iterator[Any]:
    """A client of "local", "local:WORKERS", a scheduler's address or file, or the caller's own client."""
    distributed = _distributed()
    if isinstance(where, distributed.Client):
        yield where
        return
    if isinstance(where, str) and where.partition(":")[0] == "local":
        number = where.partition(":")[2] or str(_processors())
        if not number.isdigit() or not 0 < int(number) <= 4096:
            raise ArgumentError("batch: dask '%s' is not local:WORKERS, such as local:2" % where)
        with distributed.LocalCluster(n_workers=int(number), threads_per_worker=1, processes=True, memory_limit=0,
                                      dashboard_address="127.0.0.1:0") as cluster, distributed.Client(cluster) as client:
            yield client
        return
    try:
        is_file = isinstance(where, str) and where.endswith(".json")
        client = distributed.Client(**{"scheduler_file" if is_file else "address": where}, timeout=LOST_S)
    except (OSError, ValueError, TypeError) as problem:
        raise ArgumentError("batch: no Dask scheduler answers at %s: %s" %
                            (where, " ".join(str(problem).split()) or type(problem).__name__)) from None
    try:
        yield client
    finally:
        with contextlib.suppress(Exception):  # the scheduler may be gone
            client.close(timeout=2)


class _Shards:
    """Shards on their way: which are to be begun, which are with the scheduler, and how often each was tried."""

    def __init__(self, client: Any, arguments: Dict[str, Any], retries: int, tell: Callable[[str], None]):
        self.client, self.arguments, self.retries, self.tell = client, arguments, retries, tell
        self.count = arguments["shards"]
        self.waiting = list(range(self.count))
        self.tries = [0] * self.count
        self.said = [""] * self.count  # why it failed last
        self.in_flight: Dict[Any, int] = {}  # future: shard
        self.done = 0
        self.failed: List[str] = []
        # newer versions tell of five workers only, unless they are asked for all
        self.info = {"n_workers": -1} if "n_workers" in inspect.signature(client.scheduler_info).parameters else {}

    def _slots(self) -> Dict[str, int]:
        """Tasks that run at a time on each machine."""
        out: Dict[str, int] = {}
        for address, worker in list(self.client.scheduler_info(**self.info).get("workers", {}).items()):
            out[_host(address)] = out.get(_host(address), 0) + worker.get("nthreads", 1)
        return out

    def fill(self) -> List[Any]:
        """Hands out shards: one for each that runs, and one that waits beside it. Returns the new futures."""
        new: List[Any] = []
        slots = self._slots() if self.waiting else {}
        while self.waiting and len(self.in_flight) < 2 * max(1, sum(slots.values())):
            shard = self.waiting.pop(0)
            self.tries[shard] += 1
            future = self.client.submit(shard_task, shard, slots, self.arguments, pure=False,
                                        key="voxmend-batch-%d-%s" % (shard, uuid.uuid4().hex))
            self.in_flight[future] = shard
            new.append(future)
        return new

    def _failure(self, shard: int, future: Any) -> Optional[str]:
        """Why a shard has to be tried again; None where it is done. Raises what no second try would mend."""
        if future.status == "finished":
            result = future.result()
            if result["rc"] == 0:
                self.done += 1
                self.tell("shard %d of %d is at its end after %.1f s on %s; %d are left" %
                          (shard, self.count, result["seconds"], result["host"], self.count - self.done))
                return None
            if result["rc"] == _batch_program.WRONG_USAGE:
                raise ArgumentError("batch: " + result["line"])
            return result["line"] or "ended by signal %d" % -result["rc"]
        if future.status == "error":
            problem = future.exception()
            if isinstance(problem, (ArgumentError, UnavailableError)):
                raise problem
            return " ".join(str(problem).split())
        return "the scheduler lost it"

    def take(self, future: Any) -> None:
        """What has become of one."""
        shard = self.in_flight.pop(future)
        line = self._failure(shard, future)
        if line is None:
            return
        is_new, self.said[shard] = line != self.said[shard], line
        if is_new and self.tries[shard] <= self.retries:
            self.tell("shard %d is begun again: %s" % (shard, line))
            self.waiting.append(shard)
        else:
            self.failed.append("shard %d: %s" % (shard, line))

    def _wait_for_scheduler(self) -> None:
        until = time.monotonic() + LOST_S
        while self.client.status != "running":
            if self.client.status == "closed" or time.monotonic() > until:
                raise BatchError("batch: the scheduler is gone, with %d of %d shards at their end; the same command goes on" %
                                 (self.done, self.count))
            time.sleep(0.1)

    def run(self) -> None:
        import distributed
        ended = distributed.as_completed(self.fill())
        while self.in_flight or self.waiting:
            self._wait_for_scheduler()
            ready = ended.next_batch(block=False) if not ended.is_empty() else []
            for future in ready:
                self.take(future)
            if not ready:
                time.sleep(0.2)
            with contextlib.suppress(OSError):  # a scheduler that has just gone is noticed in the next turn
                for future in self.fill():
                    ended.add(future)

    def cancel(self) -> None:
        """The workers end what they run; what they have done stays."""
        if self.in_flight and self.client.status == "running":
            with contextlib.suppress(Exception):
                self.client.cancel(list(self.in_flight), force=True)
        self.in_flight.clear()


def run_shards(where: Any, arguments: Dict[str, Any], retries: int, tell: Callable[[str], None]) -> None:
    """Runs all shards; returns when each has come to its end.

    Args:
        arguments: of `run_shard`, without the shard.
        retries: how often a shard is tried again that failed, or whose worker died; one that says the same twice is given up.
        tell: called with a line for each that ends.
    """
    with _client(where) as client:
        shards = _Shards(client, arguments, retries, tell)
        try:
            shards.run()
        finally:
            shards.cancel()
        if shards.failed:
            raise BatchError("batch: %d of %d shards did not come to their end; the same command goes on; %s" %
                             (len(shards.failed), shards.count, "; ".join(sorted(shards.failed)[:3])))

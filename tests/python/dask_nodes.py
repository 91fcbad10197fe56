# SPDX-License-Identifier: BSD-3-Clause
"""A scheduler or a worker in a process of its own, the same for all versions of dask.distributed.

    dask_nodes.py scheduler FILE        writes its address to FILE
    dask_nodes.py worker ADDRESS
"""
import asyncio
import os
import sys

import distributed


async def scheduler(path):
    async with distributed.Scheduler(host="127.0.0.1", port=0, dashboard=False, dashboard_address=None) as node:
        with open(path + ".new", "w") as file:
            file.write(node.address)
        os.rename(path + ".new", path)
        await node.finished()


async def worker(address):
    async with distributed.Worker(address, nthreads=1, memory_limit=0, dashboard=False) as node:
        await node.finished()


if __name__ == "__main__":
    asyncio.run({"scheduler": scheduler, "worker": worker}[sys.argv[1]](sys.argv[2]))

"""Workers: processes of this machine, or of all machines of a cluster. The one file that knows Dask."""
# Dask has no types.
# pyright: reportUnknownVariableType=false, reportUnknownMemberType=false, reportUnknownArgumentType=false

import logging
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib import metadata
from itertools import islice
from typing import Any, Generic, Self, TypeVar

from ..errors import BatchError
from .extra import need

J = TypeVar("J")
R = TypeVar("R")
LIMITS = ("TANGIBLE_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Environment variables that limit the threads of a worker's libraries, before it imports them."""
AHEAD = 4
"""Jobs with the scheduler for each worker: enough that none waits; no more, so that nothing grows with their number."""
CONNECT_S = 10
DISTRIBUTION = "tangible-images"
LOUD = ("distributed", "tornado", "bokeh")
"""They log what is no news here: that workers come and go."""


@dataclass(frozen=True)
class Done(Generic[J, R]):
    """A job, and what came of it."""

    job: J
    result: R | None
    """None where its worker died of it."""
    death: str = ""
    """How; empty where it did not."""


class Farm:
    """A cluster on this machine, or the scheduler at an address. Ended by `close`, or by leaving its block."""

    def __init__(self, workers: int, threads: int = 1, scheduler: str = "", preload: str = "") -> None:
        """preload: a module that each worker imports before it is given a job.

        Raises: BatchError without the extra, if nobody answers at the address, or workers have another version.
        """
        distributed = need("distributed")  # puts its own settings there, so that they are there again afterwards
        self._settings = need("dask").config.set(SETTINGS)
        self._settings.__enter__()
        for name in LOUD:
            logging.getLogger(name).setLevel(logging.CRITICAL)
        self._cluster: Any = None
        try:
            if scheduler:
                self._client: Any = _client(distributed, scheduler)
            else:
                self._cluster = _cluster(distributed, workers, threads, preload)
                self._client = distributed.Client(self._cluster)
            self._as_completed = distributed.as_completed
            self.workers = len(self._client.scheduler_info(n_workers=-1)["workers"])
            self._check(scheduler)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the workers that this one started."""
        with suppress(Exception):
            if getattr(self, "_client", None) is not None:
                self._client.close(timeout=5)
        if self._cluster is not None:
            self._cluster.close(timeout=10)
            self._cluster = None
        self._settings.__exit__(None, None, None)

    def map(self, work: Callable[[J], R], jobs: Iterable[J], chunk: int = 1) -> Iterator[Done[J, R]]:
        """work(job) for each, as they are done, on any worker; a result comes once.

        chunk: jobs that are sent together: less to do for the scheduler where each is short. A job whose worker dies is
        tried again by itself, when all others are done: so it alone fails, and none that was beside it.
        """
        todo = iter(jobs)
        waiting: dict[str, list[J]] = {}

        def send() -> Any:
            if part := list(islice(todo, chunk)):
                future = self._client.submit(_each, work, part, pure=False)
                waiting[future.key] = part
                return future
            return None

        first = [future for _ in range(AHEAD * max(1, self.workers)) if (future := send()) is not None]
        flow, suspects = self._as_completed(first), list[J]()
        for future in flow:
            part = waiting.pop(future.key)
            if future.status == "finished":
                yield from (Done(job, result) for job, result in zip(part, future.result(), strict=True))
            else:
                suspects += part
            future.release()
            if (more := send()) is not None:
                flow.add(more)
        for job in suspects:
            yield self._alone(work, job)

    def _alone(self, work: Callable[[J], R], job: J) -> Done[J, R]:
        future = self._client.submit(_each, work, [job], pure=False)
        try:
            return Done(job, future.result()[0])
        except Exception as error:  # noqa: BLE001 - of Dask, which says in many ways that a worker is gone
            return Done(job, None, f"its worker died of it, twice ({type(error).__name__})")
        finally:
            future.release()

    def _check(self, scheduler: str) -> None:
        if not self.workers:
            raise BatchError(f"{scheduler}: has no workers; start some: dask worker {scheduler}")
        mine = installed()
        for address, theirs in self._client.run(metadata.version, DISTRIBUTION).items():
            if theirs != mine:
                raise BatchError(
                    f"the worker {address} has {DISTRIBUTION} {theirs}, and this is {mine}; install "
                    "the same on all machines"
                )


def installed() -> str:
    """The version of this."""
    return metadata.version(DISTRIBUTION)


SETTINGS = {
    "distributed.scheduler.allowed-failures": 0,  # what killed a worker is tried again alone, not on the next one
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.worker.daemon": False,  # a pipeline has processes of its own
    "distributed.comm.timeouts.connect": f"{CONNECT_S}s",
    "distributed.admin.tick.limit": "60s",
}


def _cluster(distributed: Any, workers: int, threads: int, preload: str) -> Any:
    environment = {name: str(threads) for name in LIMITS}
    before = {name: os.environ.get(name) for name in environment}
    os.environ.update(environment)  # the workers inherit it
    try:
        return distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
            memory_limit=0,
            silence_logs=50,
            preload=[preload] if preload else [],
        )
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _client(distributed: Any, address: str) -> Any:
    try:
        return distributed.Client(address, timeout=CONNECT_S)
    except (OSError, TimeoutError, ValueError) as error:
        raise BatchError(
            f"--scheduler {address}: nobody answers there ({error or type(error).__name__}); start one with `dask "
            "scheduler`, and write its address, such as tcp://host:8786"
        ) from error


def _each(work: Callable[[J], R], jobs: list[J]) -> list[R]:
    return [work(job) for job in jobs]

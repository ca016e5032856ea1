"""Workers: processes of this machine, or of all machines of a cluster. The one file that knows Dask."""
# Dask has no types.
# pyright: reportUnknownVariableType=false, reportUnknownMemberType=false, reportUnknownArgumentType=false

import faulthandler
import logging
import os
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from importlib import metadata
from itertools import islice
from pathlib import Path
from typing import Any, Generic, Self, TypeVar

from tangible_core.errors import BatchError

from .extra import need

J = TypeVar("J")
R = TypeVar("R")
LIMITS = ("TANGIBLE_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
"""Environment variables that limit the threads of a worker's libraries, before it imports them."""
AHEAD = 4
"""Jobs with the scheduler for each worker: enough that none waits; no more, so that nothing grows with their number."""
FRESH_AFTER = 2000
"""Jobs of a worker, about, after which it begins anew: Dask keeps some 10 kB of each for itself."""
CONNECT_S = 10
LONGEST_S = 3600.0
"""A job that takes longer is ended, where nothing else is said."""
DISTRIBUTION = "tangible-images"
LOUD = ("distributed", "tornado", "bokeh")
"""Loggers."""


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

    def __init__(self, workers: int, threads: int = 1, scheduler: str = "") -> None:
        """workers: processes of this machine, whose libraries have so many threads each; both for no scheduler alone.

        Raises: BatchError without the extra, if nobody answers at the address, or workers have another version.
        """
        self._threads, self._scheduler = threads, scheduler
        self._leaving = ExitStack()
        self._begin(workers)

    def _begin(self, workers: int) -> None:
        distributed = need("distributed")  # puts its own settings there, so that ours hold
        self._worked = 0
        with ExitStack() as failing:
            failing.callback(self.close)
            self._leaving.enter_context(need("dask").config.set(SETTINGS))
            self._leaving.enter_context(_quiet())
            if self._scheduler:
                self._client: Any = _client(distributed, self._scheduler)
            else:
                cluster = _cluster(distributed, workers, self._threads)
                self._leaving.callback(cluster.close, timeout=10)
                self._client = distributed.Client(cluster)
            self._leaving.callback(_close_client, self._client)
            self._as_completed = distributed.as_completed
            self.workers = self._checked(self._scheduler)
            failing.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the workers that this one started."""
        self._leaving.close()

    def map(
        self, work: Callable[[J], R], jobs: Iterable[J], chunk: int = 1, timeout_s: float = LONGEST_S
    ) -> Iterator[Done[J, R]]:
        """work(job) for each, as they are done, on any worker; a result comes once.

        chunk: jobs that are sent together: less to do for the scheduler where each is short. A job whose worker dies is
        tried again by itself, when those beside it are done: so it alone fails, and none that was beside it. A worker
        whose job takes longer than timeout_s dies of it, whatever it is held up by. Workers of this machine begin anew
        after some thousand jobs each.
        """
        work = partial(_in_time, work, timeout_s)
        todo = iter(jobs)
        while part := list(islice(todo, FRESH_AFTER * self.workers)):
            if not self._scheduler and self._worked >= FRESH_AFTER * self.workers:
                self.close()
                self._begin(self.workers)  # `restart_workers` may lose one for ever that is just coming back
            self._worked += len(part)
            yield from self._mapped(work, part, chunk, timeout_s)

    def _mapped(self, work: Callable[[J], R], jobs: Iterable[J], chunk: int, timeout_s: float) -> Iterator[Done[J, R]]:
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
            results = _result(future)
            if (more := send()) is not None:
                flow.add(more)
            if results is None:
                suspects += part
            else:
                yield from (Done(job, result) for job, result in zip(part, results, strict=True))
        for job in suspects:
            yield self._alone(work, job, timeout_s)

    def _alone(self, work: Callable[[J], R], job: J, timeout_s: float) -> Done[J, R]:
        begun_s = time.monotonic()
        future = self._client.submit(_each, work, [job], pure=False)
        try:
            return Done(job, future.result()[0])
        except Exception as error:  # noqa: BLE001 - of Dask, which says in many ways that a worker is gone
            over = time.monotonic() - begun_s >= timeout_s
            return Done(job, None, f"took longer than {timeout_s:g} s, twice, and was ended" if over else _death(error))
        finally:
            future.release()

    def _checked(self, scheduler: str) -> int:
        """How many workers there are. Raises: BatchError if there is none, or one that cannot do the work."""
        workers = self._client.scheduler_info(n_workers=-1)["workers"]
        if not workers:
            raise BatchError(f"{scheduler}: has no workers; start some: dask worker {scheduler} --nthreads 1")
        for address, each in workers.items():
            if each["nthreads"] != 1:
                raise BatchError(
                    f"the worker {address} works on {each['nthreads']} scenes at once in one process; start it with "
                    "--nthreads 1, and several with --nworkers"
                )
        theirs = self._client.run(metadata.version, DISTRIBUTION, on_error="return")
        for address, version in theirs.items():
            if version != installed():
                what = f"has {DISTRIBUTION} {version}" if isinstance(version, str) else f"has no {DISTRIBUTION}"
                raise BatchError(
                    f"the worker {address} {what}, and this is {installed()}; install the same on all machines"
                )
        return len(workers)


def _result(future: Any) -> Any:
    """What became of it; None where its worker died, or the one that kept the result did."""
    try:
        return future.result()
    except Exception:  # noqa: BLE001 - of Dask, which says in many ways that a worker is gone
        return None
    finally:
        future.release()


def _death(error: Exception) -> str:
    if type(error).__name__ == "KilledWorker":
        return "its worker died of it, twice; it may need more memory than there is, or crash in a library"
    return f"{type(error).__name__}: {error}"


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


@contextmanager
def _quiet() -> Generator[None]:
    """That workers come and go is no news here."""
    loggers = [logging.getLogger(name) for name in LOUD]
    levels = [each.level for each in loggers]
    for each in loggers:
        each.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for each, level in zip(loggers, levels, strict=True):
            each.setLevel(level)


def _cluster(distributed: Any, workers: int, threads: int) -> Any:
    with _environment({name: str(threads) for name in LIMITS}):  # the workers inherit it
        return distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",  # with None, a port is open to everybody
            memory_limit=0,
            silence_logs=logging.CRITICAL,
            preload=[f"{__package__}.dask_preload"],
        )


@contextmanager
def _environment(values: Mapping[str, str]) -> Generator[None]:
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _close_client(client: Any) -> None:
    with suppress(Exception):
        client.close(timeout=5)


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


def _in_time(work: Callable[[J], R], timeout_s: float, job: J) -> R:
    """In a worker, which does one job at a time: it ends with a job that takes longer, even one that holds Python."""
    with Path(os.devnull).open("w") as nobody:
        faulthandler.dump_traceback_later(timeout_s, exit=True, file=nobody)
        try:
            return work(job)
        finally:
            faulthandler.cancel_dump_traceback_later()

"""Workers: processes of this machine, or of all machines of a cluster. No other file knows Dask."""

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
# Environment variables that limit the threads of a worker's libraries; set before the worker imports them.
LIMITS = ("TANGIBLE_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
# The number of jobs with the scheduler for each worker: enough that none waits, and memory does not grow with jobs.
AHEAD = 4
# The number of jobs, about, after which a worker is restarted: Dask keeps some 10 kB of each job.
FRESH_AFTER = 2000
CONNECT_S = 10  # the time limit for a connection to a scheduler, seconds
LONGEST_S = 3600.0  # the default time limit of a job, seconds
DISTRIBUTION = "tangible-images"
NOISY_LOGGERS = ("distributed", "tornado", "bokeh")


@dataclass(frozen=True)
class Done(Generic[J, R]):
    """A finished job with its result."""

    job: J
    result: R | None  # the result; None if its worker died of it
    death: str = ""  # the reason of the worker's death; empty if it did not die


class Farm:
    """A cluster on this machine, or the scheduler at an address. It ends with `close`, or at the end of its block."""

    def __init__(self, workers: int, threads: int = 1, scheduler: str = "") -> None:
        """Start workers, with this number of threads each, or connect to a scheduler. Raises: BatchError."""
        self._threads, self._scheduler = threads, scheduler
        self._leaving = ExitStack()
        self._start(workers)

    def _start(self, workers: int) -> None:
        distributed = need("distributed")  # its import sets its own settings, so that ours come after them
        self._done_count = 0
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
            self.workers = self._check_workers(self._scheduler)
            failing.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the workers that this farm started."""
        self._leaving.close()

    def map(
        self, work: Callable[[J], R], jobs: Iterable[J], chunk: int = 1, timeout_s: float = LONGEST_S
    ) -> Iterator[Done[J, R]]:
        """Yield work(job) for each job, on any worker, in the order in which they finish; each result comes once."""
        work = partial(_run_in_time, work, timeout_s)
        todo = iter(jobs)
        while part := list(islice(todo, FRESH_AFTER * self.workers)):
            if not self._scheduler and self._done_count >= FRESH_AFTER * self.workers:
                self.close()
                self._start(self.workers)  # Dask's `restart_workers` may lose a worker that is just restarting
            self._done_count += len(part)
            yield from self._map_part(work, part, chunk, timeout_s)

    def _map_part(
        self, work: Callable[[J], R], jobs: Iterable[J], chunk: int, timeout_s: float
    ) -> Iterator[Done[J, R]]:
        todo = iter(jobs)
        waiting: dict[str, list[J]] = {}

        def send() -> Any:
            if part := list(islice(todo, chunk)):
                future = self._client.submit(_run_all, work, part, pure=False)
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
            yield self._run_alone(work, job, timeout_s)

    def _run_alone(self, work: Callable[[J], R], job: J, timeout_s: float) -> Done[J, R]:
        start_s = time.monotonic()
        future = self._client.submit(_run_all, work, [job], pure=False)
        try:
            return Done(job, future.result()[0])
        except Exception as error:  # noqa: BLE001 - Dask raises many errors for a lost worker
            over = time.monotonic() - start_s >= timeout_s
            return Done(job, None, f"took longer than {timeout_s:g} s, twice, and was ended" if over else _death(error))
        finally:
            future.release()

    def _check_workers(self, scheduler: str) -> int:
        """Return the number of workers. Raises: BatchError if there is none, or one that cannot do the work."""
        workers = self._client.scheduler_info(n_workers=-1)["workers"]
        if not workers:
            raise BatchError(f"{scheduler}: has no workers; start some: dask worker {scheduler} --nthreads 1")
        for address, worker in workers.items():
            if worker["nthreads"] != 1:
                raise BatchError(
                    f"the worker {address} works on {worker['nthreads']} scenes at once in one process; start it with "
                    "--nthreads 1, and several with --nworkers"
                )
        theirs = self._client.run(metadata.version, DISTRIBUTION, on_error="return")
        for address, version in theirs.items():
            if version != installed_version():
                what = f"has {DISTRIBUTION} {version}" if isinstance(version, str) else f"has no {DISTRIBUTION}"
                raise BatchError(
                    f"the worker {address} {what}, and this is {installed_version()}; install the same on all machines"
                )
        return len(workers)


def _result(future: Any) -> Any:
    """Return the result; None if its worker died, or the worker that kept the result."""
    try:
        return future.result()
    except Exception:  # noqa: BLE001 - Dask raises many errors for a lost worker
        return None
    finally:
        future.release()


def _death(error: Exception) -> str:
    if type(error).__name__ == "KilledWorker":
        return "its worker died of it, twice; it may need more memory than there is, or crash in a library"
    return f"{type(error).__name__}: {error}"


def installed_version() -> str:
    """Return the installed version of this program."""
    return metadata.version(DISTRIBUTION)


SETTINGS = {
    "distributed.scheduler.allowed-failures": 0,  # a job that killed a worker is tried again alone, not on the next one
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.worker.daemon": False,  # a pipeline has processes of its own
    "distributed.comm.timeouts.connect": f"{CONNECT_S}s",
    "distributed.admin.tick.limit": "60s",
}


@contextmanager
def _quiet() -> Generator[None]:
    """Silence the loggers that report when workers come and go."""
    loggers = [logging.getLogger(name) for name in NOISY_LOGGERS]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _cluster(distributed: Any, workers: int, threads: int) -> Any:
    with _environment({name: str(threads) for name in LIMITS}):  # the workers inherit it
        try:
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
        except (RuntimeError, OSError) as error:
            raise BatchError(
                f"a worker process cannot be started ({error}): it was ended, or the system allows no more; start the "
                "same command again, with fewer --workers if need be"
            ) from error


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
            f"--scheduler {address}: nothing answers there ({error or type(error).__name__}); start one with `dask "
            "scheduler`, and write its address, such as tcp://host:8786"
        ) from error


def _run_all(work: Callable[[J], R], jobs: list[J]) -> list[R]:
    return [work(job) for job in jobs]


def _run_in_time(work: Callable[[J], R], timeout_s: float, job: J) -> R:
    """Do a job in a worker; end the worker if the job takes longer, even if the job never gives Python back."""
    with Path(os.devnull).open("w") as devnull:
        faulthandler.dump_traceback_later(timeout_s, exit=True, file=devnull)
        try:
            return work(job)
        finally:
            faulthandler.cancel_dump_traceback_later()

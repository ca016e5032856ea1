"""A farm of the process that asks, which needs Dask imported and starts nothing."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from tangible_batch.farm import Done


class Here:
    """A farm without processes: for what does not depend on them."""

    def __init__(self, *_: object) -> None:
        self.workers = 1

    def __enter__(self) -> "Here":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def map(
        self, work: Callable[[Any], Any], jobs: Iterable[Any], chunk: int = 1, timeout_s: float = 1.0
    ) -> Iterator[Done[Any, Any]]:
        for job in jobs:
            yield Done(job, work(job))

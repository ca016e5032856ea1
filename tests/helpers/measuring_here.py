"""Cells of a comparison, measured in this process: the rows and their choice are those of a process each."""

from types import SimpleNamespace
from typing import Any

import pytest

from tangible_bench.measuring import run, worker
from tangible_bench.measuring.plan import Measurement
from tangible_core.runtime.child_process import Place

DEADLY = "dies"
"""The fake method that takes its process along: a process is started for each of its cells."""


def measure_here(patch: pytest.MonkeyPatch) -> None:
    """Measure in this process from now on, with the installed methods."""
    start_worker = run._outcome

    def outcome(wanted: Measurement, timeout_s: float) -> dict[str, Any]:
        if wanted.job.use == DEADLY:
            return start_worker(wanted, timeout_s)
        return worker.answer(Place(*wanted.place), wanted.job)

    patch.setattr(worker, "gc", SimpleNamespace(collect=lambda: None, freeze=lambda: None))
    patch.setattr(run, "_outcome", outcome)

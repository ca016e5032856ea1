"""The machine and the memory of measurements."""

import numpy as np
import pytest

from tangible_bench.measuring.machine import machine
from tangible_bench.memory import held_bytes, start_peak


def test_machine_has_cores_and_a_processor():
    assert machine()["cores"] >= 1
    assert machine()["processor"]


def test_peak_memory_counts_from_its_start():
    np.ones(40_000_000, np.uint8)
    peak = start_peak()
    np.ones(20_000_000, np.uint8)
    assert peak() == pytest.approx(20_000_000, rel=0.1)


def test_held_bytes_are_those_of_the_result():
    assert held_bytes(lambda: np.ones(10_000)) == pytest.approx(80_000, rel=0.01)
    assert held_bytes(lambda: np.ones(10_000).sum()) < 1000

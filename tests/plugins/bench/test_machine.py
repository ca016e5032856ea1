"""What a measurement depends on beside its options and code: machine, memory."""

import numpy as np
import pytest

from tangible_bench.measuring.machine import machine
from tangible_bench.memory import held_bytes, start_peak


def test_the_machine_has_cores_and_a_name():
    assert machine()["cores"] >= 1
    assert machine()["processor"]


def test_a_peak_is_seen_after_it_has_passed_and_an_earlier_one_is_not():
    np.ones(40_000_000, np.uint8)
    peak = start_peak()
    np.ones(20_000_000, np.uint8)
    assert peak() == pytest.approx(20_000_000, rel=0.1)


@pytest.mark.slow
def test_bytes_that_are_held():
    assert held_bytes(lambda: np.ones(10_000)) == pytest.approx(80_000, rel=0.01)
    assert held_bytes(lambda: np.ones(10_000).sum()) < 1000

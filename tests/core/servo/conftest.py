"""A small ring for the tests of rings and of reports."""

from collections.abc import Iterator

import pytest

from tangible_core.servo import Ring


@pytest.fixture
def small() -> Iterator[Ring]:
    ring = Ring.create(16)
    yield ring
    ring.remove()

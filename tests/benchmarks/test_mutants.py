"""A list of faults that no longer fits the code measures nothing: whether safety is still tested would not be known."""

from pathlib import Path

from benchmarks.mutants_lists import mutants


def test_lists_fit_the_code_as_it_is():
    assert mutants(Path(__file__).parents[2])

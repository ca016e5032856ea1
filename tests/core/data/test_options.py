"""Descriptions of options: those that pydantic finds in the sources, found when somebody asks."""

import subprocess
import sys

from pydantic import ConfigDict, Field

from tangible_core.data.options import field_texts
from tangible_core.data.quantities import Quantities


def heir_of(base: type[Quantities]) -> type[Quantities]:
    class Parent(base):
        kept: int = 1
        """Stays
            as it is."""
        changed: int = 2
        """Of the base."""

    class Heir(Parent):
        bare: int = 3
        changed: int = 4
        """Of the heir,
no further in than the class."""
        told: int = Field(default=6, description="By the field.")
        """By the docstring."""

    return Heir


def test_schema_has_the_descriptions_that_pydantic_finds():
    eager = type("Eager", (Quantities,), {"model_config": ConfigDict(use_attribute_docstrings=True)})
    ours, theirs = (heir_of(base).model_json_schema()["properties"] for base in (Quantities, eager))
    assert ours == theirs
    assert ours["changed"]["description"] == "Of the heir,\nno further in than the class."
    assert field_texts(eager) == {}, "there is no source"


def test_start_reads_no_source_of_ours():
    code = "import linecache, tangible_core as core; core.load_pipeline('configs/demo.yaml'); print(*linecache.cache)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "tangible_" not in done.stdout

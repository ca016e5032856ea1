"""If one of these fails, a damaged file ends the program, hangs, fills the memory or leaves a traceback."""

import os
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from file_readers import READERS
from forks import Forks

FILES = int(os.environ.get("TANGIBLE_MUTATED_FILES", "0"))
"""Number of files of each reader, if not the usual one."""
PER_DAY, PER_NIGHT = 40, 5000

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a file is read in a fork of a process")


@pytest.fixture(scope="module")
def forks() -> Iterator[Forks]:
    """A process without threads, as a fork has none: a lock that another thread held would never be given back."""
    with closing(Forks([sys.executable, "-c", "import file_readers\n"])) as forks:
        yield forks


@pytest.mark.parametrize(
    "files", [PER_DAY, pytest.param(PER_NIGHT, marks=[pytest.mark.nightly, pytest.mark.timeout(3600)])]
)
@pytest.mark.parametrize("name", READERS)
def test_file_is_read_and_damaged_ones_are_read_or_refused_as_a_mistake_of_the_user(
    forks: Forks, name: str, files: int, tmp_path: Path, own_dir: Path
):
    homes = {key: value for key, value in os.environ.items() if value.startswith(str(own_dir))}
    run = forks.run(
        f"import os; os.environ.update({homes!r}); import file_readers; "
        f"file_readers.report({name!r}, {str(tmp_path)!r}, {FILES or files})"
    )
    assert not run.returncode, run.stderr
    assert not run.stdout, run.stdout

"""Files damaged by chance: each is read, or refused as a mistake of the user; none ends the process, hangs or fills it.

The damage is the same in each run, by the reader's name and the file's number. At night there are a hundred times as
many files. Some of one reader, printed by kind:

    python tests/helpers/file_readers.py FIRST LAST READER
"""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

import mutated
from file_readers import READERS
from forks import Forks
from mutated import Damage, Reader
from tangible_core.errors import ConfigError

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


def test_damage_is_the_same_again_and_unlike_the_file_before(tmp_path: Path):
    (tmp_path / "a").mkdir(), (tmp_path / "b").mkdir()
    one, other = (Damage("pfm", READERS["pfm"], tmp_path / name) for name in "ab")
    files = [one.file(number)[1] for number in range(100)]
    assert files == [other.file(number)[1] for number in range(100)]
    assert len(set(files)) > 90
    assert sum(data in one.valid.values() for data in files) < 10


def test_reader_that_fails_dies_hangs_or_fills_the_memory_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def read(path: Path) -> None:
        number = path.stat().st_mtime_ns // 1_000_000
        if number == 1:
            raise ValueError("a fault")
        if number == 2:
            os.kill(os.getpid(), signal.SIGSEGV)
        if number == 3:
            raise ConfigError("a mistake")
        if number == 4:
            raise ConfigError("")
        if number == 5:
            bytearray(2 * mutated.MEMORY)
        while number == 6:
            pass

    monkeypatch.setattr(mutated, "CPU_S", 0.2)
    (tmp_path / "files").mkdir()
    reader = Reader(lambda folder: (folder / "a").write_bytes(b"12 34"), read, text=True)
    findings = {
        finding.number: finding.what for finding in Damage("faulty", reader, tmp_path / "files").findings(range(9))
    }
    assert sorted(findings) == [1, 2, 4, 5, 6]
    assert findings[1].startswith("ValueError: 'a fault' at test_mutated_files.py")
    assert findings[2] == "ends the process: SIGSEGV"
    assert findings[4] == "says nothing"
    assert findings[5].startswith("MemoryError")
    assert findings[6] == "ends the process: more than 0.2 s"

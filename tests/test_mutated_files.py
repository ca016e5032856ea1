"""Files damaged by chance: each is read, or refused as a mistake of the user; none ends the process, hangs or fills it.

The damage is the same in each run, by the reader's name and the file's number. At night there are a hundred times as
many files. Some of one reader, printed by kind:

    python tests/helpers/file_readers.py FIRST LAST READER
"""

import os
import signal
import sys
from pathlib import Path

import pytest

import mutated
from file_readers import READERS
from mutated import Damage, Reader
from tangible_core.errors import ConfigError

FILES = int(os.environ.get("TANGIBLE_MUTATED_FILES", "0"))
"""Number of files of each reader, if not the usual one."""
PER_DAY, PER_NIGHT = 40, 5000

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="a file is read in a fork of the test's process"),
    pytest.mark.timeout(3600),
]


@pytest.fixture
def damage(request: pytest.FixtureRequest, tmp_path: Path, own_dir: Path) -> Damage:
    (tmp_path / "files").mkdir()
    return Damage(request.param, READERS[request.param], tmp_path / "files")


@pytest.mark.parametrize("damage", READERS, indirect=True)
def test_valid_files_are_read(damage: Damage):
    assert damage.valid
    for path in damage.valid:
        damage.reader.read(path)


@pytest.mark.parametrize("damage", READERS, indirect=True)
@pytest.mark.parametrize("files", [PER_DAY, pytest.param(PER_NIGHT, marks=pytest.mark.nightly)])
def test_damaged_file_is_read_or_refused_as_a_mistake_of_the_user(damage: Damage, files: int):
    findings = list(damage.findings(range(FILES or files)))
    assert not findings, "\n".join(f"{damage.name} {each.number}: {each.what} {each.data}" for each in findings[:10])


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

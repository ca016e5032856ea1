"""The cache on disk. Otherwise an old or damaged result would be felt, or the disk would fill."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from hostile import npz_bomb
from tangible_core.data import (
    Calibration,
    DisparityMap,
    HapticSurface,
    Material,
    MaterialMap,
    Note,
    Record,
    Relief,
    SegmentMap,
    Views,
)
from tangible_core.pipeline.engine.cache import Cache, read_entry, write_record

ICE = Material("ice", 900.0, 1.0, 0.1, 0.03, source="a test")
HEIGHTS = np.linspace(0, 0.01, 12, dtype=np.float32).reshape(3, 4)
LABELS = np.zeros((3, 4), np.int32)

RECORDS: list[Record] = [
    Views(np.arange(12, dtype=np.uint16).reshape(3, 4), None, Calibration(900.0, 0.2, 31.0)),
    DisparityMap(np.where(HEIGHTS > 0.005, HEIGHTS, np.float32(np.nan))),
    SegmentMap(LABELS),
    MaterialMap((ICE,), ("because",)),
    HapticSurface(Relief(HEIGHTS, (0.08, 0.06)), LABELS, (ICE,)),
    HapticSurface(Relief(HEIGHTS, (0.08, 0.06))),
]


@pytest.mark.parametrize("record", RECORDS, ids=lambda each: type(each).__name__)
def test_record_is_read_as_it_was_written(tmp_path: Path, record: Record):
    write_record(tmp_path / "x.npz", record)
    again = read_entry(tmp_path / "x.npz").record
    assert type(again) is type(record)
    assert again.digest() == record.digest()


NOTES = {"disparity": (Note("views exchanged", "warning"), Note("at 1/2")), "relief": (Note("noise", "doubt"),)}


def test_notes_are_read_with_the_record(tmp_path: Path):
    kept = Cache(tmp_path)
    kept.put("k", RECORDS[1], NOTES)
    assert kept.entry("k") is not None and kept.entry("k").notes == kept.notes("k") == NOTES
    kept.put("k", RECORDS[1])
    assert kept.entry("k").notes == kept.notes("k") == kept.notes("nothing") == {}


@pytest.mark.parametrize("tree", [["x"], {"relief": [["x", "shout"]]}, {"relief": [[1, "doubt"]]}, {"relief": ["x"]}])
def test_entry_with_invalid_notes_is_damaged(
    unchecked_shapes: None, tmp_path: Path, tree: object, caplog: pytest.LogCaptureFixture
):
    record = {"class": "SegmentMap", "fields": {"labels": {"array": "a"}}}
    for key, notes in (("good", {"relief": [["x", "doubt"]]}), ("k", tree)):
        packed = np.frombuffer(json.dumps(notes).encode(), np.uint8)
        entry(tmp_path / f"{key}.npz", record, notes=packed, a=np.zeros((2, 2), np.int32))
    assert Cache(tmp_path).notes("good") == {"relief": (Note("x", "doubt"),)}
    assert Cache(tmp_path).notes("k") == {}
    assert Cache(tmp_path).entry("k") is None
    assert "damaged" in caplog.text


def test_folder_is_that_of_the_environment_variable(cache_dir: Path):
    Cache().put("k", RECORDS[1])
    assert [path.name for path in cache_dir.glob("*.npz")] == ["k.npz"]


def flip_a_bit(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


DAMAGE: list[Callable[[Path], object]] = [
    flip_a_bit,
    lambda path: path.write_bytes(path.read_bytes()[:100]),
    lambda path: path.write_bytes(b""),
    lambda path: path.write_bytes(b"PK" + bytes(400)),
    lambda path: (path.unlink(), path.mkdir()),
    lambda path: (path.unlink(), os.mkfifo(path)),
    lambda path: npz_bomb(path, record=(20_000, 20_000)),
    lambda path: path.unlink(),
]


@pytest.mark.timeout(20)
@pytest.mark.parametrize("damage", DAMAGE)
def test_damaged_entry_is_made_again(tmp_path: Path, damage: Callable[[Path], object]):
    kept = Cache(tmp_path)
    kept.put("k", SegmentMap(np.zeros((64, 64), np.int32)))
    damage(tmp_path / "k.npz")
    assert kept.entry("k") is None
    assert "k" not in kept
    kept.put("k", RECORDS[1])
    assert kept.entry("k") is not None


def entry(path: Path, tree: object, **arrays: np.ndarray) -> None:
    text = tree if isinstance(tree, str) else json.dumps(tree)
    np.savez(path, record=np.frombuffer(text.encode(), np.uint8), **arrays)


ODD = {
    "a path": {"class": "Path", "fields": {}},
    "lists in lists": "[" * 100_000 + "]" * 100_000,
    "a number of 5000 digits": "9" * 5000,
    "no record": 7,
    "a tuple": {"tuple": []},
    "another class": {"class": "Record", "fields": {}},
    "a class that is a list": {"class": [], "fields": {}},
    "a tuple of the servo": {"class": "Force", "fields": {"x": 1.0, "y": 1.0, "z": 1.0}},
    "a missing array": {"class": "DisparityMap", "fields": {"disparity_px": {"array": "x"}}},
    "an unknown field": {"class": "SegmentMap", "fields": {"labels": {"array": "a"}, "more": 1}},
    "a picture that is none": {"class": "Views", "fields": {"left": {"array": "b"}}},
    "fields that are none": {"class": "Views", "fields": [1]},
    "a part that nobody knows": {"class": "Views", "fields": {"left": {"array": "a"}, "calibration": {"camera": 1}}},
}


@pytest.mark.usefixtures("unchecked_shapes")
@pytest.mark.parametrize("tree", ODD.values(), ids=ODD)
def test_entry_of_any_content_is_made_again(tmp_path: Path, tree: object, caplog: pytest.LogCaptureFixture):
    entry(tmp_path / "k.npz", tree, a=np.zeros((2, 2), np.uint8), b=np.full((2, 2), np.nan))
    assert Cache(tmp_path).entry("k") is None
    assert "damaged" in caplog.text
    assert len(caplog.text) < 1000
    assert not (tmp_path / "k.npz").exists()


def test_pruning_of_many_entries_keeps_those_used_last(tmp_path: Path):
    cache = Cache(tmp_path)
    names = {age: f"{age * 5 % 12:x}{age}" for age in (7, 2, 9, 4, 0, 11, 5, 1, 10, 3, 8, 6)}
    for age, name in names.items():
        cache.put(name, RECORDS[1])
        os.utime(tmp_path / f"{name}.npz", (1e9 - age, 1e9 - age))
    assert cache.entry(names[11]) is not None, "used now, so it stays"
    size = next(tmp_path.glob("*.npz")).stat().st_size
    Cache(tmp_path, max_bytes=13 * size).put("new", RECORDS[1])
    assert len(list(tmp_path.glob("*.npz"))) == 13, "just full"
    Cache(tmp_path, max_bytes=7 * size).put("newer", RECORDS[1])
    left = {path.stem for path in tmp_path.glob("*.npz")}
    assert left == {"newer", "new", names[11], *(names[age] for age in range(len(left) - 3))}
    assert 5 <= len(left) <= 7


@pytest.mark.parametrize("place", ["file", "file/below", "loop"])
def test_unwritable_folder_gives_one_warning(tmp_path: Path, place: str, caplog: pytest.LogCaptureFixture):
    (tmp_path / "file").write_text("")
    (tmp_path / "loop").symlink_to("loop")
    for key in "abc":
        kept = Cache(tmp_path / place)
        assert key not in kept
        assert kept.entry(key) is None
        kept.put(key, RECORDS[1])
    [message] = caplog.messages
    assert message.startswith(f"results are not cached: {tmp_path / place}/a.npz: cannot be written: ")
    assert message.endswith("TANGIBLE_CACHE_DIR names another cache")
    assert (tmp_path / "file").read_text() == ""


def test_full_disk_leaves_no_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog):
    def full(*_: object, **__: object):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np.lib.format, "write_array", full)
    Cache(tmp_path).put("k", RECORDS[1])
    assert "No space left" in caplog.text
    assert list(tmp_path.iterdir()) == []


WRITER = """
import sys
from pathlib import Path
import numpy as np
from tangible_core.data import SegmentMap
from tangible_core.pipeline.engine import cache

def write_halfway(file, arrays):
    file.write(bytes(100_000))
    file.flush()
    print("halfway", flush=True)
    sys.stdin.readline()
    real(file, arrays)

real, cache.write_arrays = cache.write_arrays, write_halfway
cache.Cache(Path(sys.argv[1])).put("ab" * 32, SegmentMap(np.zeros((20, 20), np.int32)))
"""


@contextmanager
def halfway(folder: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that has written half an entry whose key is as long as those of products."""
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", WRITER, folder], stdin=pipe, stdout=pipe, text=True) as writer:
        assert writer.stdout and writer.stdout.readline() == "halfway\n"
        yield writer


class TestKilledWriter:
    def test_unfinished_file_is_counted_and_deleted_by_pruning_after_a_minute_or_by_clearing(self, tmp_path: Path):
        for number in range(2):
            with halfway(tmp_path) as writer:
                writer.kill()
            assert Cache(tmp_path).size() == (number + 1, 100_000 * (number + 1))
        old, young = (path for path in tmp_path.iterdir() if path.stat().st_size == 100_000)
        Cache(tmp_path, max_bytes=0).put("cd" * 32, RECORDS[1])
        assert old.exists()
        os.utime(old, (1e9, 1e9))
        Cache(tmp_path, max_bytes=0).put("cd" * 32, RECORDS[1])
        assert {path.name for path in tmp_path.iterdir()} == {".tally", young.name}
        assert Cache(tmp_path).clear() == (1, 100_000)
        assert not young.exists()

    def test_file_of_a_living_process_stays_and_becomes_an_entry(self, tmp_path: Path):
        with halfway(tmp_path) as writer:
            (part,) = tmp_path.iterdir()
            os.utime(part, (1e9, 1e9))
            Cache(tmp_path, max_bytes=0).put("cd" * 32, RECORDS[1])
            assert Cache(tmp_path).clear() == (0, 0)
            assert list(tmp_path.iterdir()) == [part]
            assert Cache(tmp_path).size() == (1, 100_000)
            writer.communicate("go on\n")
        assert writer.returncode == 0
        assert "ab" * 32 in Cache(tmp_path) and not part.exists()


def size_of(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.glob("*.npz"))


@pytest.mark.parametrize(
    "tally", [None, b"", b"torn", b"\xff" * 8, bytes(8 * (1 << 17))], ids=["none", "empty", "torn", "negative", "long"]
)
def test_folder_with_a_damaged_tally_is_counted(tmp_path: Path, tally: bytes | None):
    kept = Cache(tmp_path)
    for number in range(4):
        kept.put(f"k{number}", RECORDS[1])
        os.utime(tmp_path / f"k{number}.npz", (1e9 + number, 1e9 + number))
    size = (tmp_path / "k0.npz").stat().st_size
    (tmp_path / ".tally").unlink()
    if tally is not None:
        (tmp_path / ".tally").write_bytes(tally)
    Cache(tmp_path, max_bytes=3 * size).put("new", RECORDS[1])
    assert {path.stem for path in tmp_path.glob("*.npz")} == {"k3", "new"}
    assert size_of(tmp_path) == int.from_bytes((tmp_path / ".tally").read_bytes(), "little")


USER = """
import sys
from pathlib import Path
import numpy as np
from tangible_core.pipeline.engine import cache
from tangible_core.pipeline.engine.cache import Cache
from tangible_core.data import SegmentMap

cache, record = Cache(Path(sys.argv[1]), max_bytes=int(sys.argv[3])), SegmentMap(np.zeros((20, 20), np.int32))
for i in range(60):
    key = f"k{(int(sys.argv[2]) + i) % 10}"
    cache.put(key, record)
    found = cache.entry(key)
    assert found is None or found.record.digest() == record.digest()
"""


@pytest.mark.parametrize(
    "max_bytes",
    [pytest.param(20_000, id="always full"), pytest.param(10_000_000, id="roomy", marks=pytest.mark.whole)],
)
def test_folder_is_shared_by_four_processes(tmp_path: Path, max_bytes: int):
    users = [
        subprocess.Popen(
            [sys.executable, "-c", USER, tmp_path, start, str(max_bytes)], stderr=subprocess.PIPE, text=True
        )
        for start in "0257"
    ]
    said = [user.communicate(timeout=60)[1] for user in users]
    assert said == [""] * 4
    assert [user.returncode for user in users] == [0] * 4
    assert [path.name for path in tmp_path.iterdir() if path.suffix != ".npz"] == [".tally"]
    assert size_of(tmp_path) <= max_bytes + 4 * 2_000  # what each may have written while another one counted
    assert (tmp_path / ".tally").stat().st_size % 8 == 0

"""The file of a ring: its layout, who can open it, and its deletion."""

import os
from pathlib import Path

import numpy as np
import pytest

from ring_ticks import put
from tangible_core.data import TICK_COLUMNS
from tangible_core.errors import DeviceError
from tangible_core.runtime.system import shared_memory
from tangible_core.servo import Ring, parcel, ring
from tangible_core.servo.ring import COUNT, IS_LAYOUT, IS_MAGIC, SLOTS, shared_folder


class TestFile:
    def test_attached_ring_has_the_same_contents(self, small: Ring) -> None:
        put(small, 0, 1)
        other = Ring.attach(small.path)
        assert other.header[COUNT] == 2
        assert other.header[SLOTS] == 16
        np.testing.assert_array_equal(other.since(0)[0], small.since(0)[0])

    def test_sections_are_at_the_documented_offsets(self, small: Ring) -> None:
        """By the documented layout alone, as a reader in another language finds them."""
        put(small, 0, 7)
        data = small.path.read_bytes()
        at = 8 * (64 + 64 + 128 + 4096 + 4096 + 32768)
        assert np.frombuffer(data, np.int64, 2, at).tolist() == [0, 1]
        ticks = np.frombuffer(data, np.float64, 16 * len(TICK_COLUMNS), at + 16 * 8).reshape(16, -1)
        assert ticks[1, 0] == 7

    @pytest.mark.parametrize("content", [b"", b"x" * 100, bytes(100_000)])
    def test_file_that_is_not_a_ring_is_refused(self, tmp_path: Path, content: bytes) -> None:
        (tmp_path / "x.ring").write_bytes(content)
        with pytest.raises(DeviceError, match=r"x\.ring"):
            Ring.attach(tmp_path / "x.ring")

    @pytest.mark.parametrize("word", [IS_MAGIC, IS_LAYOUT, SLOTS])
    def test_ring_of_another_layout_is_refused(self, small: Ring, word: int) -> None:
        small.header[word] += 1
        with pytest.raises(DeviceError, match="is not a ring of layout"):
            Ring.attach(small.path)
        small.header[word] -= 1
        Ring.attach(small.path)

    def test_sections_begin_at_multiples_of_64_bytes(self) -> None:
        odd = Ring.create(5)
        try:
            put(odd, *range(7))
            data = odd.path.read_bytes()
        finally:
            odd.remove()
        at = 8 * (64 + 64 + 128 + 4096 + 4096 + 32768)
        assert np.frombuffer(data, np.int64, 5, at).tolist() == [5, 6, 2, 3, 4]
        assert np.frombuffer(data, np.float64, 1, at + 64)[0] == 5
        assert len(data) % 64 == 0

    def test_missing_ring_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(DeviceError, match="no force loop runs there"):
            Ring.attach(tmp_path / "none.ring")

    @pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="this system does not allocate files")
    @pytest.mark.usefixtures("own_memory")
    def test_all_but_the_beacons_field_has_memory_from_the_start(self) -> None:
        """A process that writes to memory that the system cannot give any more is killed, with its force on."""
        made = Ring.create(8192)
        try:
            field, about = made.beacon.field.nbytes, made.path.stat()
            assert about.st_size - field <= 512 * about.st_blocks < about.st_size - field + 2**16
            made.allocate_beacon()
            assert 512 * made.path.stat().st_blocks >= about.st_size
        finally:
            made.remove()

    @pytest.mark.usefixtures("own_memory")
    def test_ring_without_room_leaves_no_file(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def full(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr("os.posix_fallocate", full, raising=False)
        with pytest.raises(DeviceError, match="no room for the loop's shared memory: No space left"):
            Ring.create(64)
        assert not list(shared_folder().iterdir())

    def test_ring_without_room_is_an_error(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        monkeypatch.setattr(shared_memory, "shared_folder", lambda: tmp_path / "missing")
        with pytest.raises(DeviceError, match="no room"):
            Ring.create()

    def test_shared_folder_can_be_configured(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        """So that two runs of tests at once do not delete each other's files."""
        monkeypatch.setenv("TANGIBLE_SHARED_DIR", str(tmp_path))
        made = Ring.create(16).path, parcel.pack([1])
        assert {path.parent for path in made} == {tmp_path}
        assert set(tmp_path.iterdir()) == set(made)

    def test_files_of_killed_processes_are_deleted(self) -> None:
        dead = shared_folder() / "tangible-999999999-x.ring"
        mine = shared_folder() / f"tangible-{os.getpid()}-x.ring"
        dead.touch()
        mine.touch()
        Ring.create(16).remove()
        try:
            assert not dead.exists()
            assert mine.exists()
        finally:
            mine.unlink()

    def test_files_of_others_and_odd_files_are_not_deleted(self, tmp_path: Path, monkeypatch) -> None:
        """Files of other names, a folder, a link, a file that cannot be deleted, and a file of another user."""
        monkeypatch.setattr(shared_memory, "shared_folder", lambda: tmp_path)
        odd = [
            "tangible-²-x.ring",
            "tangible-99999999999999999999-x.ring",
            "tangible-999999999-x.txt",
            "tangible--.ring",
        ]
        for name in odd:
            (tmp_path / name).touch()
        (tmp_path / "tangible-999999998-x.ring").mkdir()
        (tmp_path / "kept").touch()
        (tmp_path / "tangible-999999997-x.ring").symlink_to(tmp_path / "kept")
        (tmp_path / "tangible-999999996-x.parcel").touch()
        stays = {*odd, "tangible-999999998-x.ring", "tangible-999999997-x.ring", "kept"}
        Ring.create(16).remove()
        assert {path.name for path in tmp_path.iterdir()} == stays

        theirs = tmp_path / "tangible-999999995-x.ring"
        theirs.touch()
        with monkeypatch.context() as another:
            another.setattr(os, "getuid", lambda: 12345)
            Ring.create(16).remove()
        assert theirs.exists()

        (tmp_path / "tangible-999999994-x.ring").touch()
        unlink, tried = Path.unlink, []

        def first_refused(path: Path, missing_ok: bool = False) -> None:
            tried.append(path)
            if len(tried) == 1:
                raise PermissionError(1, "not permitted", str(path))
            unlink(path, missing_ok)

        with monkeypatch.context() as sticky:
            sticky.setattr(Path, "unlink", first_refused)
            made = Ring.create(16)
        assert len(tried) == 2
        assert [path.exists() for path in tried] == [True, False]
        made.remove()

    def test_documented_table_matches_the_layout(self) -> None:
        """Name, type and shape of each section, for readers in other languages."""
        types = {np.int64: "int64", np.float64: "float64", np.float32: "float32"}
        for name, (kind, shape) in ring._sections(12345).items():
            said = ", ".join(map(str, shape)).replace("12345", "n") + ("," if len(shape) == 1 else "")
            assert f"| {name} | {types[kind]} ({said}) |" in (ring.__doc__ or "")

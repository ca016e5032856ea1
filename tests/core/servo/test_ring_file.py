"""The file of a ring: another program cannot read it, or shared memory fills up with files of killed programs."""

import os
from pathlib import Path

import numpy as np
import pytest

from ring_ticks import put
from tangible_core.errors import DeviceError
from tangible_core.runtime.system import shared_memory
from tangible_core.servo import Ring, parcel
from tangible_core.servo.ring import COUNT, IS_LAYOUT, IS_MAGIC, SLOTS, shared_folder


class TestFile:
    def test_attached_ring_has_the_same_contents(self, small: Ring) -> None:
        put(small, 0, 1)
        other = Ring.attach(small.path)
        assert (other.header[COUNT], other.header[SLOTS]) == (2, 16)
        np.testing.assert_array_equal(other.since(0)[0], small.since(0)[0])

    @pytest.mark.parametrize("content", [b"", bytes(100_000)])
    def test_file_that_is_not_a_ring_is_refused(self, tmp_path: Path, content: bytes) -> None:
        (tmp_path / "x.ring").write_bytes(content)
        for name in ("x.ring", "none.ring"):
            with pytest.raises(DeviceError, match=name):
                Ring.attach(tmp_path / name)

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
        assert (np.frombuffer(data, np.float64, 1, at + 64)[0], len(data) % 64) == (5, 0)

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

    def test_shared_folder_can_be_configured(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        """So that two runs of tests at once do not delete each other's files."""
        monkeypatch.setenv("TANGIBLE_SHARED_DIR", str(tmp_path))
        made = Ring.create(16).path, parcel.pack([1])
        assert {path.parent for path in made} == {tmp_path}
        assert set(tmp_path.iterdir()) == set(made)

    def test_files_of_killed_processes_are_deleted_and_no_others(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(shared_memory, "shared_folder", lambda: tmp_path)
        stays = [f"tangible-{os.getpid()}-x.ring", "tangible-²-x.ring", "tangible-999999999-x.txt", "tangible--.ring"]
        for name in (*stays, "tangible-999999996-x.parcel", "tangible-999999999-x.ring"):
            (tmp_path / name).touch()
        (tmp_path / "tangible-999999998-x.ring").mkdir()
        (tmp_path / "tangible-999999997-x.ring").symlink_to(tmp_path / stays[0])
        Ring.create(16).remove()
        stays += ["tangible-999999998-x.ring", "tangible-999999997-x.ring"]
        assert {path.name for path in tmp_path.iterdir()} == {*stays}

    def test_file_of_another_user_or_that_cannot_be_deleted_stays(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(shared_memory, "shared_folder", lambda: tmp_path)
        dead = tmp_path / "tangible-999999995-x.ring"
        dead.touch()

        def refused(path: Path, missing_ok: bool = False) -> None:
            raise PermissionError(1, "not permitted", str(path))

        for thing, name, other in ((os, "getuid", lambda: 12345), (Path, "unlink", refused)):
            with monkeypatch.context() as patch:
                patch.setattr(thing, name, other)
                Ring.create(16)
            assert dead.exists()

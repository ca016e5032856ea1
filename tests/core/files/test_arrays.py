"""If one of these fails, an array is read wrong, or a damaged or hostile file fills the memory."""

import io
import struct
import tracemalloc
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis.extra import numpy as arrays

from hostile import npy_header, npz, npz_bomb
from tangible_core.files.arrays import Archive, read_array, write_arrays
from tangible_core.files.reading import MAX_BYTES, TooLargeError

ONE = npy_header((2, 3)) + np.arange(6.0).tobytes()


def npy_bytes(array: object, **options) -> bytes:
    file = io.BytesIO()
    np.save(file, array, **options)
    return file.getvalue()


def npz_bytes(**held: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.savez_compressed(file, **held)
    return file.getvalue()


def refusal(data: bytes) -> str:
    with pytest.raises(ValueError) as error:
        read_array(io.BytesIO(data))
    text = str(error.value)
    assert text.isprintable()
    assert len(text) <= 200
    return text


@given(
    arrays.arrays(arrays.scalar_dtypes() | arrays.unicode_string_dtypes(), arrays.array_shapes(min_dims=0, min_side=0))
)
def test_array_that_numpy_wrote_is_read_back_unchanged(array: np.ndarray):
    for data in (npy_bytes(array), npy_bytes(np.asarray(array, order="F")), npz_bytes(it=array)):
        again = read_array(io.BytesIO(data))
        assert (again.dtype, again.shape) == (array.dtype, array.shape)
        assert again.tobytes() == array.tobytes()
        assert again.flags.writeable


def archive(**members: bytes) -> bytearray:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as held:
        for name, data in members.items():
            held.writestr(name.replace("_", "."), data)
    return bytearray(file.getvalue())


def archive_with_field(at: int, directory_at: int, what: bytes) -> bytes:
    """Return an archive of one array with a field changed in both its headers."""
    data = archive(a_npy=ONE)
    entry = data.rfind(b"PK\x01\x02")
    data[at : at + len(what)] = what
    data[entry + directory_at : entry + directory_at + len(what)] = what
    return bytes(data)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "EOF"),
        (b"hello", "magic string"),
        (ONE[:50], "EOF"),
        (ONE[:-1], "48 bytes of numbers, but 47 follow"),
        (ONE + b"x", "48 bytes of numbers, but 49 follow"),
        (npy_header((2, 3)), "but 0 follow"),
        (npy_header((-1, 2)), "the shape (-1, 2)"),
        (npy_header((2, 2), "|O") + b"x" * 32, "Python objects or records"),
        (npy_bytes(np.zeros(3, [("a", "f8"), ("b", "i4")])), "Python objects or records"),
        (npy_bytes(np.array([{}], object), allow_pickle=True), "Python objects or records"),
        (npy_header((1,), "<f8\x1b[31m"), r"\x1b"),
        (npy_header("(" * 5000), ""),
        (npy_header("(" + "9" * 5000 + ",)"), ""),
        (npy_header("(1, 'a')"), "shape is not valid"),
        (npy_header((1,)).replace(b"NUMPY\x02", b"NUMPY\x03"), "for records"),
        (npy_header((1,)).replace(b"NUMPY\x02", b"NUMPY\x09"), "for records"),
        (npz_bytes(), "0 arrays"),
        (npz_bytes(a=np.zeros(2), b=np.ones(2)), "2 arrays"),
        (bytes(archive(readme_txt=b"hello")), "0 arrays"),
        (bytes(archive(a_npy=ONE)[:100]), "not a zip file"),
        (b"PK" + bytes(500), "not a zip file"),
        (bytes(archive(a_npy=b"")), "EOF"),
        (bytes(archive(a_npy=b"hello")), "magic string"),
        (bytes(archive(a_npy=ONE + bytes(1000))), "but 1048 follow"),
        (archive_with_field(6, 8, b"\x01\x00"), "encrypted"),
        (archive_with_field(8, 10, b"\x63\x00"), "its compression is not one"),
        (archive_with_field(14, 16, b"\x00\x00\x00\x00"), "Bad CRC-32"),
        (archive_with_field(22, 24, struct.pack("<I", 1000)), "bytes of numbers"),
        (archive_with_field(22, 24, struct.pack("<I", MAX_BYTES + 1)), "more than 1424 MB"),
        (archive_with_field(26, 28, b"\xff\xff"), ""),
    ],
    ids=map(str, range(99)),  # an archive holds the time at which it was made
)
def test_file_that_is_not_an_array_is_refused_with_the_reason(data: bytes, reason: str):
    assert reason in refusal(data)


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_archive_with_bzip2_or_lzma_is_refused(tmp_path: Path, method: int):
    path = npz(tmp_path / "a.npz", method, a=npy_header((4, 1000)) + bytes(32_000))
    assert "its compression is not one that NumPy uses" in refusal(path.read_bytes())


@contextmanager
def refused_in_little_memory() -> Iterator[None]:
    tracemalloc.start()
    try:
        with pytest.raises(ValueError):
            yield
        assert tracemalloc.get_traced_memory()[1] < 1e7
    finally:
        tracemalloc.stop()


def test_zip_bomb_is_refused_in_little_memory(tmp_path: Path):
    path = npz_bomb(tmp_path / "a.npz", a=(20_000, 20_000))
    with path.open("rb") as file, refused_in_little_memory():
        read_array(file)
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as held:
        held.writestr("a.npy", npy_header((4, 4)) + bytes(50_000_000))
    with (tmp_path / "a.npz").open("rb") as file, refused_in_little_memory():
        read_array(file)
    path = npz_bomb(tmp_path / "a.npz", **{f"n{number}": (9_000_000,) for number in range(20)})
    with path.open("rb") as file:
        held = Archive(file)
        with refused_in_little_memory():
            held.read(held.names)
        with pytest.raises(TooLargeError):
            held.read(held.names)


def test_archive_is_read_by_name_and_compresses_what_shrinks():
    held = Archive(io.BytesIO(npz_bytes(a=np.arange(3), b=np.array("text"))))
    assert held.names == ("a", "b")
    read = held.read(["b", "a"])
    assert (read["a"].tolist(), str(read["b"]), held.read([])) == ([0, 1, 2], "text", {})
    with pytest.raises(ValueError, match="it holds no c, d"):
        held.read(["a", "c", "d"])
    noise = np.random.default_rng(0).random((300, 400), np.float32)
    labels = np.repeat(np.arange(4, dtype=np.int32), 30_000).reshape(300, 400)
    held, file = {"heights": noise, "labels": labels, "few": np.zeros(9), "one": np.array(2)}, io.BytesIO()
    write_arrays(file, held)
    sizes = {each.filename: each.compress_size for each in zipfile.ZipFile(file).infolist()}
    assert sizes["labels.npy"] < labels.nbytes / 50
    assert sizes["heights.npy"] > noise.nbytes
    file.seek(0)
    for name, found in np.load(file).items():  # by NumPy itself
        np.testing.assert_array_equal(found, held[name], strict=True)
    assert Archive(file).read(["labels"])["labels"].tolist() == labels.tolist()

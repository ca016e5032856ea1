"""Arrays in .npy and .npz files: headers are checked before anything is decoded, and no pickled object is loaded."""

import math
import warnings
import zlib
from collections.abc import Collection, Generator, Mapping
from contextlib import contextmanager
from typing import IO, final
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile

import numpy as np

from ..errors import shown
from .reading import TooLargeError, check_bytes, check_size

_CHUNK = 1 << 20
_ZIP = b"PK"
_SAMPLES, _SAMPLE = 8, 1 << 14
"""The number of samples that decide whether an array is worth compressing, and the bytes of each."""
# The largest share of its size that the samples may have after compression for an array to be compressed.
_MAX_SHARE = 0.4


@final
class Archive:
    """The arrays of an .npz file by name; other members are ignored."""

    def __init__(self, file: IO[bytes]) -> None:
        with _plain_errors():
            self._zip = ZipFile(file)
        members = self._zip.infolist()
        self._members = {member.filename[:-4]: member for member in members if member.filename.endswith(".npy")}

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the arrays."""
        return tuple(self._members)

    def read(self, names: Collection[str]) -> dict[str, np.ndarray]:
        """Read the arrays of these names."""
        if missing := [name for name in names if name not in self._members]:
            raise ValueError(f"it holds no {shown(', '.join(missing))}")
        members = {name: self._members[name] for name in names}
        check_bytes(sum(member.file_size for member in members.values()))
        with _plain_errors():
            for member in members.values():  # a few bytes of others decode to gigabytes at once
                if member.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
                    raise ValueError("its compression is not one that NumPy uses")
            return {name: self._read(member.filename, member.file_size) for name, member in members.items()}

    def _read(self, member: str, size: int) -> np.ndarray:
        with self._zip.open(member) as file:
            return _parse_array(file, size)


def write_arrays(file: IO[bytes], arrays: Mapping[str, np.ndarray]) -> None:
    """Write an .npz file; arrays that shrink a lot, such as labels, are compressed: heights hardly shrink."""
    with ZipFile(file, "w", compresslevel=1) as archive:
        for name, array in arrays.items():
            archive.compression = ZIP_DEFLATED if _is_compressible(array) else ZIP_STORED
            with archive.open(f"{name}.npy", "w", force_zip64=True) as part:
                np.lib.format.write_array(part, np.asanyarray(array), allow_pickle=False)


def _is_compressible(array: np.ndarray) -> bool:
    """Return True if compression pays, by a few samples: to try a whole array takes as long as to write it."""
    if array.nbytes < _SAMPLES * _SAMPLE:
        return False
    flat = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    starts = np.linspace(0, max(0, flat.size - _SAMPLE), _SAMPLES).astype(int)
    samples = [flat[start : start + _SAMPLE].tobytes() for start in dict.fromkeys(starts.tolist())]
    return sum(len(zlib.compress(sample, 1)) for sample in samples) <= _MAX_SHARE * sum(map(len, samples))


def read_array(file: IO[bytes]) -> np.ndarray:
    """Read the array of an .npy file, or the only array of an .npz file, whatever the file's name."""
    is_zip = file.read(len(_ZIP)) == _ZIP
    size = file.seek(0, 2)
    file.seek(0)
    if not is_zip:
        with _plain_errors():
            return _parse_array(file, size)
    archive = Archive(file)
    if len(archive.names) != 1:
        raise ValueError(f"it holds {len(archive.names)} arrays instead of one")
    (array,) = archive.read(archive.names).values()
    return array


@contextmanager
def _plain_errors() -> Generator[None]:
    """Turn any error into a ValueError with one line, and ignore warnings: a damaged file can cause anything."""
    try:
        with warnings.catch_warnings(action="ignore"):
            yield
    except (TooLargeError, MemoryError):
        raise
    except Exception as error:
        raise ValueError(shown(str(error) or type(error).__name__, 200)) from error


def _parse_array(file: IO[bytes], size: int) -> np.ndarray:
    """Read the array of an .npy file, or of a member of an archive, of `size` bytes."""
    version = np.lib.format.read_magic(file)
    if version > (2, 0):
        raise ValueError("its header is for records, not for numbers")
    header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, by_columns, dtype = header(file)
    if dtype.kind in "OV":
        raise ValueError("it holds Python objects or records, not numbers")
    if min(shape, default=0) < 0:
        raise ValueError(f"its header states the shape {shape}")
    check_size(shape, dtype.itemsize)
    size_bytes = math.prod(shape) * dtype.itemsize
    if (follow := size - file.tell()) != size_bytes:
        raise ValueError(f"its header announces {size_bytes} bytes of numbers, but {follow} follow")
    data = np.empty(size_bytes, np.uint8)
    for start in range(0, size_bytes, _CHUNK):
        part = data[start : start + _CHUNK]
        read = file.read(len(part))
        if len(read) != len(part):
            raise ValueError("it is cut short")
        part[:] = np.frombuffer(read, np.uint8)
    return np.ndarray(shape, dtype, data, order="F" if by_columns else "C")

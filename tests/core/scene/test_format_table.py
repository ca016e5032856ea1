"""If this fails, docs/pictures.md promises formats that are not read; `python FILE` writes its table anew."""

import re
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path

import cv2
import imagecodecs
import numpy as np
import pillow_heif
import tifffile
from PIL import Image

from tangible_core.errors import PictureError
from tangible_core.scene.formats.pictures import read_map, read_picture

DOCS = Path(__file__).parents[3] / "docs" / "pictures.md"
MARKS = "<!-- formats: written by tests/core/scene/test_format_table.py -->\n", "<!-- end of formats -->\n"
TYPES = ("uint8", "uint16", "uint32", "int16", "int32", "float16", "float32", "float64", "complex64")
Write = Callable[[Path, np.ndarray], object]


def pillow(form: str) -> Write:
    return lambda path, values: Image.fromarray(values).save(path, form)


def opencv(suffix: str) -> Write:
    return lambda path, values: path.write_bytes(cv2.imencode(suffix, values)[1].tobytes())


def numbers(dtype: str) -> Write:
    """Write numbers with a header of their own format."""
    return lambda path, values: (
        path.with_suffix(".hdr").write_text(
            f"NROWS {len(values)}\nNCOLS {values.shape[1]}\nNBITS {8 * values.itemsize}\nPIXELTYPE "
            f"{'SIGNEDINT' if values.dtype.kind == 'i' else 'UNSIGNEDINT'}\n"
        ),
        path.write_bytes(values.astype(dtype).tobytes() if dtype else values.tobytes()),
    )


def ascii_grid(path: Path, values: np.ndarray) -> None:
    rows = "\n".join(" ".join(map(str, row)) for row in values)
    path.write_text(f"ncols {values.shape[1]}\nnrows {len(values)}\ncellsize 1\n{rows}\n")


def pfm(path: Path, values: np.ndarray) -> None:
    path.write_bytes(b"Pf\n%d %d\n-1\n" % values.shape[::-1] + values[::-1].tobytes())


def jpeg_2000(path: Path, values: np.ndarray) -> None:
    path.write_bytes(imagecodecs.jpeg2k_encode(values, level=0))


def heic(path: Path, values: np.ndarray) -> None:
    pillow_heif.from_pillow(Image.fromarray(values)).save(path)


FORMATS: Mapping[str, tuple[str, tuple[str, ...], Write]] = {
    "TIFF, compressed or not": (
        "a.tif", TYPES, lambda path, values: tifffile.imwrite(path, values, compression="lzw")
    ),
    "PNG": ("a.png", ("uint8", "uint16"), opencv(".png")),
    "NPY, NPZ": ("a.npy", TYPES, lambda path, values: np.save(path, values)),
    "PGM": ("a.pgm", ("uint8", "uint16"), opencv(".pgm")),
    "PFM": ("a.pfm", ("float32",), pfm),
    "JPEG 2000": ("a.jp2", ("uint8", "uint16"), jpeg_2000),
    "BMP, GIF": ("a.bmp", ("uint8",), pillow("BMP")),
    "WebP": ("a.webp", ("uint8",), lambda path, values: Image.fromarray(values).save(path, "WEBP", lossless=True)),
    "JPEG": ("a.jpg", ("uint8",), pillow("JPEG")),
    "AVIF": ("a.avif", ("uint8",), pillow("AVIF")),
    "HEIC, by the extra `heic`": ("a.heic", ("uint8",), heic),
    "ESRI ASCII grid": ("a.asc", ("int32", "float64"), ascii_grid),
    "SRTM": ("a.hgt", ("int16",), numbers(">i2")),
    "BIL": ("a.bil", ("uint8", "int16", "int32"), numbers("")),
    "FLT": ("a.flt", ("float32",), numbers("")),
}  # fmt: skip


def as_map(path: Path, values: np.ndarray) -> bool:
    """Return True if a file of these values is a map of them."""
    try:
        return bool(np.array_equal(read_map(path), values.astype(np.float32)))
    except PictureError:
        return False


def as_picture(path: Path, values: np.ndarray) -> bool:
    try:
        return read_picture(path).shape[:2] == values.shape
    except PictureError:
        return False


def table(folder: Path) -> str:
    """Write each kind of file, read it, and say what was read."""
    rows = ["| format | numbers that are read as they are, in a map | a picture |", "|---|---|---|"]
    for name, (file, types, write) in FORMATS.items():
        maps, pictures = [], []
        for dtype in types:
            values = (np.arange(64 * 64).reshape(64, 64) % 200).astype(dtype)
            write(folder / file, values)
            if as_map(folder / file, values):
                maps.append(dtype)
            if as_picture(folder / file, values):
                pictures.append(dtype)
        rows.append(f"| {name} | {', '.join(maps) or '-'} | {', '.join(pictures) or '-'} |")
    return "\n".join(rows) + "\n"


def test_table_of_formats_is_what_is_read(tmp_path: Path):
    start, end = map(re.escape, MARKS)
    written = re.search(f"{start}\n?(.*?){end}", DOCS.read_text("utf-8"), re.DOTALL)
    assert written and written[1].strip() == table(tmp_path).strip()


if __name__ == "__main__":
    text = DOCS.read_text("utf-8")
    before, rest = text.split(MARKS[0])
    with tempfile.TemporaryDirectory() as folder:
        DOCS.write_text(
            before + MARKS[0] + "\n" + table(Path(folder)) + "\n" + MARKS[1] + rest.split(MARKS[1])[1], "utf-8"
        )

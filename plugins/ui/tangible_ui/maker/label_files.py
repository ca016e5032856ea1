"""Label pictures as a page sends them, and as files: `parts.png`, which paint programs open and pipelines read."""

import hashlib
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np
from jaxtyping import Int32, UInt16
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from tangible_core.errors import ConfigError
from tangible_core.files.reading import MOST_PIXELS
from tangible_core.scene.picture_files import MAX_LABELS

NAME = "parts.png"
GZIP = 31
"""What zlib is told so that it takes a gzip file and nothing else."""
TURN = 0.618034
"""Of the circle of hues, from one label's colour to the next one's: neighbours in number are far apart in colour."""
_DOCUMENT, _CONTENT = "Pipeline file", "Labels"


def unpacked(path: Path, shape: tuple[int, int]) -> UInt16[np.ndarray, "h w"]:
    """Labels as a page has sent them: uint16, little-endian, row by row, as gzip.

    No more than one byte too many is ever unpacked. Raises: ConfigError for anything else, and another size.
    """
    size = 2 * shape[0] * shape[1]
    wrong = f"the labels that were sent are no gzip of {shape[1]} x {shape[0]} numbers of two bytes; send them again"
    if not 0 < size <= 2 * MOST_PIXELS:
        raise ConfigError(wrong)
    try:
        unpacking = zlib.decompressobj(GZIP)
        with path.open("rb") as file:
            found = unpacking.decompress(file.read(size + size // 1000 + 1024), size + 1)
    except (zlib.error, OSError) as error:
        raise ConfigError(wrong) from error
    if len(found) != size or not unpacking.eof:
        raise ConfigError(wrong)
    return np.frombuffer(found, "<u2").reshape(shape).astype(np.uint16, copy=False)


def as_png(labels: Int32[np.ndarray, "h w"], document: str) -> bytes:
    """A picture that `read_labels` takes for the same labels, in colours where there are few enough.

    document: the name of the pipeline file that it belongs to. Raises: ConfigError for more labels than one may hold.
    """
    count = int(labels.max(initial=0)) + 1
    if count > MAX_LABELS:
        raise ConfigError(f"these are {count} parts, and at most {MAX_LABELS} are allowed; join some of them")
    if count <= len(_PALETTE):
        image = Image.fromarray(labels.astype(np.uint8))
        image.putpalette(_PALETTE.tobytes())
    else:
        image = Image.fromarray(labels.astype(np.uint16))
    said = PngInfo()
    said.add_text("Software", "Tangible Images")
    said.add_text(_DOCUMENT, document)
    said.add_text(_CONTENT, _digest(np.asarray(image)))
    written = BytesIO()
    image.save(written, "PNG", pnginfo=said, compress_level=3)
    return written.getvalue()


def is_ours(path: Path, document: str) -> bool:
    """Whether a file is as `as_png` made it for this pipeline file: nobody has painted in it since."""
    try:
        with Image.open(path, formats=("PNG",)) as image:
            said = getattr(image, "text", {})
            return said.get(_DOCUMENT) == document and said.get(_CONTENT) == _digest(np.asarray(image))
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return False


def _digest(values: np.ndarray) -> str:
    return hashlib.sha256(f"{values.shape}".encode() + np.ascontiguousarray(values).tobytes()).hexdigest()[:32]


def _colours() -> np.ndarray:
    """Of 256 labels, (256, 3) bytes: the first one dark, the others bright, each of another hue."""
    numbers = np.arange(256)
    hue, value = numbers * TURN % 1, np.where(numbers % 2 == 0, 0.95, 0.7)
    ramps = np.clip(np.abs((hue[:, None] + np.array([0, 2 / 3, 1 / 3])) % 1 * 6 - 3) - 1, 0, 1)
    colours = np.round(255 * value[:, None] * (0.35 + 0.65 * ramps)).astype(np.uint8)
    colours[0] = 40
    return colours


_PALETTE = _colours()

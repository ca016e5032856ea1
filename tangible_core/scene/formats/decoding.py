"""The pixels of picture files, decoded within limits; whatever is wrong with a file is one PictureError."""

import logging
import struct
import warnings
from collections.abc import Callable, Generator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ...errors import PictureError, TangibleError, did_you_mean, shown
from ...files import arrays
from ...files.reading import MOST_PIXELS, TOO_MANY_PIXELS, TooLargeError, check_size, read_bytes
from ...runtime.opencv import silent_opencv
from .multi_picture import Notify, count_pictures, ignore
from .tiff_tags import TIFF, Shape, tiff_size

if TYPE_CHECKING:
    from PIL.Image import Image

log: logging.Logger = logging.getLogger(__name__)

T = TypeVar("T")

FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "GIF", "WEBP", "PPM", "JPEG2000")
"""Formats that Pillow may read. Others that it knows run programs (EPS) or cannot be told from noise (TGA)."""

PICTURES = frozenset(
    (".png", ".jpg", ".jpeg", ".jp2", ".webp", ".bmp", ".gif", ".tif", ".tiff", ".ppm", ".pgm", ".heic", ".avif")
)
"""Suffixes of pictures; a file with another one, unless it is a video, is read as a pipeline file."""

VIDEOS = frozenset((".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".wmv", ".ogv", ".3gp", ".mts"))
"""Suffixes of videos."""

JPEG = b"\xff\xd8\xff"
"""The first bytes of a JPEG."""
PNG = b"\x89PNG\r\n\x1a\n"
"""The first bytes of a PNG."""
MOST_REDUCED = 10 * MOST_PIXELS
"""The most pixels of a picture that is reduced while it is decoded: more would take minutes."""

_ORIENTATION, _BITS_PER_SAMPLE = 0x0112, 0x0102  # tags of EXIF and of TIFF


def values_of(path: Path, data: bytes, notify: Notify, indices: bool = False) -> np.ndarray:
    """Return the array that a file of these bytes holds; indices: keep the palette's indices. Raises: PictureError."""
    if path.suffix.lower() in (".npy", ".npz"):
        return _array(path, data)
    return decode(path, data, indices, notify)


def bytes_of(path: Path) -> bytes:
    """Return the content of a file. Raises: PictureError, with the cure, if it is missing or cannot be read."""
    try:
        data = read_bytes(path)
    except (FileNotFoundError, NotADirectoryError) as error:
        raise absent(path, "file") from error
    except OSError as error:
        raise PictureError(
            f"{path}: cannot be read: {error.strerror or error}; check the path and its permissions"
        ) from error
    if not data:
        raise PictureError(f"{path}: the file is empty; copy or download it again")
    return data


def absent(path: Path, what: str) -> PictureError:
    """Return the error for a path at which nothing is, with a similar name from its folder as a hint."""
    if not path.parent.is_dir():
        return PictureError(f"{path}: there is no folder {path.parent}; check the path")
    near = did_you_mean(path.name, (each.name for each in path.parent.iterdir()))
    return PictureError(f"{path}: there is no such {what}{near}")


def _array(path: Path, data: bytes) -> np.ndarray:
    try:
        return arrays.read_array(BytesIO(data))
    except TooLargeError as error:
        raise _too_large(path, error) from error
    except ValueError as error:
        raise PictureError(
            f"{path}: cannot be read as an array: {error}; save a single array with numpy.save"
        ) from error


def decode(path: Path, data: bytes, indices: bool = False, notify: Notify = ignore, frame: int = 0) -> np.ndarray:
    """Decode a picture: with Pillow, which reports faults, or with OpenCV where Pillow would drop bits."""
    with _picture_errors(path):
        return _decode(path, data, indices, notify, frame)


def decode_reduced(path: Path, data: bytes, notify: Notify = ignore) -> np.ndarray | None:
    """Decode a JPEG, PNG or TIFF of more than MOST_PIXELS at a half, a quarter or an eighth of its sides.

    The whole picture is never in memory: the decoder of JPEG leaves out the finer waves of each block, and a PNG or
    TIFF is decoded in bands of rows.
    Returns: None for a picture that is not too large, larger than MOST_REDUCED, or of another format.
    """
    with _picture_errors(path):
        if data[:3] == JPEG:
            return _reduced_jpeg(path, data, notify)
        if data[:8] == PNG or data[:4] in TIFF:
            return _reduced_bands(path, data, notify)
    return None


def _reduced_jpeg(path: Path, data: bytes, notify: Notify) -> np.ndarray | None:
    from PIL.JpegImagePlugin import JpegImageFile

    with JpegImageFile(BytesIO(data)) as image:
        times = _times(image.height, image.width)
        if times is None:
            return None
        _notify_reduced(path, image.height, image.width, times, notify)
        image.draft(image.mode, (image.width // times, image.height // times))
        check_size((image.height, image.width, len(image.getbands())), 4)
        image.load()
        return np.ascontiguousarray(upright(_values(image, indices=False), orientation(image)))


def _reduced_bands(path: Path, data: bytes, notify: Notify) -> np.ndarray | None:
    shape, _ = _png_size(data) if data[:8] == PNG else tiff_size(data)
    if _times(*shape[:2]) is None:
        return None
    from .large.bands import WholePieceError, reduced
    from .large.png_bands import png_bands
    from .large.tiff_bands import tiff_bands

    try:
        bands = png_bands(data) if data[:8] == PNG else tiff_bands(data)
    except WholePieceError as error:
        raise PictureError(f"{path}: {TOO_MANY_PIXELS} and cannot be reduced while it is read; {error}") from error
    times = _times(bands.rows, bands.columns)
    if times is None:
        return None
    _notify_reduced(path, bands.rows, bands.columns, times, notify)
    pictures = (_decode(path, band, False, ignore, 0) for band in bands.files)
    return np.ascontiguousarray(upright(reduced(pictures, bands.rows, bands.columns, times), bands.orientation))


def _times(rows: int, columns: int) -> int | None:
    """Return the factor by which the sides of a picture are reduced; None if it is not too large, or much too large."""
    if not MOST_PIXELS < columns * rows <= MOST_REDUCED:
        return None
    return next((each for each in (2, 4, 8) if -(-rows // each) * -(-columns // each) <= MOST_PIXELS), None)


def _notify_reduced(path: Path, rows: int, columns: int, times: int, notify: Notify) -> None:
    notify(
        f"{path.name} has {columns * rows / 1e6:.0f} megapixels; it is reduced to {-(-columns // times)} x "
        f"{-(-rows // times)} pixels while it is read"
    )


def look_at(path: Path, data: bytes, look: Callable[["Image"], T]) -> T:
    """Return what `look` finds in an open file whose pixels are not decoded yet."""
    from PIL import Image
    from PIL.JpegImagePlugin import jpeg_factory

    with _picture_errors(path):
        jpeg = data[:3] == JPEG  # may have more pixels than Pillow opens: `decode_reduced` has read it
        with jpeg_factory(BytesIO(data)) if jpeg else Image.open(BytesIO(data), formats=FORMATS) as image:
            return look(image)


@contextmanager
def _picture_errors(path: Path) -> Generator[None]:
    """Turn whatever is wrong with a file into a PictureError."""
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # on tags that Pillow skips
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            yield
    except UnidentifiedImageError as error:
        cure = "write `video:` for a video" if path.suffix.lower() in VIDEOS else "use PNG, JPEG, TIFF, PFM or NPY"
        raise PictureError(f"{path}: is not a picture that this program can read; {cure}") from error
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:  # Pillow's limit is above ours
        raise _too_large(path, TOO_MANY_PIXELS) from error
    except TooLargeError as error:
        raise _too_large(path, error) from error
    except TangibleError:  # also a stop, which is no damage
        raise
    except Exception as error:  # a damaged file can provoke any
        raise PictureError(
            f"{path}: the picture is damaged or cut short: {shown(str(error))}; copy or download it again"
        ) from error


def _too_large(path: Path, why: object) -> PictureError:
    return PictureError(f"{path}: {why}; make it smaller first")


def _decode(path: Path, data: bytes, indices: bool, notify: Notify, frame: int) -> np.ndarray:
    from PIL import Image, UnidentifiedImageError

    if data[:4] in TIFF:
        check_size(*tiff_size(data))  # Pillow does not check tiles, which may be larger than the picture
    try:
        image = Image.open(BytesIO(data), formats=FORMATS)
    except UnidentifiedImageError:
        if data[:4] not in TIFF[:2]:
            raise
        return _decode_with_opencv(path, data)
    with image:
        if (count := count_pictures(image)) > 1 and not frame:
            cure = "; for both views write `stereo:`" if image.format == "MPO" else ""
            notify(f"{path.name} holds {count} pictures, of which the first is taken{cure}")
        image.seek(frame)
        check_size((image.height, image.width, len(image.getbands())), 4)
        image.load()
        values = _decode_with_opencv(path, data) if _is_deep_colour(image, data) else _values(image, indices)
        return np.ascontiguousarray(upright(values, orientation(image)))


def _is_deep_colour(image: "Image", data: bytes) -> bool:
    """Tell whether Pillow would cut 16 bits a channel down to 8."""
    from PIL.TiffImagePlugin import TiffImageFile

    if isinstance(image, TiffImageFile):
        return image.mode in ("RGB", "RGBA") and 16 in image.tag_v2.get(_BITS_PER_SAMPLE, ())
    return image.format == "PNG" and data[24] == 16 and image.mode != "I;16"


def _values(image: "Image", indices: bool) -> np.ndarray:
    mode = image.mode
    if mode in ("F", "L", "RGB", "RGBA") and not (mode != "RGBA" and image.has_transparency_data):
        return np.asarray(image)
    if mode.startswith("I"):
        whole = np.asarray(image)
        return whole.astype(np.uint16) if whole.min() >= 0 and whole.max() <= 0xFFFF else whole
    if mode == "P" and indices:
        return np.asarray(image)
    return np.asarray(image.convert("L" if mode == "1" else "RGBA" if image.has_transparency_data else "RGB"))


def orientation(image: "Image") -> int:
    """Return the orientation of the camera by EXIF; 1, upright, if there is none that can be read."""
    try:
        return image.getexif().get(_ORIENTATION, 1)
    except Exception as error:  # noqa: BLE001 - a picture is worth more than its damaged tags
        log.warning("EXIF tags are damaged (%s); the picture is taken as upright", error)
        return 1


def upright(values: np.ndarray, orientation: int) -> np.ndarray:
    """Turn and mirror a picture by its orientation. Source: EXIF 2.3, tag 0x0112."""
    if orientation in (5, 6, 7, 8):
        values = values.swapaxes(0, 1)
    if orientation in (3, 4, 7, 8):
        values = values[::-1]
    if orientation in (2, 3, 6, 7):
        values = values[:, ::-1]
    return values


def _decode_with_opencv(path: Path, data: bytes) -> np.ndarray:
    """Decode a PNG or a TIFF. OpenCV has no limit on sizes, so the headers are checked first."""
    import cv2

    if data.startswith(b"\x89PNG"):
        check_size(*_png_size(data))
    try:
        with silent_opencv():  # the error below reports the fault in one line
            values: np.ndarray | None = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        values = None
    if values is None:
        raise PictureError(f"{path}: the picture is damaged or of an unsupported kind; save it again as PNG or TIFF")
    if values.ndim == 3:
        values = cv2.cvtColor(values, cv2.COLOR_BGRA2RGBA if values.shape[2] == 4 else cv2.COLOR_BGR2RGB)
    return values


def _png_size(data: bytes) -> tuple[Shape, int]:
    """Return the largest shape and bytes a value that the first chunk of a PNG allows."""
    width, height = struct.unpack_from(">II", data, 16)
    return (height, width, 4), 2

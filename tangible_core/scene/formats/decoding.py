"""The pixels of picture files, decoded within limits; whatever is wrong with a file is one PictureError."""

import logging
import struct
import warnings
from collections.abc import Callable, Generator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeVar

import numpy as np

from ...data.pictures import is_opaque
from ...errors import PictureError, TangibleError, shown
from ...files import arrays
from ...files.paths import what_is_missing
from ...files.reading import TOO_MANY_PIXELS, TooLargeError, check_size, read_bytes
from ...runtime.opencv import cv2, silent_opencv
from .grids import GRIDS, read_grid
from .heif import is_heif, read_heif
from .kinds import ASC, JPEG, JPEG_2000, NPY, VIDEOS, ZIP
from .map_numbers import is_nodata
from .multi_picture import Notify, count_pictures, ignore
from .netpbm import NETPBM, read_netpbm
from .tiff import TIFF, TiffRaster, UnreadableError, tiff_picture

if TYPE_CHECKING:
    from PIL.Image import Image

log: logging.Logger = logging.getLogger(__name__)

T = TypeVar("T")
# Libraries whose errors name lines of their source and no fault that people know.
TERSE = ("cv2", "imagecodecs")

# The use of a file's numbers: brightness up to white, numbers as they are stored, or numbers that name segments.
Purpose = Literal["picture", "map", "labels"]

# Formats that Pillow may read. Others that it knows run programs (EPS) or cannot be told from noise (TGA).
FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "GIF", "WEBP", "PPM", "JPEG2000", "AVIF")


ORIENTATION = 0x0112  # tag of EXIF


def decode_values(path: Path, data: bytes, notify: Notify, purpose: Purpose = "picture") -> np.ndarray:
    """Return the array of a file, masked where a map has no data, for labels the indices. Raises: PictureError."""
    if data[:6] == NPY or data[:4] == ZIP:
        return _array(path, data)
    if path.suffix.lower() in GRIDS or ASC.match(data):
        with picture_errors(path):
            return read_grid(path, data)
    return decode(path, data, purpose, notify)


def content_bytes(path: Path) -> bytes:
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
    return PictureError(f"{path}: {what_is_missing(path, (file.name for file in path.parent.iterdir()), what)}")


def _array(path: Path, data: bytes) -> np.ndarray:
    try:
        return arrays.read_array(BytesIO(data))
    except TooLargeError as error:
        raise _too_large(path, error) from error
    except ValueError as error:
        raise PictureError(
            f"{path}: cannot be read as an array: {error}; save a single array with numpy.save"
        ) from error


def decode(
    path: Path, data: bytes, purpose: Purpose = "picture", notify: Notify = ignore, frame: int = 0
) -> np.ndarray:
    """Decode a picture by its first bytes, upright, with all its bits."""
    with picture_errors(path):
        values = _decode_tiff(path, data, purpose, notify) if data[:4] in TIFF else None
        values = decode_plain(path, data, purpose, notify, frame) if values is None else values
        return values if np.ma.isMaskedArray(values) else np.ascontiguousarray(values)


def look_at(path: Path, data: bytes, look: Callable[["Image"], T]) -> T:
    """Return what `look` finds in an open file whose pixels are not decoded yet."""
    from PIL import Image
    from PIL.JpegImagePlugin import jpeg_factory

    with picture_errors(path):
        jpeg = data[:3] == JPEG  # may have more pixels than Pillow opens: `reducing` has read it
        with jpeg_factory(BytesIO(data)) if jpeg else Image.open(BytesIO(data), formats=FORMATS) as image:
            return look(image)


@contextmanager
def picture_errors(path: Path) -> Generator[None]:
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
    except UnreadableError as error:
        raise PictureError(f"{path}: {error}") from error
    except TangibleError:  # also a stop, which is no damage
        raise
    except Exception as error:  # a damaged file can provoke any
        why = "" if type(error).__module__.partition(".")[0] in TERSE else f": {shown(str(error))}"
        raise PictureError(f"{path}: the picture is damaged or cut short{why}; copy or download it again") from error


def _too_large(path: Path, why: object) -> PictureError:
    return PictureError(f"{path}: {why}; make it smaller first")


def _decode_tiff(path: Path, data: bytes, purpose: Purpose, notify: Notify) -> np.ndarray | None:
    """Decode a TIFF; None for colours that Pillow knows."""
    with tiff_picture(data) as picture:
        if picture is None:
            return None
        if picture.pages > 1:
            notify(f"{path.name} holds {picture.pages} pictures, of which the first is taken")
        (raster,) = picture.bands
        if raster.dropped:
            notify(f"{path.name} has {raster.dropped} more channels, such as infrared, which are left out")
        values = meaning(raster, purpose, picture.nodata)
        if np.ma.isMaskedArray(values) and picture.nodata is not None:
            missing = np.count_nonzero(is_nodata(raster.values, picture.nodata))
            notify(f"{100 * missing / values.size:.1f} % of {path.name} is {picture.nodata:g}, its value for no data")
        return upright(values, picture.orientation)


def meaning(raster: TiffRaster, purpose: Purpose, nodata: float | None) -> np.ndarray:
    """Return the numbers of a TIFF as a picture's brightness or colours, as a masked map, or as labels."""
    values, valid_mask = raster.values, raster.known
    if purpose == "labels":
        return values
    is_number = values.ndim == 2 and raster.palette is None
    if nodata is not None and is_number and (missing := is_nodata(values, nodata)).any():
        valid_mask = ~missing if valid_mask is None else valid_mask & ~missing
    if purpose == "map":
        if values.ndim == 3 and not np.any(values != values[..., :1]):
            values = values[..., 0]
        nodata_mask = np.zeros(values.shape[:2], np.bool_) if valid_mask is None else ~valid_mask
        nodata_mask |= False if raster.alpha is None else ~is_opaque(raster.alpha)
        return np.ma.masked_array(values, nodata_mask) if nodata_mask.any() and values.ndim == 2 else values
    alpha = raster.alpha
    if raster.palette is not None:
        values = _in_full(raster.palette[values], 0xFFFF if raster.palette.max() > 255 else 255)
        values = (values >> 8).astype(np.uint8) if values.dtype == np.uint16 else values
    elif raster.white is not None:
        values = _in_full(raster.white - values if raster.zero_is_white else values, raster.white)
        alpha = None if alpha is None else _in_full(alpha, raster.white)
    return values if valid_mask is None and alpha is None else _with_alpha(values, valid_mask, alpha)


def _in_full(values: np.ndarray, white: int) -> np.ndarray:
    """Return brightness up to 255 or 65535, whose white was another number."""
    if white > 0xFFFF:
        return values
    full = 255 if white < 256 else 0xFFFF
    numbers = values if white == full else (values.astype(np.uint64) * full + white // 2) // white
    return numbers.astype(np.uint8 if full == 255 else np.uint16, copy=False)


def _with_alpha(values: np.ndarray, known: np.ndarray | None, alpha: np.ndarray | None = None) -> np.ndarray:
    """Return a picture with a fourth channel: its opacity, 0 where it is not known."""
    full = np.iinfo(values.dtype).max if values.dtype.kind in "iu" else max(1.0, float(np.nanmax(values)))
    opacity = np.full(values.shape[:2], full, values.dtype) if alpha is None else alpha
    colours = values if values.ndim == 3 else np.repeat(values[..., None], 3, axis=2)
    return np.dstack([colours, opacity if known is None else opacity * known])


def decode_plain(path: Path, data: bytes, purpose: Purpose, notify: Notify, frame: int) -> np.ndarray:
    """Decode a picture that is not a TIFF: with Pillow, which reports faults, or another where Pillow drops bits."""
    from PIL import Image

    if data[:2] in NETPBM:
        values, white = read_netpbm(data)
        return values if white is None or purpose != "picture" else _in_full(values, white)
    if is_heif(data):
        return read_heif(data)
    with Image.open(BytesIO(data), formats=FORMATS) as image:
        if (count := count_pictures(image)) > 1 and not frame:
            cure = "; for both views write `stereo:`" if image.format == "MPO" else ""
            notify(f"{path.name} holds {count} pictures, of which the first is taken{cure}")
        image.seek(frame)
        check_size((image.height, image.width, len(image.getbands())), 4)
        deep = _jpeg_2000(data, purpose) if image.format == "JPEG2000" else None
        if deep is None:
            image.load()
            deep = _deep_png(image, path, data, purpose) if image.format == "PNG" and data[24] == 16 else None
        values = image_values(image, purpose) if deep is None else deep
        if image.format == "PNG" and purpose == "map" and data[24] < 8 and image.mode in ("1", "L"):
            values = values // (255 // ((1 << data[24]) - 1))
        return upright(values, orientation(image))


def _deep_png(image: "Image", path: Path, data: bytes, purpose: Purpose) -> np.ndarray:
    """Decode a PNG of 16 bits, of which Pillow keeps 8 in colours, and drops the colour that is transparent."""
    values = np.asarray(image).astype(np.uint16) if image.mode == "I;16" else _decode_with_opencv(path, data)
    clear = image.info.get("transparency")
    if clear is None or purpose == "labels" or values.shape[2:] == (4,):
        return values
    valid_mask = values != clear if values.ndim == 2 else (values != np.array(clear)).any(axis=2)
    if purpose == "map" and values.ndim == 2:
        return np.ma.masked_array(values, ~valid_mask)
    return _with_alpha(values, valid_mask)


def _jpeg_2000(data: bytes, purpose: Purpose) -> np.ndarray | None:
    """Decode a JPEG 2000 that is not one of 8 bits without a sign, which Pillow reads. Source: T.800, A.5.1 (SIZ)."""
    size = data.find(JPEG_2000[1])
    depth = data[size + 42]
    if size < 0 or depth == 7:
        return None
    import imagecodecs

    values: np.ndarray = imagecodecs.jpeg2k_decode(data)
    return values if purpose != "picture" or depth & 0x80 else _in_full(values, (2 << depth) - 1)


def image_values(image: "Image", purpose: Purpose) -> np.ndarray:
    """Return the pixels of a loaded picture, without a palette unless they are labels."""
    mode, transparent = image.mode, image.has_transparency_data
    plain = mode == "RGBA" or (mode in ("F", "L", "RGB") and not transparent)
    if plain or (mode == "P" and purpose == "labels"):
        return np.asarray(image)
    if mode.startswith("I"):
        whole = np.asarray(image)
        return whole.astype(np.uint16) if whole.min() >= 0 and whole.max() <= 0xFFFF else whole
    return np.asarray(image.convert("RGBA" if transparent else "L" if mode == "1" else "RGB"))


def orientation(image: "Image") -> int:
    """Return the orientation of the camera by EXIF; 1, upright, if there is none that can be read."""
    try:
        return image.getexif().get(ORIENTATION, 1)
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
    """Decode a PNG; OpenCV has no limit on sizes, and another idea of which header counts than Pillow."""
    check_size((*png_size(data), 4), 2)
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


def png_size(data: bytes) -> tuple[int, int]:
    """Return the rows and columns that the first chunk of a PNG states."""
    width, height = struct.unpack_from(">II", data, 16)
    return height, width

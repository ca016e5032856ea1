"""Pictures, maps of numbers and label pictures in files. Whatever is wrong with a file is one PictureError."""

import logging
import struct
import warnings
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import Float32, Int32

from ..data.pictures import check_finite, check_picture
from ..errors import PictureError, did_you_mean, shown
from ..files import arrays
from ..files.reading import TOO_MANY_PIXELS, TooLarge, check_size, read_bytes

if TYPE_CHECKING:
    from PIL.Image import Image

log = logging.getLogger(__name__)

FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "GIF", "WEBP", "PPM", "JPEG2000")
"""What Pillow may read. Some that it also knows run other programs (EPS) or cannot be told from noise (TGA)."""

NonFinite = Literal["error", "mask"]

MAX_LABELS = 4096
"""More than this in a label picture, and it is a photo."""

TIFF = (b"II*\0", b"MM\0*", b"MM*\0", b"II\0*", b"MM\0+", b"II+\0")
"""How one begins for Pillow; OpenCV knows the first two."""
TAG_TYPES = {1: "B", 3: "H", 4: "I", 16: "Q"}
"""Of a TIFF's whole numbers, as `struct` calls them."""
MOST_TAGS, MOST_SAMPLES = 65_535, 16
"""Of a TIFF and of a pixel in one that are looked at; four samples are read."""

Shape = tuple[int, int, int]

_ORIENTATION, _BITS_PER_SAMPLE = 0x0112, 0x0102  # tags of EXIF and of TIFF


def read_picture(path: Path, non_finite: NonFinite = "error") -> np.ndarray:
    """A picture file as (h, w[, 3|4]) RGB(A), upright as its EXIF orientation says: uint8, uint16, or what it holds.

    A palette becomes colours, transparency a fourth channel. `.npy` and `.npz` files hold the array itself.
    non_finite: what becomes of NaN and infinity: an error, or, for `mask`, nothing: they are in what is returned.
    Raises: PictureError if the file is missing, no picture, damaged, cut short or too large.
    """
    return picture_of(_read(path), str(path), non_finite)


def picture_of(values: np.ndarray, name: str, non_finite: NonFinite = "error") -> np.ndarray:
    """An array as `read_picture` returns it. Raises: PictureError if it is no picture, or holds NaN or infinity."""
    if non_finite == "error":
        return check_picture(values, name)
    check_picture(np.nan_to_num(values), name)
    return values


def read_map(path: Path) -> Float32[np.ndarray, "h w"]:
    """A map of numbers (.npy, .npz, .pfm, .tif, or any grey picture as its raw values); infinities become NaN.

    Raises: PictureError as `read_picture`, or if there is more than one number a pixel.
    """
    return map_of(_read(path), str(path))


def map_of(values: np.ndarray, name: str) -> Float32[np.ndarray, "h w"]:
    """An array as `read_map` returns it. Raises: PictureError if there is more than one number a pixel."""
    if values.ndim == 3 and values.shape[2] in (3, 4) and not np.any(values[..., :3] != values[..., :1]):
        values = values[..., 0]
    if values.ndim != 2 or values.size == 0 or values.dtype.kind not in "buif":
        raise PictureError(f"{name}: a map is one number a pixel, (h, w), not {values.shape} of {values.dtype}")
    with np.errstate(over="ignore"):
        numbers = values.astype(np.float32)
    return np.where(np.isfinite(numbers), numbers, np.float32(np.nan))


def read_labels(path: Path) -> Int32[np.ndarray, "h w"]:
    """A label picture as 0..n-1, each of them present, in the order of its grey values, palette indices or colours.

    Raises: PictureError as `read_picture`, or if it holds too many labels to be a label picture.
    """
    return labels_of(_read(path, indices=True), str(path))


def labels_of(values: np.ndarray, name: str) -> Int32[np.ndarray, "h w"]:
    """An array as `read_labels` returns it. Raises: PictureError if it holds too many labels, or is no picture."""
    if values.ndim == 3 and values.dtype.kind == "u" and values.shape[2] <= 4:
        values = values.astype(np.uint64) @ (1 << 16 * np.arange(values.shape[2], dtype=np.uint64))
    if values.ndim != 2 or values.size == 0 or values.dtype.kind not in "buif":
        raise PictureError(f"{name}: a label picture has one label a pixel, not {values.shape} of {values.dtype}")
    check_finite(values, name)
    known, labels = np.unique(values, return_inverse=True)
    if known.size > MAX_LABELS:
        raise PictureError(
            f"{name}: holds {known.size} labels, at most {MAX_LABELS} are sensible; give each segment one flat colour "
            "and save it without loss, as PNG"
        )
    return labels.reshape(values.shape).astype(np.int32)


def _read(path: Path, indices: bool = False) -> np.ndarray:
    """The raw values of any file that holds an array; `indices` keeps those of a palette."""
    data = _read_bytes(path)
    if path.suffix.lower() in (".npy", ".npz"):
        return _array(path, data)
    return _picture(path, data, indices)


def _read_bytes(path: Path) -> bytes:
    try:
        data = read_bytes(path)
    except (FileNotFoundError, NotADirectoryError) as error:
        if not path.parent.is_dir():
            raise PictureError(f"{path}: there is no folder {path.parent}; check the path") from error
        near = did_you_mean(path.name, (each.name for each in path.parent.iterdir()))
        raise PictureError(f"{path}: there is no such file{near}") from error
    except OSError as error:
        raise PictureError(
            f"{path}: cannot be read: {error.strerror or error}; check the path and its permissions"
        ) from error
    if not data:
        raise PictureError(f"{path}: the file is empty; copy or download it again")
    return data


def _array(path: Path, data: bytes) -> np.ndarray:
    try:
        return arrays.read_array(BytesIO(data))
    except TooLarge as error:
        raise _too_large(path, error) from error
    except ValueError as error:
        raise PictureError(
            f"{path}: cannot be read as an array: {error}; save the one that is meant with numpy.save"
        ) from error


def _picture(path: Path, data: bytes, indices: bool) -> np.ndarray:
    """By Pillow, which says what is wrong with a file; by OpenCV where there are more bits than Pillow keeps."""
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of tags that it passes over
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            return _decoded(path, data, indices)
    except UnidentifiedImageError as error:
        raise PictureError(f"{path}: is no picture this program can read; use PNG, JPEG, TIFF, PFM or NPY") from error
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:  # Pillow's limit is above ours
        raise _too_large(path, TOO_MANY_PIXELS) from error
    except TooLarge as error:
        raise _too_large(path, error) from error
    except PictureError:
        raise
    except Exception as error:  # a damaged file can provoke any
        raise PictureError(
            f"{path}: the picture is damaged or cut short: {shown(str(error))}; copy or download it again"
        ) from error


def _too_large(path: Path, why: object) -> PictureError:
    return PictureError(f"{path}: {why}; make it smaller first")


def _decoded(path: Path, data: bytes, indices: bool) -> np.ndarray:
    from PIL import Image, UnidentifiedImageError

    if data[:4] in TIFF:
        check_size(*_tiff_size(data))  # Pillow does not look at tiles, which may be larger than the picture
    try:
        image = Image.open(BytesIO(data), formats=FORMATS)
    except UnidentifiedImageError:
        if data[:4] not in TIFF[:2]:
            raise
        return _picture_by_opencv(path, data)
    with image:
        check_size((image.height, image.width, len(image.getbands())), 4)
        image.load()
        values = _picture_by_opencv(path, data) if _is_deep_colour(image, data) else _values(image, indices)
        return np.ascontiguousarray(_upright(values, _orientation(image)))


def _is_deep_colour(image: "Image", data: bytes) -> bool:
    """Whether Pillow would cut 16 bits a channel down to 8."""
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


def _orientation(image: "Image") -> int:
    try:
        return image.getexif().get(_ORIENTATION, 1)
    except Exception as error:  # noqa: BLE001 - a picture is worth more than its damaged tags
        log.warning("EXIF tags are damaged (%s); the picture is taken as upright", error)
        return 1


def _upright(values: np.ndarray, orientation: int) -> np.ndarray:
    """Source: EXIF 2.3, tag 0x0112: where the picture's first row and column belong."""
    if orientation in (5, 6, 7, 8):
        values = values.swapaxes(0, 1)
    if orientation in (3, 4, 7, 8):
        values = values[::-1]
    if orientation in (2, 3, 6, 7):
        values = values[:, ::-1]
    return values


def _picture_by_opencv(path: Path, data: bytes) -> np.ndarray:
    """A PNG or a TIFF. What OpenCV decodes is not limited, so that headers are looked at before."""
    import cv2

    if data.startswith(b"\x89PNG"):
        check_size(*_png_size(data))
    log_level = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)  # what is wrong is said below, in one line
    try:
        values: np.ndarray | None = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        values = None
    finally:
        cv2.utils.logging.setLogLevel(log_level)
    if values is None:
        raise PictureError(f"{path}: the picture is damaged or of a rare kind; save it again as PNG or TIFF")
    if values.ndim == 3:
        values = cv2.cvtColor(values, cv2.COLOR_BGRA2RGBA if values.shape[2] == 4 else cv2.COLOR_BGR2RGB)
    return values


def _png_size(data: bytes) -> tuple[Shape, int]:
    """Shape and bytes a value at most, by the first chunk."""
    width, height = struct.unpack_from(">II", data, 16)
    return (height, width, 4), 2


def _tiff_size(data: bytes) -> tuple[Shape, int]:
    """Shape and bytes a value, by the tags of the first directory: the largest, where a tag is there twice.

    Source: TIFF 6.0, section 2 and 15 (tiles, which are decoded whole); BigTIFF, whose numbers have 8 bytes.
    """
    order, big = "<" if data[:2] == b"II" else ">", b"+" in data[2:4]
    first, many, place = ("Q", "Q", "Q") if big else ("I", "H", "I")
    (at,) = struct.unpack_from(order + first, data, 8 if big else 4)
    (count,) = struct.unpack_from(order + many, data, at)
    if count > MOST_TAGS:
        raise ValueError(f"its directory has {count} tags")
    at += struct.calcsize(many)
    said = {256: 1, 257: 1, 258: 1, 277: 1, 322: 1, 323: 1}
    for _ in range(count):
        tag, kind, number = struct.unpack_from(f"{order}HH{place}", data, at)
        at += struct.calcsize(f"{order}HH{place}")
        if tag in said:
            values = f"{order}{min(number, MOST_SAMPLES)}{TAG_TYPES[kind]}"
            short = struct.calcsize(values) <= struct.calcsize(place)
            found = struct.unpack_from(values, data, at if short else struct.unpack_from(order + place, data, at)[0])
            said[tag] = max(said[tag], *found)
        at += struct.calcsize(place)
    rows, columns = max(said[257], said[323]), max(said[256], said[322])
    return (rows, columns, said[277]), -(-said[258] // 8)

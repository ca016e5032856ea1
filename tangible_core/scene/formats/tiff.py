"""The first picture of a TIFF, by tifffile: the numbers as they are stored, and which of them are known.

Sources: TIFF 6.0 and its supplements; GDAL's tag 42113, the value for no data, and its masks, which are pages.
"""
# (tifffile's pages have tags of any kind)

import logging
from collections.abc import Generator, Iterator
from contextlib import contextmanager, suppress
from io import BytesIO
from itertools import islice, product
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
from jaxtyping import Bool

from ...files.reading import MAX_PIXELS, check_size

if TYPE_CHECKING:
    from tifffile import TiffFile, TiffPage

TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")  # the first bytes of a TIFF
MAX_PAGES = 100  # largest number of pages that are looked at
_REDUCED, _MASK = 1, 4  # bits of NewSubfileType
_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB, _PALETTE, _TRANSPARENCY, _YCBCR = 0, 1, 2, 3, 4, 6  # photometric interpretations
_JPEG = (6, 7, 34892)  # compressions
_COMPLEX = (5, 6)  # sample formats
_ALPHA = _ASSOCIATED, _UNASSOCIATED = 1, 2  # extra samples
_ORIENTATION, _EXTRA_SAMPLES, _GEO_KEYS, _NODATA = 274, 338, 34735, 42113  # tags


class UnreadableError(ValueError):
    """A picture is whole, but stored in a way that this program does not read; the message names the cure."""


class TiffRaster(NamedTuple):
    """The numbers of a picture, (h, w) or (h, w, channels), as they are stored."""

    values: np.ndarray
    known: Bool[np.ndarray, "h w"] | None = None  # false where a mask hides a pixel; None if there is no mask
    alpha: np.ndarray | None = None  # opacity, (h, w), in the numbers of the colours; None if there is none
    palette: np.ndarray | None = None  # colours of the numbers, (n, 3) of 16 bits; None without a palette
    white: int | None = None  # the number of full brightness; None for signed numbers and floating point
    zero_is_white: bool = False
    dropped: int = 0  # number of channels that are neither colours nor transparency, such as infrared


class TiffPicture(NamedTuple):
    """A picture of a TIFF: its bands of rows from top to bottom, and what its tags say."""

    bands: Iterator[TiffRaster]
    orientation: int  # orientation of the camera by EXIF, 1 to 8
    nodata: float | None  # GDAL's value for no data
    pages: int  # number of pictures in the file


@contextmanager
def open_tiff(source: Path | BytesIO) -> "Generator[TiffFile]":
    """Open a TIFF, without the library's remarks on it."""
    from tifffile import TiffFile, logger

    logger().setLevel(logging.CRITICAL)
    with TiffFile(cast(Any, source), _multifile=False) as file:
        yield file


def tiff_description(path: Path) -> bytes:
    """Read the description of a TIFF from its tags alone; empty if it has none, or cannot be read."""
    with suppress(Exception), open_tiff(path) as file:
        return _first(file).description.encode()
    return b""


def holds_heights(path: Path) -> bool:
    """Return True for a TIFF whose numbers are signed or floating point, or belong to places on earth."""
    with suppress(Exception), open_tiff(path) as file:
        page = _first(file)
        one_number = page.photometric in (_WHITE_IS_ZERO, _BLACK_IS_ZERO) and page.samplesperpixel == 1
        return one_number and (page.dtype is None or page.dtype.kind in "if" or _GEO_KEYS in page.tags)
    return False


@contextmanager
def tiff_picture(data: bytes, whole: bool = True) -> "Generator[TiffPicture | None]":
    """Open the first page that is neither a smaller copy nor a mask, whole with its mask, or in bands."""
    # None for eight bits of other colours (CMYK, L*a*b*), which another reader knows. UnreadableError, TooLargeError
    # and WholePieceError name what this program does not read; a damaged file may raise anything.
    with open_tiff(BytesIO(data)) as file:
        pages = [page.aspage() for page in islice(file.pages, MAX_PAGES)]
        page = next((page for page in pages if not page.subfiletype & (_REDUCED | _MASK)), pages[0])
        if _is_for_another_reader(page):
            yield None
            return
        _check(page, data)
        if whole:
            check_size(page.shape, page.dtype.itemsize if page.dtype else 1)
            values = page.asarray(squeeze=False, maxworkers=1)
            bands = iter([_raster(page, values, _mask(pages, page, data))])
        else:
            bands = (_raster(page, values, None) for values in _bands(page, data))
        orientation = page.tags.get(_ORIENTATION)
        yield TiffPicture(
            bands,
            orientation.value if orientation else 1,
            _nodata(page),
            max(1, sum(not other.subfiletype & (_REDUCED | _MASK) for other in pages)),
        )


def tiff_size(data: bytes) -> tuple[int, int]:
    """Return the rows and columns of the first page."""
    with open_tiff(BytesIO(data)) as file:
        page = _first(file)
        return page.imagelength, page.imagewidth


def _first(file: "TiffFile") -> "TiffPage":
    return file.pages.first


def _is_for_another_reader(page: "TiffPage") -> bool:
    known = page.photometric in (_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB, _PALETTE, _TRANSPARENCY)
    return page.bitspersample == 8 and not known and not (page.photometric == _YCBCR and page.compression in _JPEG)


def _check(page: "TiffPage", data: bytes) -> None:
    """Check what the tags announce before anything is decoded. Raises: as `tiff_picture`."""
    from tifffile import TIFF as KNOWN

    if page.dtype is None or page.dtype.kind not in "buif" or page.imagedepth != 1:
        kind = "complex numbers" if page.sampleformat in _COMPLEX else "numbers"
        raise UnreadableError(
            f"holds {kind} of {page.bitspersample} bits, which cannot be read; save it with 8, 16 or 32 bits a value"
        )
    if page.photometric not in (_WHITE_IS_ZERO, _BLACK_IS_ZERO, _RGB, _PALETTE, _TRANSPARENCY, _YCBCR):
        raise UnreadableError("holds colours that cannot be read; save it as RGB")
    if page.compression not in KNOWN.DECOMPRESSORS or page.predictor not in KNOWN.UNPREDICTORS:
        raise UnreadableError("is compressed in a way that cannot be read; save it with LZW, or without compression")
    pixels = (max(page.tilelength, 1), max(page.tilewidth, 1))  # tiles are decoded whole
    check_size((*pixels, page.samplesperpixel), page.dtype.itemsize)
    places = zip(page.dataoffsets, page.databytecounts, strict=False)
    if any(at + length > len(data) for at, length in places):
        raise ValueError("its end is missing")


def _mask(pages: "list[TiffPage]", page: "TiffPage", data: bytes) -> Bool[np.ndarray, "h w"] | None:
    """Read the page that says which pixels belong to the picture; None if there is none."""
    size = page.imagelength, page.imagewidth
    masks = (other for other in pages if other.subfiletype & _MASK and not other.subfiletype & _REDUCED)
    mask = next((other for other in masks if (other.imagelength, other.imagewidth) == size), None)
    if mask is None:
        return None
    _check(mask, data)
    check_size(mask.shape, 1)
    return mask.asarray(squeeze=False, maxworkers=1)[0, 0, :, :, 0] != 0


def _nodata(page: "TiffPage") -> float | None:
    tag = page.tags.get(_NODATA)
    with suppress(ValueError):
        return float(str(tag.value)) if tag else None
    return None


def _raster(page: "TiffPage", stored: np.ndarray, known: Bool[np.ndarray, "h w"] | None) -> TiffRaster:
    """Sort the channels of stored numbers, (planes, 1, h, w, samples). Raises: UnreadableError."""
    samples = np.moveaxis(stored[:, 0], 0, 2).reshape(*stored.shape[2:4], -1)
    channels = samples.shape[2]
    grey = page.photometric in (_WHITE_IS_ZERO, _BLACK_IS_ZERO, _TRANSPARENCY, _PALETTE)
    extra: tuple[int, ...] = tuple(page.extrasamples)[: channels - (1 if grey else 3)]
    if _EXTRA_SAMPLES not in page.tags and not grey and channels == 4:
        extra = (_UNASSOCIATED,)  # as OpenCV writes transparency
    alpha = next((kind for kind in extra if kind in _ALPHA), None)
    opacity = None if alpha is None else samples[..., channels - len(extra) + extra.index(alpha)]
    colours = channels - sum(kind in _ALPHA for kind in extra)
    if (
        grey and page.photometric == _BLACK_IS_ZERO and colours in (3, 4)
    ):  # as programs write three bands without a name
        grey = False
    if grey and colours > 2:
        raise UnreadableError(
            f"holds {colours} channels and does not say which are red, green and blue; save one, or three as RGB"
        )
    colour_count = 1 if grey else 3
    values = samples[..., 0] if grey else samples[..., :3]
    is_unsigned = values.dtype.kind in "bu"
    if opacity is not None and alpha == _ASSOCIATED and is_unsigned:
        values = _divide_by_alpha(values, opacity, (1 << page.bitspersample) - 1)
    return TiffRaster(
        np.ascontiguousarray(values),
        known,
        opacity,
        None if page.colormap is None or page.photometric != _PALETTE else page.colormap.T,
        (1 << page.bitspersample) - 1 if is_unsigned else None,
        page.photometric == _WHITE_IS_ZERO,
        colours - colour_count,
    )


def _divide_by_alpha(values: np.ndarray, alpha: np.ndarray, white: int) -> np.ndarray:
    """Return colours that were multiplied by their opacity as they were before; black where nothing was left."""
    opacity = alpha.astype(np.uint64) if values.ndim == 2 else alpha.astype(np.uint64)[..., None]
    whole = (values.astype(np.uint64) * white + opacity // 2) // np.maximum(opacity, 1)
    return np.where(opacity == 0, values, np.minimum(whole, white)).astype(values.dtype)


def _bands(page: "TiffPage", data: bytes) -> Iterator[np.ndarray]:
    """Yield the stored numbers of a page in bands of rows, (planes, 1, rows, columns, samples)."""
    from .bands import BAND_PIXELS, WholePieceError

    planes, _, rows, columns, samples = page.shaped
    dtype = cast("np.dtype[Any]", page.dtype)
    if page.is_contiguous and not page.is_tiled:
        numbers = np.frombuffer(data, dtype.newbyteorder(page.parent.byteorder), page.size, page.dataoffsets[0])
        whole, high = numbers.reshape(page.shaped), max(1, BAND_PIXELS // columns)
        yield from (whole[:, :, top : top + high].astype(dtype) for top in range(0, rows, high))
        return
    high, wide = (page.tilelength, page.tilewidth) if page.is_tiled else (min(rows, page.rowsperstrip), columns)
    if high * columns > MAX_PIXELS:
        raise WholePieceError("save it in strips or in tiles, or as PNG")
    together = max(1, BAND_PIXELS // (columns * high)) * high
    tables = {"jpegtables": page.jpegtables, "jpegheader": page.jpegheader} if page.compression in _JPEG else {}
    for top in range(0, rows, together):
        band = np.full((planes, 1, min(together, rows - top), columns, samples), page.nodata, dtype)
        for plane, down, right in product(range(planes), range(0, band.shape[2], high), range(0, columns, wide)):
            index = (plane * -(-rows // high) + (top + down) // high) * -(-columns // wide) + right // wide
            at, length = page.dataoffsets[index], page.databytecounts[index]
            piece = page.decode(data[at : at + length] or None, index, **tables)[0]
            if piece is not None:  # else it is left out, as all of it is without data
                place = band[plane, :, down : down + high, right : right + wide]
                place[:, : piece.shape[1]] = piece[:, : place.shape[1], : place.shape[2]]
        yield band

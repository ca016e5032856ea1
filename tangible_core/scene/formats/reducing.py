"""Pictures with more pixels than fit, decoded at a half, a quarter or an eighth of their sides."""

from io import BytesIO
from pathlib import Path

import numpy as np

from ...errors import PictureError
from ...files.reading import MAX_PIXELS, TOO_MANY_PIXELS, check_size
from .decoding import decode_plain, image_values, meaning, orientation, picture_errors, png_size, upright
from .kinds import JPEG, PNG
from .multi_picture import Notify, ignore
from .tiff import TIFF, tiff_picture, tiff_size

# The most pixels of a picture that is reduced while it is decoded: more would take minutes.
MAX_REDUCED = 10 * MAX_PIXELS


def decode_reduced(path: Path, data: bytes, notify: Notify = ignore) -> np.ndarray | None:
    """Decode a too large JPEG, PNG or TIFF at a half, a quarter or an eighth of its sides; None for another file."""
    # The whole picture is never in memory: the decoder of JPEG leaves out the finer waves of each block, and a PNG or
    # TIFF is decoded in bands of rows.
    with picture_errors(path):
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
        return np.ascontiguousarray(upright(image_values(image, "picture"), orientation(image)))


def _reduced_bands(path: Path, data: bytes, notify: Notify) -> np.ndarray | None:
    shape = png_size(data) if data[:8] == PNG else tiff_size(data)
    times = _times(*shape)
    if times is None:
        return None
    from .bands import WholePieceError, png_bands, reduced

    _notify_reduced(path, *shape, times, notify)
    try:
        if data[:8] != PNG:
            with tiff_picture(data, whole=False) as picture:
                if picture is None:
                    return None
                bands = (meaning(band, "picture", picture.nodata) for band in picture.bands)
                return np.ascontiguousarray(upright(reduced(bands, *shape, times), picture.orientation))
        orientation, files = png_bands(data)
        pictures = (decode_plain(path, band, "picture", ignore, 0) for band in files)
        return np.ascontiguousarray(upright(reduced(pictures, *shape, times), orientation))
    except WholePieceError as error:
        raise PictureError(f"{path}: {TOO_MANY_PIXELS} and cannot be reduced while it is read; {error}") from error


def _times(rows: int, columns: int) -> int | None:
    """Return the factor by which the sides of a picture are reduced; None if it is not too large, or much too large."""
    if not MAX_PIXELS < columns * rows <= MAX_REDUCED:
        return None
    return next((times for times in (2, 4, 8) if -(-rows // times) * -(-columns // times) <= MAX_PIXELS), None)


def _notify_reduced(path: Path, rows: int, columns: int, times: int, notify: Notify) -> None:
    notify(
        f"{path.name} has {columns * rows / 1e6:.0f} megapixels; it is reduced to {-(-columns // times)} x "
        f"{-(-rows // times)} pixels while it is read"
    )

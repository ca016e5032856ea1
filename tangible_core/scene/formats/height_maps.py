"""Height maps in millimetres: a picture, and metadata that state its size, so that heights and widths are kept.

The metadata are a JSON text: a file next to a PNG of 16 bits, or tag 270 (ImageDescription) of a floating-point TIFF.
"""

import json
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, cast

import numpy as np
from jaxtyping import Float32, UInt16
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...data import Relief
from ...data.pictures import size_in_words
from ...errors import PictureError, quoted
from ...files.reading import MAX_TEXT_BYTES, read_bytes
from .multi_picture import Notify, ignore
from .tiff import tiff_description

FORMATS = "tangible heights "
FORMAT = "tangible heights 1"
LEVELS = 0xFFFF  # number of the highest place in a picture of 16 bits
BYTE = 0xFF
MM = 1000.0
"""Millimetres in a metre."""
Millimetres = Annotated[float, Field(gt=0, le=10 * MM, allow_inf_nan=False)]
Height = Annotated[float, Field(ge=0, le=10 * MM, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1)]


class HeightsMetadata(BaseModel):
    """The meaning of a picture's numbers: the height of a number is `low_mm` plus `step_mm` times the number."""

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True)

    format: Literal["tangible heights 1"] = FORMAT
    title: str = ""
    language: str = "en"
    file: str
    """Name of the picture."""
    exact: str = ""
    """Name of a TIFF with the same heights next to the picture; empty if there is none, or if the picture is it."""
    columns: Count
    rows: Count
    width_mm: Millimetres
    length_mm: Millimetres
    high_mm: Height
    """Height of the highest place."""
    low_mm: Height
    """Height of the number 0."""
    step_mm: Height
    """Height between one number and the next."""

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.columns

    @property
    def size(self) -> "MeasuredSize":
        """The size in metres."""
        return MeasuredSize(self.width_mm / MM, self.length_mm / MM, self.high_mm / MM)


class MeasuredSize(NamedTuple):
    """The size that a height map states, metres."""

    width_m: float
    length_m: float
    # Height of the highest place above the base; None for a map of the ground, which is felt smaller than it is.
    high_m: float | None
    unit_m: float = 1.0  # metres that one number of the heights is


def levels(relief: Relief) -> tuple[UInt16[np.ndarray, "h w"], float, float]:
    """Return the heights as numbers of 16 bits, the lowest as 0, the highest as `LEVELS`; `low_mm` and `step_mm`."""
    heights_mm = relief.height_m.astype(np.float64) * MM
    low_mm, high_mm = float(heights_mm.min()), float(heights_mm.max())
    step_mm = (high_mm - low_mm) / LEVELS
    numbers = np.rint((heights_mm - low_mm) / step_mm) if step_mm else np.zeros(heights_mm.shape)
    return numbers.astype(np.uint16), low_mm, step_mm


def read_heights_metadata(path: Path) -> HeightsMetadata | None:
    """Read the metadata of a height map: those in a JSON text or a TIFF, or in the JSON text next to a PNG.

    Returns: None if there are none, or if the file cannot be read, which the reader of its picture reports.
    Raises: PictureError for metadata with wrong values.
    """
    kind = path.suffix.lower()
    try:
        if kind == ".json":
            return _parse(read_bytes(path, MAX_TEXT_BYTES), path)
        if kind == ".png":
            metadata = metadata_beside(path)
            return metadata if metadata is not None and metadata.file == path.name else None
        if kind in (".tif", ".tiff"):
            return _parse(tiff_description(path), path)
    except OSError:
        return None
    return None


def metadata_beside(path: Path) -> HeightsMetadata | None:
    """Read the metadata in the JSON text beside a picture, whatever picture they describe. Raises: PictureError."""
    text_path = path.with_suffix(".json")
    try:
        return _parse(read_bytes(text_path, MAX_TEXT_BYTES), text_path)
    except OSError:
        return None


def find_picture(path: Path, metadata: HeightsMetadata) -> tuple[Path, HeightsMetadata]:
    """Return the picture of a JSON text, the exact one if it is there, with its metadata. Raises: PictureError."""
    if path.suffix.lower() != ".json":
        return path, metadata
    for name in filter(None, (metadata.exact, metadata.file)):
        if Path(name).name != name:
            raise PictureError(f"{path}: names the picture {quoted(name)}; it must be a file next to this one")
    exact = path.with_name(metadata.exact) if metadata.exact else path
    if exact != path and exact.is_file() and (own := read_heights_metadata(exact)) is not None:
        return exact, own
    return path.with_name(metadata.file), metadata


def in_metres(
    numbers: np.ndarray, metadata: HeightsMetadata, path: Path, notify: Notify = ignore
) -> Float32[np.ndarray, "h w"]:
    """Convert a picture's numbers to heights. Raises: PictureError if they cannot be those of the metadata."""
    if numbers.shape != (metadata.rows, metadata.columns):
        raise PictureError(
            f"{path}: is {size_in_words(numbers)}, but its metadata state {metadata.columns} x {metadata.rows}; "
            "export the heights again, or remove the metadata"
        )
    top = numbers.max(initial=0, where=np.isfinite(numbers))
    wide = (metadata.high_mm - metadata.low_mm) > (LEVELS - 1) * metadata.step_mm > 0  # as `levels` makes them
    times = LEVELS // BYTE if wide and top <= BYTE else 1
    if times > 1:
        step_mm = times * metadata.step_mm
        notify(f"{path.name} has 8 bits, and was exported with 16: its heights are in steps of {step_mm:.2g} mm")
    heights_mm = numbers.astype(np.float64) * times * metadata.step_mm + metadata.low_mm
    high_mm, fine_mm = float(top) * times * metadata.step_mm + metadata.low_mm, 1e-3 * metadata.high_mm
    if high_mm > metadata.high_mm + fine_mm or (metadata.step_mm == 1 and high_mm < metadata.high_mm - fine_mm):
        raise PictureError(
            f"{path}: its highest place is {high_mm:.4g} mm, but its metadata state {metadata.high_mm:.4g} mm: another "
            "program has changed its numbers; export the heights again, or remove the metadata"
        )
    if high_mm < metadata.high_mm - fine_mm:
        notify(f"{path.name} was changed: its highest place is {high_mm:.4g} mm, and was {metadata.high_mm:.4g} mm")
    return (heights_mm / MM).astype(np.float32)


def _parse(text: bytes, path: Path) -> HeightsMetadata | None:
    """Parse metadata; None for any other text. Raises: PictureError."""
    try:
        plain = json.loads(text)
    except (ValueError, RecursionError) as error:
        if FORMATS.encode() not in text or path.suffix.lower() != ".json":
            return None
        raise PictureError(
            f"{path}: was changed and is not JSON any more: {error}; export the heights again"
        ) from error
    if not isinstance(plain, dict) or not str(cast("dict[Any, Any]", plain).get("format")).startswith(FORMATS):
        return None
    try:
        return HeightsMetadata.model_validate(plain)
    except ValidationError as error:
        first = error.errors()[0]
        place, what = ".".join(map(str, first["loc"])), first["msg"]
        raise PictureError(f"{path}: {place}: {what}; export the heights again") from error

"""Heights in millimetres: a picture, and what its numbers mean, so that it is read as high and as wide as it was.

The meaning is a JSON text. It stands in a file of its own beside a PNG of 16 bits, and in a TIFF of floating-point
numbers itself (tag 270, ImageDescription).
"""

import json
import mmap
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, cast

import numpy as np
from jaxtyping import Float32, UInt16
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ...data import Relief
from ...data.pictures import size_in_words
from ...errors import PictureError, quoted
from ...files.reading import MOST_TEXT_BYTES, check_file, read_bytes
from .tiff_tags import TIFF, stated_description

FORMATS = "tangible heights "
FORMAT = "tangible heights 1"
LEVELS = 0xFFFF
"""The number of the highest place in a picture of 16 bits."""
MM = 1000.0
"""In a metre."""
Millimetres = Annotated[float, Field(gt=0, le=10 * MM, allow_inf_nan=False)]
Height = Annotated[float, Field(ge=0, le=10 * MM, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=1)]


class HeightsSaid(BaseModel):
    """What the numbers of a picture mean: a height is `low_mm` and `step_mm` for each 1."""

    model_config = ConfigDict(frozen=True)

    format: Literal["tangible heights 1"] = FORMAT
    title: str = ""
    language: str = "en"
    file: str
    """The picture."""
    exact: str = ""
    """A TIFF of the same heights, beside the picture; empty where there is none, and where the picture is that one."""
    columns: Count
    rows: Count
    width_mm: Millimetres
    length_mm: Millimetres
    high_mm: Height
    """Of the highest place."""
    low_mm: Height
    """What the number 0 stands for."""
    step_mm: Height
    """How much higher the next number is."""

    @property
    def measured(self) -> "Measured":
        """The size, in metres."""
        return Measured(self.width_mm / MM, self.length_mm / MM, self.high_mm / MM)


class Measured(NamedTuple):
    """The size that a height map says it has, metres."""

    width_m: float
    length_m: float
    high_m: float


def levels(relief: Relief) -> tuple[UInt16[np.ndarray, "h w"], float, float]:
    """The heights as numbers of 16 bits, the lowest as 0 and the highest as `LEVELS`; with `low_mm` and `step_mm`."""
    heights_mm = relief.height_m.astype(np.float64) * MM
    low_mm, high_mm = float(heights_mm.min()), float(heights_mm.max())
    step_mm = (high_mm - low_mm) / LEVELS
    numbers = np.rint((heights_mm - low_mm) / step_mm) if step_mm else np.zeros(heights_mm.shape)
    return numbers.astype(np.uint16), low_mm, step_mm


def said_of(path: Path) -> HeightsSaid | None:
    """What is said of the heights in a file: by itself, if it is a JSON text or a TIFF; by the JSON text beside a PNG.

    None where nothing is, and for a file that cannot be read, of which its reader complains.
    Raises: PictureError for a text that is to say it, and says nonsense.
    """
    kind = path.suffix.lower()
    try:
        if kind == ".json":
            return _parsed(read_bytes(path, MOST_TEXT_BYTES), path)
        if kind == ".png":
            beside = path.with_suffix(".json")
            said = _parsed(read_bytes(beside, MOST_TEXT_BYTES), beside)
            return said if said is not None and said.file == path.name else None
        if kind in (".tif", ".tiff"):
            return _parsed(_description(path), path)
    except OSError:
        return None
    return None


def picture_said(path: Path, said: HeightsSaid) -> tuple[Path, HeightsSaid]:
    """The picture that a JSON text speaks of, the exact one if it is there; with what is said of that.

    Raises: PictureError for one that is not beside the text.
    """
    if path.suffix.lower() != ".json":
        return path, said
    for name in filter(None, (said.exact, said.file)):
        if Path(name).name != name:
            raise PictureError(f"{path}: names the picture {quoted(name)}; it must be a file beside this one")
    exact = path.with_name(said.exact) if said.exact else path
    if exact != path and exact.is_file() and (its := said_of(exact)) is not None:
        return exact, its
    return path.with_name(said.file), said


def in_metres(numbers: np.ndarray, said: HeightsSaid, path: Path) -> Float32[np.ndarray, "h w"]:
    """The heights that the numbers of a picture stand for. Raises: PictureError if it is of another size than said."""
    if numbers.shape != (said.rows, said.columns):
        raise PictureError(
            f"{path}: is {size_in_words(numbers)}, and is said to be {said.columns} x {said.rows}; export the heights "
            "again, or take the text away from it"
        )
    return ((numbers.astype(np.float64) * said.step_mm + said.low_mm) / MM).astype(np.float32)


def _description(path: Path) -> bytes:
    """Of a TIFF, by its tags alone. Raises: OSError."""
    check_file(path)
    with path.open("rb") as file:
        try:
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
                return stated_description(data) if data[:4] in TIFF else b""
        except ValueError:  # it is empty
            return b""


def _parsed(text: bytes, path: Path) -> HeightsSaid | None:
    """Raises: PictureError."""
    try:
        plain = json.loads(text)
    except (ValueError, RecursionError):
        return None
    if not isinstance(plain, dict) or not str(cast("dict[Any, Any]", plain).get("format")).startswith(FORMATS):
        return None
    try:
        return HeightsSaid.model_validate(plain)
    except ValidationError as error:
        first = error.errors()[0]
        place, what = ".".join(map(str, first["loc"])), first["msg"]
        raise PictureError(f"{path}: {place}: {what}; export the heights again") from error

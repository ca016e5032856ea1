"""What networks see in one photograph."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32

from ..errors import PictureError
from .arguments import named_fields
from .records import Record
from .views import PartMap

IS_FIGURE = 0.5  # least value of the figure's map at a pixel of the figure


@named_fields
@dataclass(frozen=True, eq=False)
class Figure(Record):
    """The figure of a photograph, its borders and its faces, each as far as there is a network for it.

    figure: float32 (h, w) in 0..1, how surely a pixel belongs to what stands out from its ground; None without a
    network. borders: float32 (h, w) in 0..1, how surely people would draw a border there; None without a network.
    faces_px: float32 (n, 468, 3), the points of each face: column and row in pixels, and nearness in pixels of the
    same size, larger is nearer; empty where there is no face, or no network.
    Raises: PictureError for maps of two sizes.
    """

    figure: Float32[np.ndarray, "h w"] | None = None
    borders: Float32[np.ndarray, "h w"] | None = None
    faces_px: Float32[np.ndarray, "n 468 3"] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.figure is not None and self.borders is not None and self.figure.shape != self.borders.shape:
            raise PictureError(f"a figure of {self.figure.shape} and borders of {self.borders.shape} are of two sizes")

    @property
    def faces(self) -> Float32[np.ndarray, "n 468 3"]:
        """The points of each face; (0, 468, 3) without one."""
        return np.zeros((0, 468, 3), np.float32) if self.faces_px is None else self.faces_px

    @property
    def people(self) -> int:
        """The number of people that are known to be in front: faces, where there is a figure."""
        return len(self.faces) if self.figure is not None and (self.figure >= IS_FIGURE).any() else 0

    def is_figure(self, shape: tuple[int, int]) -> Bool[np.ndarray, "r c"]:
        """Return the mask of the figure on a grid of another size; no pixel is one without a network."""
        if self.figure is None:
            return np.zeros(shape, np.bool_)
        row, column = ((2 * np.arange(n) + 1) * own // (2 * n) for n, own in zip(shape, self.figure.shape, strict=True))
        return self.figure[np.ix_(row, column)] >= IS_FIGURE

    def front_parts(self, parts: PartMap) -> tuple[int, ...]:
        """Return the numbers of the parts that are mostly figure, in order."""
        flat = parts.labels.reshape(-1)
        inside = np.bincount(flat[self.is_figure(parts.labels.shape).reshape(-1)], minlength=parts.count)
        return tuple(np.flatnonzero(2 * inside > np.bincount(flat, minlength=parts.count)).tolist())

"""What networks see in one photograph."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from ..errors import PictureError
from .arguments import named_fields
from .records import Record


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

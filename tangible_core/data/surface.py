"""Surfaces that can be touched: heights, materials and both together, in metres and newtons."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from math import sqrt
from typing import Literal, get_args, overload

import numpy as np
from jaxtyping import Float32, Float64, Int32
from numpy.typing import ArrayLike

from ..errors import GeometryError, MaterialError, PictureError, did_you_mean, quoted
from .arguments import as_array, as_number, named_fields
from .interpolation import bilinear
from .pictures import check_finite, size_in_words
from .records import Record

Texture = Literal["smooth", "periodic", "stochastic", "stick-slip", "drag"]
TEXTURES: tuple[Texture, ...] = get_args(Texture)
# Difference of heights below which a relief is flat: a third of what a Falcon resolves.
FLAT_M = 1e-5


@named_fields
@dataclass(frozen=True, eq=False)
class Relief(Record):
    """The heights of a surface: float32 (h, w) metres >= 0 over extent_m = (width, length) metres.

    Each height stands for one of h x w equal cells, at its centre.
    Raises: GeometryError if a height is not finite or negative, or the extent is not positive.
    """

    height_m: Float32[np.ndarray, "h w"]
    extent_m: tuple[float, float]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.height_m.ndim != 2 or self.height_m.size == 0:
            raise GeometryError(f"heights must be (h, w) with at least one cell, not {self.height_m.shape}")
        if not (0 < self.extent_m[0] < np.inf and 0 < self.extent_m[1] < np.inf):
            raise GeometryError(f"a surface needs a positive width and length in metres, not {self.extent_m}")
        try:
            check_finite(self.height_m, "height_m")
        except PictureError as error:
            raise GeometryError(str(error)) from error
        if float(self.height_m.min()) < 0:
            raise GeometryError(
                f"heights must be >= 0 above the base plane, but the lowest is {self.height_m.min():g} m; shift them up"
            )

    @property
    def pitch_m(self) -> tuple[float, float]:
        """The width and length of one cell, metres."""
        rows, columns = self.height_m.shape
        return self.extent_m[0] / columns, self.extent_m[1] / rows

    @property
    def is_flat(self) -> bool:
        """True if nothing stands out that can be felt."""
        return float(np.ptp(self.height_m)) < FLAT_M


@named_fields
@dataclass(frozen=True)
class Material:
    """The properties by which a segment feels; `source` is their reference, or says that they are a guess."""

    name: str
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    static_friction: float
    dynamic_friction: float
    roughness_m: float = 0.0
    """The amplitude of the fine texture; for a texture of many waves, that of one wave of the same power."""
    grain_m: float = 0.001
    """The wavelength of the fine texture."""
    texture: Texture = "stochastic"
    """The model of the fine texture (see `haptic_textures`)."""
    direction_deg: float = 0.0
    """The direction of the texture's lines: 0 along x, 90 along y."""
    anisotropy: float = 0.0
    """The share of lines: 0 is the same in all directions (periodic: two crossed sets of lines), 1 is lines only."""
    irregularity: float = 0.0
    """The share of a periodic texture's power that deviates from strict repetition."""
    drag_n_s_per_m: float = 0.0
    """The lateral force that opposes one metre per second, in contact."""
    seed: int = 0
    """The seed of the random texture: another seed gives another specimen of the same material."""
    source: str = ""

    def __post_init__(self) -> None:
        for name in (field.name for field in fields(self) if field.type in (float, int)):
            value = as_number(f"material {quoted(self.name)}: {name}", getattr(self, name))
            if not 0 <= value < np.inf:
                raise MaterialError(f"material {quoted(self.name)}: {name} is {value}; it must be >= 0 and finite")
        if wrong := next(self._contradictions(), None):
            raise MaterialError(f"material {quoted(self.name)}: {wrong}")

    def _contradictions(self) -> Iterator[str]:
        """Yield a sentence for each contradiction between the values."""
        if self.stiffness_n_per_m == 0 or self.grain_m == 0:
            yield "stiffness_n_per_m and grain_m must be above 0"
        if self.dynamic_friction > self.static_friction:
            yield (
                f"dynamic_friction {self.dynamic_friction} is above static_friction {self.static_friction}; "
                "sliding takes no more force than starting"
            )
        if self.anisotropy > 1 or self.irregularity > 1:
            yield f"anisotropy {self.anisotropy} and irregularity {self.irregularity} are at most 1"
        if self.texture not in TEXTURES:
            hint = did_you_mean(self.texture, TEXTURES)
            yield f"no texture model is named {quoted(self.texture)}{hint}; there are {', '.join(TEXTURES)}"
        if self.texture == "smooth" and self.roughness_m > 0:
            yield f"texture is smooth and roughness_m {self.roughness_m:g}; make that 0, or the texture stochastic"
        if self.texture == "stick-slip" and self.dynamic_friction == 0:
            yield "texture stick-slip needs a dynamic_friction above 0"
        if self.texture == "drag" and self.drag_n_s_per_m == 0:
            yield "texture drag needs a drag_n_s_per_m above 0"


@named_fields
@dataclass(frozen=True, eq=False)
class MaterialMap(Record):
    """The material of each segment, and the reason for each choice."""

    materials: tuple[Material, ...]
    reasons: tuple[str, ...]


@named_fields
@dataclass(frozen=True, eq=False)
class HapticSurface(Record):
    """The surface that a force law renders: the relief and, where the scene has them, a material for each label.

    A pipeline makes one as its product `surface`; make one yourself to feel heights of your own.

    >>> import numpy as np
    >>> HapticSurface(Relief(np.zeros((8, 16), np.float32), (0.08, 0.04))).extent_m
    (0.08, 0.04)

    names: the name of each part, "" for a part without a name; None if the labels are not those of parts.
    Raises: GeometryError if labels and heights differ in size, MaterialError if a label has no material or no name.
    """

    relief: Relief
    labels: Int32[np.ndarray, "h w"] | None = None
    materials: tuple[Material, ...] | None = None
    names: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.labels is None:
            return
        if self.labels.shape != self.height_m.shape:
            raise GeometryError(
                f"labels are {size_in_words(self.labels)}, heights {size_in_words(self.height_m)}; resize one of them"
            )
        low, high = int(self.labels.min()), int(self.labels.max())
        if low < 0 or (self.materials is not None and high >= len(self.materials)):
            raise MaterialError(f"labels run from {low} to {high}; there are {len(self.materials or ())} materials")
        if self.names is not None and high >= len(self.names):
            raise MaterialError(f"labels run from {low} to {high}; there are {len(self.names)} names of parts")

    @classmethod
    def from_heights(
        cls,
        height_m: np.ndarray,
        width_m: float = 0.08,
        labels: Int32[np.ndarray, "h w"] | None = None,
        materials: tuple[Material, ...] | None = None,
    ) -> "HapticSurface":
        """Return a surface of square cells from (h, w) heights in metres, width_m metres wide.

        Raises: GeometryError as `Relief`, MaterialError as the class.
        """
        height_m = as_array("height_m", height_m)
        if height_m.ndim != 2 or height_m.size == 0:
            raise GeometryError(f"heights must be (h, w) with at least one cell, not {height_m.shape}")
        as_number("width_m", width_m)
        rows, columns = height_m.shape
        relief = Relief(np.ascontiguousarray(height_m, np.float32), (width_m, width_m * rows / columns))
        return cls(relief, labels, materials)

    @overload
    def height_at(self, x_m: float, y_m: float) -> float: ...
    @overload
    def height_at(self, x_m: "ArrayLike", y_m: "ArrayLike") -> Float64[np.ndarray, "..."] | float: ...
    def height_at(self, x_m: "ArrayLike", y_m: "ArrayLike") -> Float64[np.ndarray, "..."] | float:
        """Return the height at points over the surface, metres; NaN beyond its extent, where there is free air.

        x_m, y_m: metres from the centre, x to the right, y away from the user, numbers or arrays of one shape, which
        the result has. Between the centres of the cells the height is bilinear, exactly as in the force law
        `penalty-gradient`. A law on a smooth spline, such as `proxy`, the default, has the same heights at the centres;
        between them it differs by up to an eighth of the curvature times the square of the pitch, along x and along y
        together. Its spline is eased at steps, where it passes the centres by up to a third of
        the step, and smooths heights of few levels.
        A call with two numbers takes a few microseconds, and may stand in the loop.
        Raises: ArgumentError for values that are not numbers.
        """
        return bilinear(self.height_m, self.extent_m, x_m, y_m)[0]

    def normal_at(self, x_m: "ArrayLike", y_m: "ArrayLike") -> Float64[np.ndarray, "... 3"]:
        """Return the unit normals (x, y, z) at points over the surface, upwards; NaN beyond its extent.

        x_m, y_m: as for `height_at`, whose exact gradient they are perpendicular to; the result has one more axis, of
        three. The slope of a smooth spline differs by up to half of the curvature times the pitch.
        Raises: ArgumentError for values that are not numbers.
        """
        _, across, along = bilinear(self.height_m, self.extent_m, x_m, y_m)
        if isinstance(across, float):
            length = sqrt(1 + across * across + along * along)
            return np.array((-across / length, -along / length, 1 / length))
        length = np.sqrt(1 + across**2 + along**2)
        return np.stack([-across, -along, np.ones_like(across)], axis=-1) / length[..., None]

    @property
    def height_m(self) -> Float32[np.ndarray, "h w"]:
        """The heights above the base plane, metres."""
        return self.relief.height_m

    @property
    def extent_m(self) -> tuple[float, float]:
        """The width and length, metres."""
        return self.relief.extent_m

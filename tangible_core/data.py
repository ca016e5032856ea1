"""What travels between stages: frozen records of read-only arrays, and the servo's tuples.

Frames. The picture frame is (column, row) in pixels, pixel centres at whole numbers. The workspace frame is metres,
right-handed, x right, y away from the user (the picture's top row is far), z up; its origin is the centre of the
picture on the base plane.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from enum import IntFlag
from typing import Any, Literal, NamedTuple, cast, get_args

import numpy as np
import xxhash
from jaxtyping import Float32, Int32

from .errors import GeometryError, MaterialError, PictureError, did_you_mean, quoted
from .pictures import check_finite, check_picture

Kind = Literal["depth", "texture", "render", "device"]
Texture = Literal["smooth", "periodic", "stochastic", "stick-slip", "drag"]
TEXTURES: tuple[Texture, ...] = get_args(Texture)
"""The models of a material's fine texture."""


class Force(NamedTuple):
    """Newtons in the workspace frame, on the user's hand."""

    x: float
    y: float
    z: float


NO_FORCE = Force(0.0, 0.0, 0.0)


class HapticState(NamedTuple):
    """Where the device's tip is: metres, metres per second and seconds, in the workspace frame."""

    position_m: tuple[float, float, float]
    velocity_m_per_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    time_s: float = 0.0
    buttons: int = 0
    """One bit a button."""


class Record:
    """Base of the frozen records: read-only arrays and a digest of the content.

    A record keeps read-only views of the arrays it is given, not copies: whoever made them leaves them alone.
    """

    def __post_init__(self) -> None:
        for name, value in _items(self):
            if isinstance(value, np.ndarray):
                view = cast(np.ndarray, value).view()
                view.flags.writeable = False
                object.__setattr__(self, name, view)

    def digest(self) -> str:
        """XXH3-128 of the content, the same in every process; records of equal content have equal digests."""
        return digest_of(self)


def digest_of(value: Any) -> str:
    """XXH3-128 of a record, an array, or plain values and tuples of these; far faster than a cryptographic hash."""
    state = xxhash.xxh3_128()
    _feed(state, value)
    return state.hexdigest()


def _feed(state: Any, value: Any) -> None:
    if isinstance(value, np.ndarray):
        array = cast(np.ndarray, value)
        state.update(f"array{array.shape}{array.dtype.str}".encode())
        state.update(np.ascontiguousarray(array).data)
    elif is_dataclass(value):
        state.update(type(value).__name__.encode())
        for name, part in _items(value):
            state.update(f"/{name}=".encode())
            _feed(state, part)
    elif isinstance(value, tuple):
        state.update(f"tuple{len(value)}".encode())  # pyright: ignore[reportUnknownArgumentType]
        for part in value:  # pyright: ignore[reportUnknownVariableType]
            _feed(state, part)
    else:
        state.update(f"{type(value).__name__}:{value!r};".encode())


def _items(record: Any) -> Iterator[tuple[str, Any]]:
    return ((f.name, getattr(record, f.name)) for f in fields(record))


@dataclass(frozen=True, eq=False)
class Calibration(Record):
    """A rectified pair of cameras: Z = focal_px * baseline_m / (disparity_px + offset_px).

    Raises: GeometryError if focal_px or baseline_m is not positive.
    """

    focal_px: float
    baseline_m: float
    offset_px: float = 0.0
    """Difference of the principal points' columns, right minus left (Middlebury's `doffs`)."""

    def __post_init__(self) -> None:
        if not (0 < self.focal_px < np.inf and 0 < self.baseline_m < np.inf and np.isfinite(self.offset_px)):
            raise GeometryError(
                f"a calibration needs focal_px > 0 and baseline_m > 0, not {self.focal_px} px and {self.baseline_m} m"
            )


@dataclass(frozen=True, eq=False)
class Views(Record):
    """One picture of a scene, or two.

    Raises: PictureError if a picture is not one, holds NaN or infinity, or the two differ in size.
    """

    left: np.ndarray
    right: np.ndarray | None = None
    calibration: Calibration | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_picture(self.left, "left view")
        if self.right is not None:
            check_picture(self.right, "right view")
            if self.left.shape[:2] != self.right.shape[:2]:
                raise PictureError(
                    f"the left view is {_size(self.left)} and the right one {_size(self.right)}; a pair has one size"
                )

    @property
    def shape(self) -> tuple[int, int]:
        """(h, w) of the left view."""
        return self.left.shape[:2]


@dataclass(frozen=True, eq=False)
class DisparityMap(Record):
    """Shift of each left pixel against the right view, or relative nearness from one picture.

    disparity_px: float32 (h, w), NaN where unknown; larger is nearer. A left pixel (row, x) matches (row, x - d).
    confidence: float32 (h, w) in 0..1; when left out, 1 where the disparity is known and 0 elsewhere.
    unit: "px" for stereo, "relative" (0 far .. 1 near) for one picture.
    """

    disparity_px: Float32[np.ndarray, "h w"]
    confidence: Float32[np.ndarray, "h w"] = field(default_factory=lambda: np.empty((0, 0), np.float32))
    unit: Literal["px", "relative"] = "px"

    def __post_init__(self) -> None:
        if self.confidence.size == 0:
            object.__setattr__(self, "confidence", np.isfinite(self.disparity_px).astype(np.float32))
        _same_shape("disparity_px", self.disparity_px, "confidence", self.confidence)
        super().__post_init__()


@dataclass(frozen=True, eq=False)
class SegmentMap(Record):
    """Which texture segment each pixel belongs to.

    labels: int32 (h, w), 0..n-1, each of them present.
    confidence: float32 (h, w) in 0..1; when left out, 1 everywhere.
    """

    labels: Int32[np.ndarray, "h w"]
    confidence: Float32[np.ndarray, "h w"] = field(default_factory=lambda: np.empty((0, 0), np.float32))

    def __post_init__(self) -> None:
        if self.confidence.size == 0:
            object.__setattr__(self, "confidence", np.ones(self.labels.shape, np.float32))
        _same_shape("labels", self.labels, "confidence", self.confidence)
        super().__post_init__()

    @property
    def count(self) -> int:
        """Number of segments."""
        return int(self.labels.max()) + 1


@dataclass(frozen=True, eq=False)
class Relief(Record):
    """A surface's heights, free of pixels: float32 (h, w) metres >= 0 over extent_m = (width, length) metres.

    Each height stands for one of h x w equal cells, at its centre.
    Raises: GeometryError if a height is not finite or negative, or the extent is not positive.
    """

    height_m: Float32[np.ndarray, "h w"]
    extent_m: tuple[float, float]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.height_m.ndim != 2 or self.height_m.size == 0:
            raise GeometryError(f"heights are (h, w) with at least one cell, not {self.height_m.shape}")
        if not (0 < self.extent_m[0] < np.inf and 0 < self.extent_m[1] < np.inf):
            raise GeometryError(f"a surface needs a positive width and length in metres, not {self.extent_m}")
        try:
            check_finite(self.height_m, "height_m")
        except PictureError as error:
            raise GeometryError(str(error)) from error
        if float(self.height_m.min()) < 0:
            raise GeometryError(
                f"heights are >= 0 above the base plane, the lowest is {self.height_m.min():g} m; add it"
            )

    @property
    def pitch_m(self) -> tuple[float, float]:
        """Width and length of one cell."""
        rows, columns = self.height_m.shape
        return self.extent_m[0] / columns, self.extent_m[1] / rows


@dataclass(frozen=True)
class Material:
    """How a segment feels. Every value with its unit; `source` says where they come from, or that they are a guess."""

    name: str
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    static_friction: float
    dynamic_friction: float
    roughness_m: float = 0.0
    """Amplitude of the fine texture; that of one wave of the same power, where it is made of many."""
    grain_m: float = 0.001
    """Wavelength of the fine texture."""
    texture: Texture = "stochastic"
    """Model of the fine texture (see `haptic_textures`)."""
    direction_deg: float = 0.0
    """Where the lines of the texture run: 0 along x, 90 along y."""
    anisotropy: float = 0.0
    """0 is alike in all directions (periodic: two crossed sets of lines), 1 is lines alone."""
    irregularity: float = 0.0
    """Share of a periodic texture's power that strays from strict repetition."""
    drag_n_s_per_m: float = 0.0
    """Lateral force against one metre per second, in contact."""
    seed: int = 0
    """Another seed is another specimen of the same material."""
    source: str = ""

    def __post_init__(self) -> None:
        for name, value in _items(self):
            if not isinstance(value, str) and not 0 <= value < np.inf:
                raise MaterialError(f"material {quoted(self.name)}: {name} is {value}; it must be >= 0 and finite")
        if wrong := next(self._nonsense(), None):
            raise MaterialError(f"material {quoted(self.name)}: {wrong}")

    def _nonsense(self) -> Iterator[str]:
        """What is wrong between the values, each a sentence."""
        if self.stiffness_n_per_m == 0 or self.grain_m == 0:
            yield "stiffness_n_per_m and grain_m must be above 0"
        if self.dynamic_friction > self.static_friction:
            yield (
                f"dynamic_friction {self.dynamic_friction} is above static_friction {self.static_friction}; "
                "things slide more easily than they start"
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


@dataclass(frozen=True, eq=False)
class MaterialMap(Record):
    """One material a segment, and why each was chosen."""

    materials: tuple[Material, ...]
    reasons: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class HapticSurface(Record):
    """What a renderer touches: relief, and per label a material where the scene has them; metres and newtons.

    Raises: GeometryError if labels and heights differ in size, MaterialError if a label has no material.
    """

    relief: Relief
    labels: Int32[np.ndarray, "h w"] | None = None
    materials: tuple[Material, ...] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.labels is None:
            return
        if self.labels.shape != self.height_m.shape:
            raise GeometryError(
                f"labels are {_size(self.labels)}, heights {_size(self.height_m)}; they are of one size"
            )
        low, high = int(self.labels.min()), int(self.labels.max())
        if low < 0 or (self.materials is not None and high >= len(self.materials)):
            raise MaterialError(f"labels run from {low} to {high}; there are {len(self.materials or ())} materials")

    @classmethod
    def from_heights(
        cls,
        height_m: np.ndarray,
        width_m: float = 0.08,
        labels: Int32[np.ndarray, "h w"] | None = None,
        materials: tuple[Material, ...] | None = None,
    ) -> "HapticSurface":
        """A surface of square cells from (h, w) heights in metres, width_m metres wide.

        Raises: GeometryError as `Relief`, MaterialError as the class.
        """
        if height_m.ndim != 2 or height_m.size == 0:
            raise GeometryError(f"heights are (h, w) with at least one cell, not {height_m.shape}")
        rows, columns = height_m.shape
        relief = Relief(np.ascontiguousarray(height_m, np.float32), (width_m, width_m * rows / columns))
        return cls(relief, labels, materials)

    @property
    def height_m(self) -> Float32[np.ndarray, "h w"]:
        """Heights above the base plane, metres."""
        return self.relief.height_m

    @property
    def extent_m(self) -> tuple[float, float]:
        """Width and length, metres."""
        return self.relief.extent_m


@dataclass(frozen=True)
class DeviceSpec:
    """What a device can do, known before it is opened. Frame: workspace."""

    max_force_n: float
    max_stiffness_n_per_m: float
    """At a servo rate of 1 kHz."""
    damping_n_s_per_m: float
    workspace_m: tuple[float, float, float]
    """Size along x, y, z."""
    resolution_m: float
    axes: int = 3
    """How many axes can give force."""
    buttons: int = 0
    simulated: bool = False
    """True if no motor moves."""


@dataclass(frozen=True)
class Unit:
    """One device that is connected now."""

    name: str
    """What it is, as its maker calls it."""
    serial: str = ""
    """What tells it from its like; a calibration belongs to it."""
    place: str = ""
    """Where it is connected."""
    problem: str = ""
    """Why it cannot be used as it is; empty if it can."""


@dataclass(frozen=True)
class Finding:
    """What one check of a device's surroundings found."""

    check: str
    verdict: Literal["fine", "failed", "not asked"]
    """`not asked` where nothing is there that could be asked."""
    says: str
    cure: str = ""
    """What to do about it, for a check that failed."""


class TickFlag(IntFlag):
    """What happened in one tick of a force loop; any number of them at once."""

    TOUCHING = 1
    """The law gave a force."""
    FORCE_LIMITED = 2
    """The force was over the greatest allowed, and scaled down."""
    SLEW_LIMITED = 4
    """The force changed by more than is allowed in a tick, and only went part of the way."""
    STIFFNESS_LIMITED = 8
    """The law is stiffer than this loop and device hold stably, and was softened."""
    RAMPING = 16
    """The force is fading in."""
    NOT_FINITE = 32
    """The law gave NaN or infinity, or the device did; the force was zero."""
    DAMPED = 64
    """The passivity controller took back energy that the loop had given away."""
    STALE = 128
    """The device had no fresh position for too long; the force was zero."""
    OVERRUN = 256
    """The tick began more than a period late."""
    SWAPPED = 512
    """The first tick on a new scene."""


TICK_COLUMNS = (
    *("time_s", "late_s"),
    *("x_m", "y_m", "z_m"),
    *("vx_m_per_s", "vy_m_per_s", "vz_m_per_s"),
    *("proxy_x_m", "proxy_y_m", "proxy_z_m"),
    *("fx_n", "fy_n", "fz_n"),
    *("flags", "buttons"),
)
"""What is kept of a tick, each a float64: when it began and how late, the tip, the proxy (NaN where there is none), the
force that the device was given, and the sum of its `TickFlag`s."""


OutcomeKind = Literal["given", "ran", "cached", "skipped", "failed"]


@dataclass(frozen=True)
class Outcome:
    """What became of one product, and why."""

    product: str
    outcome: OutcomeKind
    why: str
    method: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Plan:
    """What asking for a product will do: one outcome a product, in order, nothing run."""

    want: str
    steps: tuple[Outcome, ...]


class Spread(NamedTuple):
    """How a time scatters, in microseconds."""

    p50: float
    p99: float
    p999: float
    most: float


@dataclass(frozen=True)
class ServoReport:
    """How a force loop is doing since it started."""

    ticks: int
    time_s: float
    state: HapticState
    force: Force
    peak_force_n: float
    work_j: float
    """Work done by the device on the hand; above 0 the loop gave energy away."""
    stopped: str = ""
    """Why the loop ended; empty while it runs."""
    period_us: Spread | None = None
    """From one tick to the next; none where time is simulated."""
    late_us: Spread | None = None
    """From when a tick was due to when it began."""
    overruns: int = 0
    """Periods that had no tick."""
    flagged: Mapping[str, int] = field(default_factory=dict[str, int])
    """Ticks by the name of the `TickFlag` that they have, those that none has left out."""


def _same_shape(name: str, values: np.ndarray, other: str, others: np.ndarray) -> None:
    if values.ndim != 2 or values.size == 0:
        raise PictureError(f"{name} is (h, w) with at least one pixel, not {values.shape}")
    if values.shape != others.shape:
        raise PictureError(f"{name} is {_size(values)} and {other} is {_size(others)}; they are of one size")


def _size(picture: np.ndarray) -> str:
    return f"{picture.shape[1]} x {picture.shape[0]}"

"""Scenes: a pair of views, a photo, a height map or a video, from files, from arrays or builtin."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from types import NoneType
from typing import Any, Self, Unpack

import numpy as np
from jaxtyping import Bool, Float32

from ..data import DisparityMap, PictureText, Record, Relief, SegmentMap, Views
from ..data.arguments import named_options
from ..data.records import short_repr
from ..drawing import KindFound, PictureKind, picture_kind
from ..errors import ConfigError, GeometryError, PictureError
from .formats.height_maps import MeasuredSize
from .formats.multi_picture import Notify, ignore
from .geometry import MAX_RELIEF_M, Holes, Rise, ValueRange, fill_rows, scale_heights
from .scaling import felt_factor, reduced_map, reduced_shape
from .scene_files import BUILTINS, SceneFiles, scikit_image_data, unknown_scene
from .scene_options import File, HeightOptions, PairOptions, PhotoOptions, Picture, VideoOptions
from .scene_source import SceneSource, make_source, scene_name
from .video.files import Video


@dataclass(frozen=True, eq=False)
class Scene:
    """A scene: its pictures or heights, and the products that it provides.

    Make one with `pair`, `photo`, `heights`, `video` or `builtin`.

    >>> Scene.heights(np.zeros((4, 6)), relief_m=0.01).views is None
    True
    """

    name: str
    views: Views | None = None
    disparity: DisparityMap | None = None
    """Disparity that the scene provides: no depth is estimated."""
    segments: SegmentMap | None = None
    """Segments that the scene provides: no texture is segmented."""
    height: Float32[np.ndarray, "h w"] | None = field(default_factory=NoneType)  # `Scene.height(...)` is a mistake
    """Heights in any unit, NaN where unknown: no depth is estimated."""
    relief_m: float | None = None
    """Height of the relief that `height` becomes; None for that of the workspace."""
    offset: float = 0.0
    """Number that was taken off all heights, which would drown their differences in 32 bits."""
    measured: MeasuredSize | None = None
    """The size that the height map states; where that is its own, its heights are metres, and the lowest is kept."""
    truth: Float32[np.ndarray, "h w"] | None = None
    """True disparity in pixels, NaN where unknown."""
    known: Bool[np.ndarray, "h w"] | None = None
    """Mask of the known pixels of the left view or the photo; None if all are known."""
    shown: Bool[np.ndarray, "h w"] | None = None
    """Mask of the opaque pixels of the left view or the photo, None if all are; the others become flat ground."""
    stated_kind: PictureKind | None = None
    """The kind of the picture, where it is given and not measured."""
    segment_names: tuple[str, ...] = ()
    """The names that the file gives the segments, by their numbers, "" without one; () where it names none."""
    texts: tuple[PictureText, ...] = ()
    """The texts that the file states, which are not in the picture."""
    title: str = ""
    """The title that the file states; "" without one."""
    frames: Video | None = None
    """The frames of a video, of which the views are the first."""
    notes: tuple[str, ...] = ()
    """Remarks on the files."""
    warnings: tuple[str, ...] = ()
    """Those of the remarks by which the scene may be another than was meant."""
    files: str | SceneFiles | None = None
    """The builtin name, or the files with absolute paths, from which it was read; None if a part was an array."""

    def __post_init__(self) -> None:
        if Path(self.name).suffix and self.views is None and self.height is None:
            raise ConfigError(f"{self.name}: files are read by Scene.photo(...), pair(...), heights(...) or video(...)")

    def __repr__(self) -> str:
        return short_repr(self)

    @classmethod
    @named_options
    def pair(cls, left: Picture, right: Picture | None = None, **options: Unpack[PairOptions]) -> Self:
        """Make a scene of a rectified pair, or of a raw one with its `rig`; without `right`, both views are in `left`.

        The options are those of `SceneFiles`.
        Pictures are files or arrays, (h, w) or (h, w, 3|4), uint8, uint16, bool or float (white is 1), all of one size.
        Raises: ConfigError for parts that do not make a scene, PictureError for a part that cannot be read or is not a
        picture, ArgumentError for an argument of a wrong type.
        """
        views = {"stereo": left} if right is None else {"left": left, "right": right}
        return cls._load(views, options)

    @classmethod
    @named_options
    def photo(cls, photo: Picture, **options: Unpack[PhotoOptions]) -> Self:
        """Make a scene of one picture; transparent pixels do not belong to it. Options and errors: as `pair`."""
        return cls._load({"photo": photo}, options)

    @classmethod
    @named_options
    def heights(cls, heights: Picture, **options: Unpack[HeightOptions]) -> Self:
        """Make a scene of a height map (h, w) in any unit, NaN where unknown: a file or an array. As `pair`."""
        return cls._load({"height": heights}, options)

    @classmethod
    @named_options
    def video(cls, video: File | int, **options: Unpack[VideoOptions]) -> Self:
        """Make a scene of a video: a file, a folder of pictures, or the number of a camera. Errors: as `pair`."""
        return cls._load({"video": video}, options)

    @classmethod
    def _load(cls, parts: Mapping[str, Any], options: Mapping[str, Any]) -> Self:
        return cls(**make_source({**parts, **options}).load())

    @classmethod
    def builtin(cls, name: str) -> Self:
        """Make a scene from inside scikit-image: motorcycle, brick, coins, grass, gravel. Raises: ConfigError."""
        name = str(name)
        return cls.read(name if name.startswith("builtin/") else f"builtin/{name}", Path())

    @classmethod
    def read(cls, scene: "str | SceneFiles", folder: Path) -> Self:
        """Read a builtin scene by its name, or files relative to `folder`. Raises: ConfigError, PictureError."""
        if isinstance(scene, SceneFiles):
            return cls(**SceneSource(scene_name(scene), scene, folder, origin=scene).load())
        if scene not in BUILTINS:
            raise ConfigError(unknown_scene(scene))
        return cls(**SceneSource(scene, BUILTINS[scene], scikit_image_data(), origin=scene).load())

    @cached_property
    def kind(self) -> KindFound:
        """The kind of the picture: as given, else as measured; a photograph, if it is not a single still picture."""
        if self.stated_kind is not None:
            return KindFound(self.stated_kind, 1.0)
        if self.views is None or self.views.right is not None or self.frames is not None:
            return KindFound(PictureKind.photograph, 1.0)
        return picture_kind(self.views.left)

    @property
    def shape(self) -> tuple[int, int]:
        """The shape (h, w) of the pictures, or of the heights. Raises: PictureError if it has neither."""
        if self.views is not None:
            return self.views.shape
        if self.height is None:
            raise PictureError(f"the scene {self.name} has neither a picture nor heights")
        rows, columns = self.height.shape
        return rows, columns

    @property
    def own_size(self) -> tuple[float, float, float] | None:
        """Width, length and height in metres at which the height map is felt by itself; None if it has none."""
        if self.measured is None or self.measured.high_m is None:
            return None
        return self.measured.width_m, self.measured.length_m, self.measured.high_m

    def brings(
        self,
        width_m: float,
        relief_m: float,
        holes: Holes = "fill",
        finest_m: float = 0,
        rise: Rise | None = None,
        notify: Notify = ignore,
    ) -> dict[str, Record]:
        """Return the products that the scene provides, by name; heights become a relief. Raises: GeometryError."""
        relief = None
        if self.height is not None:
            factor = felt_factor(self.height.shape[1], width_m, finest_m)
            height = reduced_map(self.height, reduced_shape(self.shape, factor))
            relief_m = self.relief_m or relief_m
            try:
                if self.own_size is None or rise not in (None, Rise()):
                    relief = self._to_scale(height, width_m, relief_m, holes, rise or Rise(), notify)
                else:
                    own_width_m, own_length_m, high_m = self.own_size
                    scale = np.float32(relief_m / high_m) if high_m else np.float32(1)
                    heights = fill_rows(height) if scale == 1 else fill_rows(height) * scale
                    extent_m = width_m, width_m * own_length_m / own_width_m
                    relief = Relief(np.maximum(heights, np.float32(0)), extent_m)  # the lowest keeps its height
            except GeometryError as error:
                raise GeometryError(f"{self.name}: {error}") from error
        products = {"views": self.views, "relief": relief, "disparity": self.disparity, "segments": self.segments}
        return {product: record for product, record in products.items() if record is not None}

    def _to_scale(
        self, height: np.ndarray, width_m: float, relief_m: float, holes: Holes, rise: Rise, notify: Notify
    ) -> Relief:
        """Return the relief of these heights at a scale, or between the range that is given for them."""
        size, finite = self.measured, height[np.isfinite(height)]
        range_given, ends = (
            (rise.low_m, rise.high_m),
            (0.0 if self.own_size else finite.min(initial=np.inf), finite.max(initial=-np.inf)),
        )
        low, high = (
            float(end) if value is None else value - self.offset for value, end in zip(range_given, ends, strict=True)
        )
        if size is not None and rise.m_per_m is not None:
            relief_m = (high - low) * size.unit_m * rise.m_per_m
            if relief_m > MAX_RELIEF_M:
                raise GeometryError(
                    f"the relief would be {relief_m:.3g} m high, and may be {MAX_RELIEF_M:g} m at most; choose a "
                    "smaller scale or less exaggeration, or check the unit of the heights"
                )
        if beyond := np.count_nonzero((finite < low) | (finite > high)):
            notify(
                f"{100 * beyond / finite.size:.2g} % of the heights are beyond low_m or high_m, and made level there"
            )
        spans = None if range_given == (None, None) else ValueRange(low, high)
        relief = scale_heights(height, width_m, relief_m if relief_m > 0 else 1.0, holes, spans)
        if size is None:
            return relief
        if text := scale_in_words(size, width_m, relief_m / (high - low) if high > low else 0.0):
            notify(text)
        return Relief(relief.height_m, (width_m, width_m * size.length_m / size.width_m))


def scale_in_words(measured: MeasuredSize, width_m: float, rise: float) -> str:
    """Describe the scale of a map of the ground. rise: metres of the relief in a number of the map; 0 for a flat one.

    >>> scale_in_words(MeasuredSize(4000.0, 3000.0, None), 0.08, 4e-5)
    'scale 1:50000, 1 mm is 50 m on the ground; heights are 2 times as steep as there, 1 mm is 25 m'
    """
    times = measured.width_m / width_m
    steeper = times * rise / measured.unit_m
    if not rise or abs(steeper - 1) < 0.005:
        return f"scale 1:{times:.6g}, 1 mm is {times / 1000:.3g} m on the ground, also in height"
    return (
        f"scale 1:{times:.6g}, 1 mm is {times / 1000:.3g} m on the ground; heights are {steeper:.3g} times as steep as "
        f"there, 1 mm is {measured.unit_m / rise / 1000:.3g} m"
    )

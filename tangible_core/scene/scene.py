"""What there is to feel: a pair of views, a photo or a height map, from files or built in."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from jaxtyping import Bool, Float32
from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..data import Calibration, DisparityMap, Record, SegmentMap, Views
from ..data.pictures import fill_non_finite
from ..errors import ConfigError, PictureError, did_you_mean, quoted
from .geometry import Holes, scale_heights
from .picture_files import NonFinite, read_labels, read_map, read_picture

Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]

_NEEDS = {"focal_px": "baseline_m", "baseline_m": "focal_px", "offset_px": "focal_px", "relief_m": "height"}
_OF_VIEWS = ("disparity", "truth", "focal_px", "baseline_m", "offset_px")
_PICTURES = {"left", "right", "photo"}
_READERS = {
    "height": read_map,
    "disparity": read_map,
    "segments": read_labels,
    "truth": read_map,
}


class SceneFiles(BaseModel):
    """A scene in files: a pair (left and right), one photo, or a height map. Relative paths start at the YAML file."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    left: Path | None = None
    """Left view of a rectified pair."""
    right: Path | None = None
    """Right view of a rectified pair, of the same size."""
    photo: Path | None = None
    """A single picture."""
    height: Path | None = None
    """A height map in any unit, larger values standing higher: a grey picture, .npy, .pfm or .tif. No depth is
    estimated."""
    disparity: Path | None = None
    """A disparity map of the left view or the photo, in pixels, NaN where unknown. No depth is estimated."""
    segments: Path | None = None
    """A label picture: one colour or number per segment. No texture is segmented."""
    truth: Path | None = None
    """Ground-truth disparity of the left view, in pixels, NaN or infinite where unknown; used for error figures
    only."""
    focal_px: Length | None = None
    """Focal length of the rectified cameras, in pixels; with `baseline_m`, the relief is proportional to depth."""
    baseline_m: Length | None = None
    """Distance between the camera centres."""
    offset_px: Annotated[float, Field(allow_inf_nan=False)] | None = None
    """Column of the right camera's principal point minus that of the left (Middlebury's `doffs`); 0 if left out."""
    relief_m: Length | None = None
    """Height of the relief made from a height map; by default that of `workspace`."""

    non_finite: NonFinite = "error"
    """What to do with NaN and infinity in a picture. `error`: stop, and name the first such pixel. `mask`: fill from
    the nearest pixel, and leave the disparity unknown and the segment's confidence 0 there."""

    @model_validator(mode="after")
    def _one_scene(self) -> Self:
        given = [name for name, value in self if isinstance(value, Path | float)]
        kinds = [kind for kind in (("left", "right"), ("photo",), ("height",)) if set(kind) & set(given)]
        if len(kinds) != 1 or not set(kinds[0]) <= set(given):
            named = ", ".join(given) or "nothing"
            raise ValueError(f"a scene is either left and right, or photo, or height; this one gives {named}")
        for name, other in _NEEDS.items():
            if name in given and other not in given:
                raise ValueError(f"{name} needs {other} beside it")
        if idle := self.height and [name for name in given if name in _OF_VIEWS]:
            raise ValueError(f"height already gives all heights; leave out {', '.join(idle)}")
        return self

    @property
    def main(self) -> Literal["left", "photo", "height"]:
        """The field that says what kind of scene this is, and whose size the others share."""
        return "left" if self.left else "photo" if self.photo else "height"

    @property
    def calibration(self) -> Calibration | None:
        """The cameras, where they are known."""
        if self.focal_px is None or self.baseline_m is None:
            return None
        return Calibration(self.focal_px, self.baseline_m, self.offset_px or 0.0)


@dataclass(frozen=True, eq=False)
class Scene:
    """A scene that was read: what it shows, and the products that it brings, which then need not be made."""

    name: str
    views: Views | None
    given: Mapping[str, Record]
    """Ready products: "disparity", "relief" or "segments"."""
    truth: Float32[np.ndarray, "h w"] | None = None
    """True disparity in pixels, NaN where unknown."""
    known: Bool[np.ndarray, "h w"] | None = None
    """Where the left view or the photo is; None for everywhere."""


BUILTINS: Mapping[str, SceneFiles] = {
    "builtin/motorcycle": SceneFiles(
        left=Path("motorcycle_left.png"),
        right=Path("motorcycle_right.png"),
        truth=Path("motorcycle_disp.npz"),
        focal_px=994.978,
        baseline_m=0.193001,
        offset_px=31.086,
    ),
    **{f"builtin/{name}": SceneFiles(photo=Path(f"{name}.png")) for name in ("brick", "coins", "grass", "gravel")},
}
"""Scenes whose files come inside scikit-image; nothing is ever downloaded. The motorcycle is Middlebury 2014
(Scharstein et al., GCPR 2014) at a quarter of its size, with the calibration in `skimage.data.stereo_motorcycle`."""


def read_scene(scene: str | SceneFiles, folder: Path, width_m: float, relief_m: float, holes: Holes = "fill") -> Scene:
    """Read a scene: a builtin name, or files relative to `folder`.

    width_m, relief_m, holes: size of the relief that a height map becomes, and what becomes of its holes.
    Raises: ConfigError for a name that is not builtin; PictureError for a file that cannot be read, or two files
    that differ in size; GeometryError for a height map without a height.
    """
    if isinstance(scene, SceneFiles):
        name, files = str(getattr(scene, scene.main)), scene
    elif scene in BUILTINS:
        name, files, folder = scene, BUILTINS[scene], _scikit_image_data()
    else:
        raise ConfigError(unknown_scene(scene))
    paths = {key: folder / path.expanduser() for key, path in files if isinstance(path, Path)}
    held = {key: _READERS[key](path) for key, path in paths.items() if key not in _PICTURES}
    held |= {key: read_picture(path, files.non_finite) for key, path in paths.items() if key in _PICTURES}
    _check_sizes(paths, held)
    known = _fill(held, files.main) if files.non_finite == "mask" and files.main in _PICTURES else None
    given = _given(files, held, width_m, relief_m, holes)
    return Scene(name, _views(files, held), given, _frozen(held.get("truth")), _frozen(known))


def unknown_scene(name: str) -> str:
    """What to say of a name that is not builtin."""
    return (
        f"no scene is named {quoted(name)}{did_you_mean(name, BUILTINS)}; builtin are {', '.join(sorted(BUILTINS))}; "
        "for files of your own write {photo: FILE}, {left: FILE, right: FILE} or {height: FILE}"
    )


def _scikit_image_data() -> Path:
    """The folder itself: scikit-image's own functions download what they miss."""
    from importlib.util import find_spec

    spec = find_spec("skimage")
    if spec is None or not spec.submodule_search_locations:
        raise PictureError("builtin scenes come inside scikit-image, which is not installed: pip install scikit-image")
    return Path(spec.submodule_search_locations[0]) / "data"


def _check_sizes(paths: Mapping[str, Path], held: Mapping[str, np.ndarray]) -> None:
    main, *others = held
    size = held[main].shape[1::-1]
    for other in others:
        if (its := held[other].shape[1::-1]) != size:
            raise PictureError(
                f"{paths[other]} ({other}) is {its[0]} x {its[1]} and {paths[main]} ({main}) is {size[0]} x {size[1]}; "
                "all files of a scene must be of one size; resize or crop one of them"
            )


def _fill(held: dict[str, np.ndarray], main: str) -> np.ndarray | None:
    """Fill what is not finite in the pictures; where the main one is known, None if that is everywhere."""
    known: dict[str, np.ndarray] = {}
    for name in held.keys() & _PICTURES:
        held[name], known[name] = fill_non_finite(held[name])
    return None if known[main].all() else known[main]


def _views(files: SceneFiles, held: Mapping[str, np.ndarray]) -> Views | None:
    return None if files.height else Views(held[files.main], held.get("right"), files.calibration)


def _given(
    files: SceneFiles, held: Mapping[str, np.ndarray], width_m: float, relief_m: float, holes: Holes
) -> Mapping[str, Record]:
    given: dict[str, Record] = {}
    if "height" in held:
        given["relief"] = scale_heights(held["height"], width_m, files.relief_m or relief_m, holes)
    if "disparity" in held:
        given["disparity"] = DisparityMap(held["disparity"])
    if "segments" in held:
        given["segments"] = SegmentMap(held["segments"])
    return given


def _frozen(values: np.ndarray | None) -> np.ndarray | None:
    if values is not None:
        values.flags.writeable = False
    return values

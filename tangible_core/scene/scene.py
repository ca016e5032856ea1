"""What there is to feel: a pair of views, a photo or a height map, from files, from arrays or built in."""

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, Self, cast

import numpy as np
from jaxtyping import Bool, Float32
from numpy.typing import ArrayLike
from pydantic import ValidationError

from ..data import Calibration, DisparityMap, Record, SegmentMap, Views
from ..data.arguments import as_picture
from ..data.pictures import fill_non_finite
from ..errors import ConfigError, PictureError, wrong_argument
from ..files.paths import as_path
from .geometry import Holes, scale_heights
from .picture_files import NonFinite, labels_of, map_of, picture_of, read_labels, read_map, read_picture
from .rig import StereoRig, turned
from .rig_files import read_rig
from .scene_files import BUILTINS, SceneFiles, unknown_scene

File = str | PathLike[str]
_PICTURES = {"left", "right", "photo"}
_READERS = {"height": read_map, "disparity": read_map, "segments": read_labels, "truth": read_map}
_CONVERTERS = {"height": map_of, "disparity": map_of, "segments": labels_of, "truth": map_of}


@dataclass(frozen=True, eq=False)
class Scene:
    """What it shows, and the products that it brings, which then need not be made. Made by `of` or `builtin`.

    >>> Scene.of(height=np.zeros((4, 6)), relief_m=0.01).views is None
    True
    """

    name: str
    views: Views | None = None
    disparity: DisparityMap | None = None
    """A ready one: no depth is estimated."""
    segments: SegmentMap | None = None
    """Ready ones: no texture is segmented."""
    height: Float32[np.ndarray, "h w"] | None = None
    """Heights in any unit, NaN where unknown: no depth is estimated."""
    relief_m: float | None = None
    """Height of the relief that `height` becomes; the workspace's where it is None."""
    truth: Float32[np.ndarray, "h w"] | None = None
    """True disparity in pixels, NaN where unknown."""
    known: Bool[np.ndarray, "h w"] | None = None
    """Where the left view or the photo is; None for everywhere."""
    files: str | SceneFiles | None = None
    """The builtin name, or the files with absolute paths, that it was read from; None if any of it was an array."""

    @classmethod
    def of(
        cls,
        *,
        left: File | ArrayLike | None = None,
        right: File | ArrayLike | None = None,
        photo: File | ArrayLike | None = None,
        height: File | ArrayLike | None = None,
        disparity: File | ArrayLike | None = None,
        segments: File | ArrayLike | None = None,
        truth: File | ArrayLike | None = None,
        calibration: Calibration | None = None,
        rig: "StereoRig | File | None" = None,
        relief_m: float | None = None,
        non_finite: NonFinite = "error",
        name: str = "",
    ) -> Self:
        """A scene of files and arrays: left and right, or a photo, or heights; the meanings are those of `SceneFiles`.

        Pictures are (h, w) or (h, w, 3|4), uint8, uint16, bool or float (white is 1). All are of one size.
        Raises: ConfigError for parts that make no scene, PictureError for one that cannot be read or is no picture.
        """
        parts: dict[str, Any] = {
            "left": left, "right": right, "photo": photo, "height": height,
            "disparity": disparity, "segments": segments, "truth": truth, "rig": rig,
        }  # fmt: skip
        parts = {part: value for part, value in parts.items() if value is not None}
        _check_cameras(calibration, rig)
        paths = {
            part: as_path(cast(Any, value), part).absolute()
            for part, value in parts.items()
            if isinstance(value, str | PathLike)
        }
        files = _checked(
            paths | {part: Path(f"the array given as {part}") for part in parts.keys() - paths.keys()},
            calibration, relief_m, non_finite,
        )  # fmt: skip
        if paths.keys() == parts.keys():
            return cls._read(name or str(paths[files.main]), files, Path(), files)
        cameras = _rig(paths["rig"], files).cameras if "rig" in paths else rig
        held = {
            part: _read(part, paths[part], files) if part in paths else _converted(part, as_picture(part, value), files)
            for part, value in sorted(parts.items(), key=lambda each: each[0] != files.main)
            if part != "rig"
        }
        return cls._made(name or "arrays", files, held, None, cast("StereoRig | None", cameras))

    @classmethod
    def builtin(cls, name: str) -> Self:
        """A scene that comes inside scikit-image: motorcycle, brick, coins, grass, gravel.

        Raises: ConfigError for another name.
        """
        name = str(name)
        return cls.read(name if name.startswith("builtin/") else f"builtin/{name}", Path())

    @classmethod
    def read(cls, scene: "str | SceneFiles", folder: Path) -> Self:
        """A builtin name, or files relative to `folder`.

        Raises: ConfigError for a name that is not builtin; PictureError for a file that cannot be read, or two files
        that differ in size.
        """
        if isinstance(scene, SceneFiles):
            return cls._read(str(getattr(scene, scene.main)), scene, folder, scene)
        if scene not in BUILTINS:
            raise ConfigError(unknown_scene(scene))
        return cls._read(scene, BUILTINS[scene], _scikit_image_data(), scene)

    @classmethod
    def _read(cls, name: str, files: SceneFiles, folder: Path, origin: "str | SceneFiles") -> Self:
        paths = {part: as_path(folder) / as_path(path) for part, path in files if isinstance(path, Path)}
        rig = _rig(paths.pop("rig"), files) if "rig" in paths else None
        held = {part: _read(part, path, files) for part, path in paths.items()}
        if rig is not None and rig.size not in (None, held[files.main].shape[1::-1]):
            raise PictureError(
                f"{paths[files.main]} is not {rig.size[0]} x {rig.size[1]}, the size that the rig was calibrated for"
            )
        return cls._made(name, files.model_copy(update=paths), held, origin, rig and rig.cameras)

    @classmethod
    def _made(
        cls,
        name: str,
        files: SceneFiles,
        held: dict[str, np.ndarray],
        origin: "str | SceneFiles | None",
        rig: StereoRig | None = None,
    ) -> Self:
        _check_sizes(files, held)
        masked = files.non_finite == "mask" and files.main in _PICTURES
        known = _fill(held, files.main) if masked else None
        views = None if files.height else Views(held[files.main], held.get("right"), files.calibration)
        if rig is not None and views is not None:
            views, known = turned(views, rig)
        return cls(
            name=name,
            views=views,
            disparity=DisparityMap(held["disparity"]) if "disparity" in held else None,
            segments=SegmentMap(held["segments"]) if "segments" in held else None,
            height=_frozen(held.get("height")),
            relief_m=files.relief_m,
            truth=_frozen(held.get("truth")),
            known=_frozen(known),
            files=origin,
        )

    def brings(self, width_m: float, relief_m: float, holes: Holes = "fill") -> dict[str, Record]:
        """The products that need not be made, by name; heights become a relief of this size.

        relief_m: where the scene says none. holes: what becomes of unknown heights.
        Raises: GeometryError for heights that are unknown everywhere.
        """
        relief = None
        if self.height is not None:
            relief = scale_heights(self.height, width_m, self.relief_m or relief_m, holes)
        found = {"views": self.views, "relief": relief, "disparity": self.disparity, "segments": self.segments}
        return {product: record for product, record in found.items() if record is not None}


def _check_cameras(calibration: object, rig: object) -> None:
    """Raises: ArgumentError for what describes no camera."""
    if not isinstance(calibration, Calibration | None):
        raise wrong_argument("calibration", calibration, "a Calibration, such as Calibration(focal_px, baseline_m)")
    if not isinstance(rig, StereoRig | str | PathLike | None):
        raise wrong_argument("rig", rig, "a StereoRig, or the path of its file")


def _checked(
    paths: Mapping[str, Path], calibration: Calibration | None, relief_m: float | None, non_finite: NonFinite
) -> SceneFiles:
    """The parts of a scene as files. Raises: ConfigError if they make none."""
    cameras: dict[str, float] = {}
    if calibration is not None:
        cameras = {"focal_px": calibration.focal_px, "baseline_m": calibration.baseline_m}
        cameras |= {"offset_px": calibration.offset_px} if calibration.offset_px else {}
    try:
        return SceneFiles.model_validate({**paths, **cameras, "relief_m": relief_m, "non_finite": non_finite})
    except ValidationError as error:
        raise ConfigError(
            *(f"{'.'.join(['scene', *map(str, each['loc'])])}: {each['msg']}" for each in error.errors())
        ) from error


class _Rig(NamedTuple):
    """Two cameras, and the size of the pictures that they were calibrated with, where it is known."""

    cameras: StereoRig
    size: tuple[int, int] | None


def _rig(path: Path, files: SceneFiles) -> _Rig:
    return _Rig(*read_rig(path, files.rig_unit_m or 1.0))


def _read(part: str, path: Path, files: SceneFiles) -> np.ndarray:
    return read_picture(path, files.non_finite) if part in _PICTURES else _READERS[part](path)


def _converted(part: str, values: np.ndarray, files: SceneFiles) -> np.ndarray:
    """A copy, as what it was given for."""
    name = str(getattr(files, part))
    if part in _PICTURES:
        return picture_of(values.copy(), name, files.non_finite)
    return _CONVERTERS[part](values.copy(), name)


def _scikit_image_data() -> Path:
    """The folder itself: scikit-image's own functions download what they miss."""
    from importlib.util import find_spec

    spec = find_spec("skimage")
    if spec is None or not spec.submodule_search_locations:
        raise PictureError("builtin scenes come inside scikit-image, which is not installed: pip install scikit-image")
    return Path(spec.submodule_search_locations[0]) / "data"


def _check_sizes(files: SceneFiles, held: Mapping[str, np.ndarray]) -> None:
    main = files.main
    size = held[main].shape[1::-1]
    for other in held.keys() - {main}:
        if (its := held[other].shape[1::-1]) != size:
            raise PictureError(
                f"{getattr(files, other)} ({other}) is {its[0]} x {its[1]} and {getattr(files, main)} ({main}) is "
                f"{size[0]} x {size[1]}; all parts of a scene must be of one size; resize or crop one of them"
            )


def _fill(held: dict[str, np.ndarray], main: str) -> np.ndarray | None:
    """Fill what is not finite in the pictures; where the main one is known, None if that is everywhere."""
    known: dict[str, np.ndarray] = {}
    for name in held.keys() & _PICTURES:
        held[name], known[name] = fill_non_finite(held[name])
    return None if known[main].all() else known[main]


def _frozen(values: np.ndarray | None) -> np.ndarray | None:
    if values is not None:
        values.flags.writeable = False
    return values

"""The table of how each product is made, from what, and when a scene does not need it."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any
from uuid import uuid4

import numpy as np

from ..data import DisparityMap, HapticSurface, Material, MaterialMap, Record, Relief, SegmentMap, Views, digest_of
from ..errors import BrokenMethod, ConfigError
from ..materials import assignment
from ..plugins.interfaces import HapticDevice, Method, Skippable, Touch
from ..plugins.notes import note
from ..preflight import fit_surface
from ..provenance.closure import closure
from ..provenance.source import source_digest
from ..scene import geometry, scaling
from ..scene.scene import Scene
from .cache import Cache
from .config import NamedMethod, PipelineConfig

log = logging.getLogger(__name__)
Inputs = Mapping[str, Any]
"""Products by name; None where one was skipped."""


@dataclass(frozen=True)
class Rule:
    """How one product is made."""

    product: str
    method: str
    """The method's name, for people."""
    key: str
    """What the result depends on beside its inputs."""
    needs: tuple[str, ...]
    make: Callable[[Inputs], Any]
    skip: str | None = None
    """Why this scene does not need it."""
    note: str = ""
    """What part of the work this scene does not need."""
    cached: bool = True


def rules(config: PipelineConfig, scene: Scene, brought: Mapping[str, Record]) -> dict[str, Rule]:
    """One rule a product, for this configuration and this scene.

    brought: products that the scene brings, which have no rule.
    Raises: ConfigError for a material library that cannot be read.
    """
    segments = _segments(config, scene)
    unsegmented = None if "segments" in brought else segments.skip
    table = (
        _disparity(config, scene),
        _relief(config, scene),
        segments,
        _materials(config, scene, unsegmented),
        _surface(config, scene),
        _touch(config, scene),
    )
    return {rule.product: rule for rule in table if rule.product not in brought}


def _disparity(config: PipelineConfig, scene: Scene) -> Rule:
    factor, note = _felt(config, scene)

    def make(inputs: Inputs) -> DisparityMap:
        views = _views(scene)
        small, chosen = scaling.reduced(views, factor), _configured(config, "depth")
        made = chosen.method.estimate(small)
        _check_shape("depth", chosen, "disparity", made.disparity_px.shape, small.shape)
        found = scaling.enlarged(made, views.shape)
        if scene.known is None:
            return found
        known_px = np.where(scene.known, found.disparity_px, np.float32(np.nan))
        return DisparityMap(known_px, found.confidence * scene.known, found.unit)

    name, key = _identity(config.depth)
    key = f"{_core(scaling.__name__)} {key} 1/{factor} {_known(scene)}"
    return Rule("disparity", name, key, ("views",), make, _skip(config.depth, scene), note)


def _relief(config: PipelineConfig, scene: Scene) -> Rule:
    size = config.size

    def make(inputs: Inputs) -> Relief:
        disparity: DisparityMap | None = inputs["disparity"]
        calibration = scene.views.calibration if scene.views else None
        if disparity is None:
            return geometry.flat_relief(_views(scene).shape, size.width_m)
        relief = geometry.make_relief(disparity, calibration, size.width_m, size.relief_m, size.holes)
        return geometry.smooth(relief, size.smooth_m)

    return Rule("relief", "core", f"{_core(geometry.__name__)} {size!r}", ("views", "disparity"), make)


def _segments(config: PipelineConfig, scene: Scene) -> Rule:
    factor, note = _felt(config, scene)

    def make(inputs: Inputs) -> SegmentMap:
        views = _views(scene)
        small, chosen = scaling.reduced(Views(views.left), factor), _configured(config, "texture")
        made = chosen.method.segment(small.left)
        _check_shape("texture", chosen, "labels", made.labels.shape, small.shape)
        found = scaling.enlarged_segments(made, views.shape)
        return found if scene.known is None else SegmentMap(found.labels, found.confidence * scene.known)

    skip = _skip(config.texture, scene)
    if config.texture is None:
        skip = "no `texture:` is configured; the whole surface is one material"
    elif scene.views is None:
        skip = "the scene has heights and no picture"
    name, key = _identity(config.texture)
    key = f"{_core(scaling.__name__)} {key} 1/{factor} {_known(scene)}"
    return Rule("segments", name, key, ("views",), make, skip, note)


def _materials(config: PipelineConfig, scene: Scene, unsegmented: str | None) -> Rule:
    choice = config.materials
    library = assignment.load_library(choice.library)

    def make(inputs: Inputs) -> MaterialMap:
        picture = scene.views.left if scene.views else None
        return assignment.assign(inputs["segments"], picture, choice.by, library, choice.rules, choice.default)

    said = choice.model_dump(exclude={"library"})
    key = f"{_core(assignment.__name__)} {said} {_library_digest(tuple(library.values()))}"
    skip = f"there are no segments: {unsegmented}" if unsegmented else None
    return Rule("materials", "core", key, ("views", "segments"), make, skip)


def _surface(config: PipelineConfig, scene: Scene) -> Rule:
    def make(inputs: Inputs) -> HapticSurface:
        segments: SegmentMap | None = inputs.get("segments")
        chosen: MaterialMap | None = inputs.get("materials")
        if segments is None or chosen is None:
            return HapticSurface(inputs["relief"])
        return HapticSurface(inputs["relief"], segments.labels, chosen.materials)

    with_materials = config.render is None or config.render.method.uses_materials
    needs = ("relief", "segments", "materials") if with_materials else ("relief",)
    return Rule("surface", "core", _core(HapticSurface.__module__), needs, make)


def _touch(config: PipelineConfig, scene: Scene) -> Rule:
    def make(inputs: Inputs) -> Touch:
        chosen, device = _configured(config, "render"), config.felt_device
        surface, said = fitted(inputs["surface"], config, device) if device else (inputs["surface"], "")
        if said:
            note(log, said)
        return chosen.method.touch(surface)

    return Rule("touch", *_identity(config.render), ("surface",), make, cached=False)


def fitted(surface: HapticSurface, config: PipelineConfig, device: HapticDevice) -> tuple[HapticSurface, str]:
    """The surface as a law is given it on this device, and what was taken off its materials, in words."""
    if config.materials.fit == "never":
        return surface, ""
    return fit_surface(surface, device.spec(), config.safety)


def given_key(value: Record) -> str:
    """The key of something that the scene brings: its content."""
    return value.digest()


def made_key(rule: Rule, inputs: Mapping[str, str]) -> str:
    """The key of something that is made: what makes it, and the keys of what it is made from."""
    parts = (rule.product, rule.key, *(f"{name}={key}" for name, key in inputs.items()))
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _identity(chosen: NamedMethod[Any] | None) -> tuple[str, str]:
    """A method's name, and everything its results depend on: where it comes from, its code, version and options."""
    if chosen is None:
        return "", ""
    method: Method = chosen.method
    cls = type(method)
    code = closure(cls.__module__)
    digest = code.digest if code.modules else source_digest(cls) or uuid4().hex
    options = method.model_dump()  # not as JSON, to which infinity and nothing are the same
    return chosen.name, f"{chosen.origin} {cls.__module__}:{cls.__qualname__} {digest} v{cls.version} {options}"


@cache
def _library_digest(materials: tuple[Material, ...]) -> str:
    """Kept, as a library has hundreds of values and hardly ever changes within a process."""
    return digest_of(materials)


def _core(module: str) -> str:
    """The code of the core's part: a module, this table, and what keeps a result."""
    return closure(module, alone=(__name__, Cache.__module__)).digest


def _felt(config: PipelineConfig, scene: Scene) -> tuple[int, str]:
    """By how much the pictures are reduced, as nothing finer is felt; and the words for it."""
    size = config.size
    factor = scaling.felt_factor(scene.views.shape[1], size.width_m, size.finest_m) if scene.views else 1
    if factor == 1:
        return factor, ""
    what = f"at 1/{factor} of the size, as finer than {1e3 * size.finest_m:g} mm is not felt"
    return factor, f"{what} (`workspace: {{finest_m: 0}}` keeps everything)"


def _known(scene: Scene) -> str:
    return "" if scene.known is None else f"known {digest_of(scene.known)}"


def _skip(chosen: NamedMethod[Any] | None, scene: Scene) -> str | None:
    if chosen is not None and isinstance(chosen.method, Skippable) and scene.views is not None:
        return chosen.method.skip(scene.views)
    return None


def _check_shape(
    kind: str, chosen: NamedMethod[Any], what: str, found: tuple[int, ...], wanted: tuple[int, ...]
) -> None:
    """What a method makes is enlarged to the size of the pictures, so that a wrong size would pass unseen."""
    if found != wanted:
        raise BrokenMethod(
            f"{kind} method {chosen.name} ({chosen.origin}) made {what} of {_size(found)} for a picture of "
            f"{_size(wanted)}; `tangible check {kind} {chosen.name}` shows what it must keep"
        )


def _size(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, reversed(shape)))


def _configured(config: PipelineConfig, kind: str) -> NamedMethod[Any]:
    chosen: NamedMethod[Any] | None = getattr(config, kind)
    if chosen is None:
        raise config.missing(kind)
    return chosen


def _views(scene: Scene) -> Views:
    if scene.views is None:
        raise ConfigError(f"the scene {scene.name} has no picture; give one with `photo:` or `left:` and `right:`")
    return scene.views

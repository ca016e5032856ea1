"""The table of how each product is made, from what, and when a scene does not need it."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any
from uuid import uuid4

from ...data import (
    DisparityMap,
    HapticSurface,
    Material,
    MaterialMap,
    PartMap,
    Record,
    Relief,
    SegmentMap,
    Views,
    digest_of,
)
from ...errors import BrokenMethod, ConfigError, PictureError, TangibleError
from ...files.content import content_digest
from ...legibility import SimplifyChoice, simplify
from ...materials import assignment
from ...parts import Layering, PartHeights
from ...parts import find as part_finding
from ...plugins.interfaces import DepthEstimator, HapticDevice, Method, Skippable, Touch
from ...plugins.notes import doubt, note
from ...preflight import fit_surface
from ...provenance.closure import closure
from ...provenance.source import source_digest
from ...scene import geometry, scaling, unmatched, view_order
from ...scene.scene import Scene
from ...scene.scene_files import SceneFiles
from ...scene.workspace import FeltSize
from ..config.methods import NamedMethod
from ..config.model import PipelineConfig
from ..config.part_names import names_of
from . import part_heights as heights_of_parts
from . import part_validation, working_grid
from .cache import Cache
from .working_grid import WorkingGrid

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
    """On the grid that is felt."""
    whole: Callable[[Any], Any] | None = None
    """What was made, for every pixel of the pictures; None for what is not said by pixels."""
    skip: str | None = None
    """Why this scene does not need it."""
    note: str = ""
    """What part of the work this scene does not need."""
    cached: bool = True
    refusal: TangibleError | None = None
    """Why it cannot be made of this scene, as far as that is known beforehand."""
    finish: Callable[[Any], Any] | None = None
    """What is added or checked whenever it is handed on, and is not kept with it: names, of which nothing is made."""
    usual: bool = True
    """False for what only who asks for it needs to hear of."""


def rules(config: PipelineConfig, scene: Scene, brought: Mapping[str, Record]) -> dict[str, Rule]:
    """One rule a product, for this configuration and this scene.

    brought: products that the scene brings, which have no rule.
    Raises: ConfigError for a material library that cannot be read, or for parts that the scene's own segments have not.
    """
    grid = WorkingGrid(scene, config.size)
    segments = _segments(config, grid)
    known = brought.get("segments")
    unsegmented = None if known is not None else segments.skip
    if config.by_parts and isinstance(known, SegmentMap):
        part_validation.check_found(config, part_validation.parts_of(known), scene.shape[1])
    table = (
        _disparity(config, grid),
        _relief_of_parts(config, grid) if config.heights else _relief(config, grid),
        segments,
        _parts(config, grid, unsegmented),
        _simplified(config, grid, unsegmented),
        _materials(config, grid, unsegmented, known is None),
        _surface(config, grid),
        _touch(config),
    )
    return {rule.product: rule for rule in table if rule.product not in brought}


def _disparity(config: PipelineConfig, grid: WorkingGrid) -> Rule:
    files, original = grid.scene.files, grid.scene.views
    as_named = isinstance(files, SceneFiles) and files.order == "as-named"
    offset_px = original.calibration.offset_px if original and original.calibration else 0.0

    def make(inputs: Inputs) -> DisparityMap:
        views, chosen = _views(grid), _configured(config, "depth")
        made = estimated(chosen, chosen.method.estimate, views)
        if not as_named:
            made = _in_order(made, views, offset_px / grid.factor)
        found = in_pictures_pixels(made, grid)
        if views.right is not None:
            said = unmatched.same_twice(views, found) or unmatched.hardly_matched(found, grid.known)
            if said:
                doubt(log, said)
        return found

    name, key = _identity(config.depth)
    code = " ".join(_core(each.__name__) for each in (scaling, view_order, unmatched))
    key = f"{code} {as_named} {key} {grid.key}"
    skip, refusal = _skip(config.depth, grid.scene), _no_depth(config, grid.scene)
    return Rule("disparity", name, key, ("views",), make, grid.whole_disparity, skip, grid.note, refusal=refusal)


def _relief(config: PipelineConfig, grid: WorkingGrid) -> Rule:
    size = config.size

    def make(inputs: Inputs) -> Relief:
        disparity: DisparityMap | None = inputs["disparity"]
        if disparity is None:
            return geometry.flat_relief(_views(grid).shape, size.width_m)
        return relief_of(scaling.reduced_disparity(disparity, grid.shape), grid, size)

    key = f"{_core(geometry.__name__)} {size!r}{_reduction(grid)}"
    return Rule("relief", "core", key, ("views", "disparity"), make)


def estimated(
    chosen: NamedMethod[DepthEstimator], estimate: Callable[[Views], DisparityMap], views: Views
) -> DisparityMap:
    """What the depth method makes of these views. Raises: BrokenMethod for a map of another size; what it raises."""
    made = estimate(views)
    _check_shape("depth", chosen, "disparity", made.disparity_px.shape, views.shape)
    return made


def in_pictures_pixels(made: DisparityMap, grid: WorkingGrid) -> DisparityMap:
    """The disparity of what is felt, on its grid, in pixels of the pictures, unknown where they are."""
    return working_grid.known_disparity(scaling.in_pixels_of(made, grid.scene.shape[1]), grid.known)


def relief_of(
    disparity: DisparityMap, grid: WorkingGrid, size: FeltSize, spans: geometry.ValueRange | None = None
) -> Relief:
    """The relief of a disparity on the grid that is felt. spans: as `geometry.make_relief`."""
    calibration = grid.scene.views.calibration if grid.scene.views else None
    relief = geometry.make_relief(disparity, calibration, size.width_m, size.relief_m, size.holes, spans)
    return working_grid.grounded(geometry.smooth(relief, size.smooth_m), grid.shown)


def _relief_of_parts(config: PipelineConfig, grid: WorkingGrid) -> Rule:
    heights, size, given_m = config.heights, config.size, config.given_heights_m
    assert heights is not None

    def make(inputs: Inputs) -> Relief:
        views, parts = _views(grid), _on_grid(config, inputs[config.felt_parts], grid)
        found = part_heights(config, grid, inputs[config.felt_parts], inputs.get("disparity"))
        heights_of_parts.warn_missing_heights(found, heights, given_m)
        layering = Layering(parts, size.width_m, heights, views.left)
        return working_grid.layered(layering, found.heights_m, size, grid.shown)

    code = " ".join(_core(each) for each in (heights_of_parts.__name__, Layering.__module__, geometry.__name__))
    key = f"{code} {size!r} {heights!r} {sorted(given_m.items())}{_reduction(grid)}"
    if heights.by == "depth":
        return Rule("relief", "core", key, ("views", config.felt_parts, "disparity"), make)
    said = "given" if heights.by == "given" else "guessed"
    return Rule(
        "relief", "core", key, ("views", config.felt_parts), make, note=f"no depth is looked for: heights are {said}"
    )


def part_heights(
    config: PipelineConfig, grid: WorkingGrid, parts: PartMap, disparity: DisparityMap | None
) -> PartHeights:
    """The height of each part, and why. parts, disparity: of any size; both are taken as they are felt."""
    assert config.heights is not None
    if disparity is not None:
        disparity = scaling.reduced_disparity(disparity, grid.shape)
    on_grid = _on_grid(config, parts, grid)
    return heights_of_parts.heights_of(
        on_grid, config.heights, config.top_m, config.given_heights_m, disparity, grid.shown
    )


def _segments(config: PipelineConfig, grid: WorkingGrid) -> Rule:
    def make(inputs: Inputs) -> SegmentMap:
        views, chosen = _views(grid), _configured(config, "texture")
        made = chosen.method.segment(views.left)
        _check_shape("texture", chosen, "labels", made.labels.shape, views.shape)
        return working_grid.with_ground(working_grid.known_segments(made, grid.known), grid.shown)

    skip = _skip(config.texture, grid.scene)
    if config.texture is None:
        skip = "no `texture:` is configured; the whole surface is one material"
    elif grid.scene.views is None:
        skip = "the scene has heights and no picture"
    name, key = _identity(config.texture)
    key = f"{_core(scaling.__name__)} {key} {grid.key}"
    return Rule("segments", name, key, ("views",), make, grid.whole_segments, skip, grid.note)


def _parts(config: PipelineConfig, grid: WorkingGrid, unsegmented: str | None) -> Rule:
    def make(inputs: Inputs) -> PartMap:
        found = part_validation.parts_of(inputs["segments"])
        part_validation.tell_slips(found)
        return found

    by_parts = config.by_parts
    skip = f"there are no segments: {unsegmented}" if unsegmented and not by_parts else None
    return Rule(
        "parts", "core", _core(part_finding.__name__), ("segments",), make, grid.whole_parts, skip,
        refusal=_no_parts(config) if unsegmented and by_parts else None,
        finish=_check(config, grid),
        usual=by_parts,
    )  # fmt: skip


def _check(config: PipelineConfig, grid: WorkingGrid) -> Callable[[PartMap], PartMap] | None:
    """What is said of parts is held against those that are there, whenever they are handed on."""

    def checked(found: PartMap) -> PartMap:
        part_validation.check_found(config, found, grid.scene.shape[1])
        return found

    return checked if config.by_parts else None


def _simplified(config: PipelineConfig, grid: WorkingGrid, unsegmented: str | None) -> Rule:
    """On a grid of its own, and with the numbers of the parts."""
    choice, width_m, names = config.simplify or SimplifyChoice(), config.size.width_m, config.part_names

    def make(inputs: Inputs) -> PartMap:
        parts: PartMap = inputs["parts"]
        named = names_of(config.parts or {}, parts.count)
        return simplify(parts, width_m, choice, named, grid.views.left if grid.views else None)

    skip = f"there are no segments: {unsegmented}" if unsegmented and not config.by_parts else None
    key = f"{_core(simplify.__module__)} {width_m} {choice!r} {sorted(names.items())} {grid.key}"
    return Rule(
        "simplified", "core", key, ("views", "parts"), make, skip=skip,
        finish=_check(config, grid),
        usual=config.simplify is not None,
    )  # fmt: skip


def _on_grid(config: PipelineConfig, parts: PartMap, grid: WorkingGrid) -> PartMap:
    return working_grid.parts_on_grid(parts, grid.shape, config.felt_parts)


def _no_parts(config: PipelineConfig) -> ConfigError:
    """Why a scene without segments has no parts."""
    key = "heights" if config.heights else "parts" if config.parts is not None else "simplify"
    cure = "give it a label picture, `segments:` under `scene:`, or name a method under `texture:` that finds segments"
    return config.complained(((key,), f"parts are pieces of segments, and the scene has none; {cure}"))


def _materials(config: PipelineConfig, grid: WorkingGrid, unsegmented: str | None, found: bool) -> Rule:
    choice = config.materials
    library = assignment.load_library(choice.library)

    by_parts, rules_by_number, own = (
        config.by_parts,
        part_validation.numbered(config),
        part_validation.own_materials(config),
    )

    def make(inputs: Inputs) -> MaterialMap:
        picture = grid.views.left if grid.views else None
        if by_parts:
            segments = _on_grid(config, inputs[config.felt_parts], grid)
            ground = heights_of_parts.hidden(segments, grid.shown)
        else:
            segments = scaling.reduced_segments(inputs["segments"], grid.shape)
            ground = [segments.count - 1] if found and grid.shown is not None else []
        return assignment.assign(
            segments, picture, choice.by, library, rules_by_number, choice.default, grid.scene.shape, ground, own
        )

    said = choice.model_copy(update={"rules": rules_by_number}).model_dump(exclude={"library"})
    key = f"{_core(assignment.__name__)} {said} {_library_digest(tuple(library.values()))}{_reduction(grid)}"
    if by_parts:
        key = f"{key} {sorted(own.items())} {_core(part_finding.__name__)}"
        return Rule(
            "materials", "core", key, ("views", config.felt_parts), make,
            finish=lambda made: part_validation.reasons_with_names(config, made),
        )  # fmt: skip
    skip = f"there are no segments: {unsegmented}" if unsegmented else None
    return Rule("materials", "core", key, ("views", "segments"), make, skip=skip)


def _surface(config: PipelineConfig, grid: WorkingGrid) -> Rule:
    with_materials = config.render is None or config.render.method.uses_materials
    key = f"{_core(HapticSurface.__module__)}{_reduction(grid)}"
    if config.by_parts:
        return _surface_of_parts(config, grid, f"{key} {_core(part_finding.__name__)}", with_materials)

    def make(inputs: Inputs) -> HapticSurface:
        segments: SegmentMap | None = inputs.get("segments")
        chosen: MaterialMap | None = inputs.get("materials")
        if segments is None or chosen is None:
            return HapticSurface(inputs["relief"])
        labels = scaling.reduced_segments(segments, grid.shape).labels
        return HapticSurface(inputs["relief"], labels, chosen.materials)

    needs = ("relief", "segments", "materials") if with_materials else ("relief",)
    return Rule("surface", "core", key, needs, make)


def _surface_of_parts(config: PipelineConfig, grid: WorkingGrid, key: str, with_materials: bool) -> Rule:
    """Its labels are the numbers of parts, and there for their names alone where the law uses no materials."""

    def make(inputs: Inputs) -> HapticSurface:
        parts, chosen = _on_grid(config, inputs[config.felt_parts], grid), inputs.get("materials")
        return HapticSurface(inputs["relief"], parts.labels, chosen.materials if chosen else None, ("",) * parts.count)

    parts = config.felt_parts
    first = ("relief", parts) if config.heights else (parts, "relief")  # what is wrong of parts, before a depth
    needs = (*first, "materials") if with_materials else first
    return Rule(
        "surface", "core", key, needs, make, finish=lambda made: part_validation.surface_with_names(config, made)
    )


def _touch(config: PipelineConfig) -> Rule:
    def make(inputs: Inputs) -> Touch:
        chosen, device = _configured(config, "render"), config.felt_device
        surface, said = fitted(inputs["surface"], config, device) if device else (inputs["surface"], "")
        if said:
            note(log, said)
        return chosen.method.touch(surface)

    refusal = config.missing("render") if config.render is None else None
    return Rule("touch", *_identity(config.render), ("surface",), make, cached=False, refusal=refusal)


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


def method_identities(config: PipelineConfig) -> str:
    """What results depend on of the code and the options of all methods, in one text."""
    return "\n".join(" ".join(_identity(each)) for each in (config.depth, config.texture, config.render))


def _identity(chosen: NamedMethod[Any] | None) -> tuple[str, str]:
    """A method's name, and everything its results depend on: where it comes from, its code, version and options."""
    if chosen is None:
        return "", ""
    method: Method = chosen.method
    cls = type(method)
    code = closure(cls.__module__)
    digest = code.digest if code.modules else source_digest(cls) or uuid4().hex
    options = method.model_dump()  # not as JSON, to which infinity and nothing are the same
    read = "".join(f" {content_digest(path)}" for path in method.reads())
    return chosen.name, f"{chosen.origin} {cls.__module__}:{cls.__qualname__} {digest} v{cls.version} {options}{read}"


@cache
def _library_digest(materials: tuple[Material, ...]) -> str:
    """Kept, as a library has hundreds of values and hardly ever changes within a process."""
    return digest_of(materials)


def _core(module: str) -> str:
    """The code of the core's part: a module, this table, and what keeps a result."""
    return closure(module, alone=(__name__, working_grid.__name__, Cache.__module__)).digest


def _reduction(grid: WorkingGrid) -> str:
    """What else a product depends on that is made of products of the pictures' size, where that is not felt."""
    plain = grid.factor == 1 and grid.scene.shown is None
    return "" if plain else f" {_core(scaling.__name__)} {grid.key}"


def _skip(chosen: NamedMethod[Any] | None, scene: Scene) -> str | None:
    if chosen is not None and isinstance(chosen.method, Skippable) and scene.views is not None:
        return chosen.method.skip(scene.views)
    return None


def _in_order(made: DisparityMap, views: Views, offset_px: float) -> DisparityMap:
    """The map, put right where its views were exchanged."""
    if views.right is None:
        return made
    order = view_order.view_order(made, views.left, offset_px)
    if order.said:
        note(log, order.said, logging.WARNING if order.exchanged else logging.INFO)
    return view_order.put_right(made) if order.exchanged else made


def _no_depth(config: PipelineConfig, scene: Scene) -> TangibleError | None:
    """Why no depth can be found in this scene, before anything looks."""
    if scene.views is None:
        return _pictureless(scene)
    if config.depth is None:
        return config.missing("depth")
    if config.depth.method.needs_pair and scene.views.right is None:
        give = (
            "say how they lie in it, such as `layout: side-by-side`"
            if scene.video
            else "give both, `left:` and `right:`"
        )
        return PictureError(
            f"depth method {config.depth.name} needs two views, and the scene {scene.name} has one: {give}, "
            "or name a method for one picture (`tangible plugins` lists them)"
        )
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


def _views(grid: WorkingGrid) -> Views:
    if grid.views is None:
        raise _pictureless(grid.scene)
    return grid.views


def _pictureless(scene: Scene) -> ConfigError:
    return ConfigError(f"the scene {scene.name} has no picture; give one with `photo:` or `left:` and `right:`")

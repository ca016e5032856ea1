"""Views of a pipeline: what was made of it, without making anything first."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.data import (
    DisparityMap,
    HapticSurface,
    Material,
    PartMap,
    Product,
    Relief,
    SegmentMap,
    digest_of,
    to_rgb8,
)
from tangible_core.files import without_folders
from tangible_core.metrics import absolute_error
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import PipelineConfig, all_part_names
from tangible_core.pipeline.engine import fit_to_device, is_at_hand, parts_on_grid, product_at_hand
from tangible_core.scene import RANGE_PERCENT, flat_relief, reduced_map, reduced_segments, reduced_shape

Shows = Literal["surface", "relief", "segments"]
MAX_LAYER_CELLS = 1_000_000  # maximum number of cells of layers, which are only looked at


class Layer(NamedTuple):
    """Values to drape over the surface, NaN where unknown; colours run from low to high."""

    values: Float32[np.ndarray, "h w"]
    unit: str
    low: float
    high: float

    @classmethod
    def of(cls, values: np.ndarray, unit: str, span: tuple[float, float] | None = None) -> "Layer":
        """Build a layer, reduced if it is large. span: low and high; by default percentiles of the values."""
        factor = max(1.0, (values.size / MAX_LAYER_CELLS) ** 0.5)
        small = reduced_map(np.ascontiguousarray(values, np.float32), reduced_shape(values.shape, factor))
        finite = small[np.isfinite(small)]
        if span is None:
            low, high = np.percentile(finite, RANGE_PERCENT) if finite.size else (0.0, 0.0)
            span = float(low), float(high)
        return cls(small, unit, *span)


@dataclass(frozen=True)
class SurfaceView:
    """A surface to draw, or what there is of one."""

    name: str
    # Heights and materials; heights alone; or segments over whatever heights there are, flat without any.
    shows: Shows
    relief: Relief
    labels: Int32[np.ndarray, "h w"] | None
    materials: tuple[Material, ...]  # materials by label, as the device renders them; empty if there are none
    picture: np.ndarray | None
    layers: dict[str, Layer]
    names: tuple[str, ...] | None = None  # names of the parts by label; None if the labels are not parts

    @property
    def surface(self) -> HapticSurface:
        """The surface to describe in words."""
        if self.materials or self.names:
            return HapticSurface(self.relief, self.labels, self.materials or None, self.names)
        return HapticSurface(self.relief)

    @cached_property
    def digest(self) -> str:
        """Digest of everything that is drawn."""
        layers = tuple((name, *layer) for name, layer in sorted(self.layers.items()))
        parts = (self.name, self.shows, self.relief, self.labels, self.materials, self.picture, layers, self.names)
        return digest_of(parts)


def make_view(pipeline: Pipeline, product: str) -> SurfaceView:
    """Return the view once this product is made. Raises: as `make`, if no relief can be made of a depth."""
    if product in ("surface", "touch"):
        return _on_device(_view(pipeline, "surface", pipeline.surface.relief), pipeline.surface, pipeline.config)
    if product in ("disparity", "relief"):
        return _view(pipeline, "relief", pipeline.relief)
    return _view_segments(pipeline)


def view_parts(pipeline: Pipeline, surface: HapticSurface, before: SurfaceView | None) -> SurfaceView:
    """Return the view of a surface whose parts have other heights or materials. before: the last view."""
    view = before or _view(pipeline, "surface", surface.relief)
    return _on_device(replace(view, relief=surface.relief), surface, pipeline.config)


def _on_device(view: SurfaceView, surface: HapticSurface, config: PipelineConfig) -> SurfaceView:
    if config.felt_device is not None:
        surface, _ = fit_to_device(surface, config, config.felt_device)
    if surface.labels is None:
        return view
    return replace(view, labels=surface.labels, materials=surface.materials or (), names=surface.names)


def _view_segments(pipeline: Pipeline) -> SurfaceView:
    """Return the view of segments over the relief, or over a flat picture without one."""
    if is_at_hand(pipeline.engine, "relief"):
        relief = pipeline.relief
    else:
        segments = pipeline.engine.make_on_grid("segments")
        shape = pipeline.scene.shape if segments is None else segments.labels.shape
        relief = flat_relief(shape, pipeline.config.size.width_m)
    return _view(pipeline, "segments", relief)


def _view(pipeline: Pipeline, shows: Shows, relief: Relief) -> SurfaceView:
    labels = _labels(pipeline, relief.height_m.shape)
    choice = product_at_hand(pipeline.engine, "materials")
    materials = choice.materials if choice is not None and labels is not None else ()
    picture = None if pipeline.scene.views is None else pipeline.scene.views.left
    if picture is not None and (opaque := pipeline.scene.shown) is not None:  # transparent ground is white paper
        picture = np.where(opaque[..., None], to_rgb8(picture), np.uint8(255))
    names = _names(pipeline) if labels is not None else None
    name = pipeline.config.title.strip() or Path(without_folders(pipeline.scene.name)).name
    return SurfaceView(name, shows, relief, labels, materials, picture, _layers(pipeline), names)


def _names(pipeline: Pipeline) -> tuple[str, ...] | None:
    """Return the names of the parts; None if nothing is by parts."""
    config = pipeline.config
    parts: PartMap | None = product_at_hand(pipeline.engine, config.felt_parts) if config.by_parts else None
    return None if parts is None else all_part_names(config, parts.count)


def _labels(pipeline: Pipeline, shape: tuple[int, int]) -> Int32[np.ndarray, "h w"] | None:
    """Return labels of the parts if anything is by parts, else of the segments; None if they are not made."""
    parts = pipeline.config.felt_parts
    product: Product = parts if pipeline.config.by_parts else "segments"
    segments = product_at_hand(pipeline.engine, product)
    if segments is None:
        return None
    return (
        reduced_segments(segments, shape) if product == "segments" else parts_on_grid(segments, shape, parts)
    ).labels


def _layers(pipeline: Pipeline) -> dict[str, Layer]:
    layers: dict[str, Layer] = {}
    engine = pipeline.engine  # a depth that lies in the cache, and that nothing is made of, would warn of itself
    used = "disparity" in engine.all_inputs("relief") or "disparity" in engine.scene_products
    disparity: DisparityMap | None = product_at_hand(engine, "disparity") if used else None
    if disparity is not None:
        unit = "px" if disparity.unit == "px" else ""
        layers["disparity"] = Layer.of(disparity.disparity_px, unit)
        layers["confidence"] = Layer.of(disparity.confidence, "", (0.0, 1.0))
        layers |= _error(pipeline, disparity)
    segments: SegmentMap | None = product_at_hand(pipeline.engine, "segments")
    if segments is not None and float(segments.confidence.min()) < 1:
        layers["certainty"] = Layer.of(segments.confidence, "", (0.0, 1.0))
    return layers


def _error(pipeline: Pipeline, disparity: DisparityMap) -> dict[str, Layer]:
    """Return the distance of the disparity from the truth, if the scene has one."""
    truth, whole = pipeline.scene.truth, pipeline.disparity
    if truth is None or whole is None or disparity.unit != "px" or truth.shape != whole.disparity_px.shape:
        return {}
    error_px = absolute_error(whole.disparity_px, truth)
    finite = error_px[np.isfinite(error_px)]
    return {"error": Layer.of(error_px, "px", (0.0, float(np.percentile(finite, 98)) if finite.size else 0.0))}

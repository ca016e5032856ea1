"""The surface: the relief, with materials and parts where there are any."""

from functools import cached_property

from ....data import HapticSurface, MaterialMap, SegmentMap
from ....parts import find as part_finding
from ....scene import scaling
from ..part_validation import add_names_to_surface
from ..stage import Inputs, Stage


class SurfaceStage(Stage):
    """Combine relief, labels and materials; by parts, the labels are the numbers of parts."""

    product = "surface"

    @property
    def _with_materials(self) -> bool:
        return self.config.render is None or self.config.render.method.uses_materials

    @property
    def needs(self) -> tuple[str, ...]:
        config = self.config
        if not config.by_parts:
            return ("relief", "segments", "materials") if self._with_materials else ("relief",)
        parts = config.felt_parts
        first = ("relief", parts) if config.heights else (parts, "relief")  # complaints about parts before a depth
        return (*first, "materials") if self._with_materials else first

    @cached_property
    def key(self) -> str:
        key = f"{self.code(HapticSurface.__module__)}{self.reduction}"
        return f"{key} {self.code(part_finding.__name__)}" if self.config.by_parts else key

    def make(self, inputs: Inputs) -> HapticSurface:
        materials: MaterialMap | None = inputs.get("materials")
        if self.config.by_parts:
            parts = self.grid.parts(inputs[self.config.felt_parts], self.config.felt_parts)
            chosen_materials = materials.materials if materials else None
            return HapticSurface(inputs["relief"], parts.labels, chosen_materials, ("",) * parts.count)
        segments: SegmentMap | None = inputs.get("segments")
        if segments is None or materials is None:
            return HapticSurface(inputs["relief"])
        labels = scaling.reduced_segments(segments, self.grid.shape).labels
        return HapticSurface(inputs["relief"], labels, materials.materials)

    def finish(self, value: HapticSurface) -> HapticSurface:
        return add_names_to_surface(self.config, value) if self.config.by_parts else value

"""The simplified parts: large enough for fingers, on a grid in millimetres, with the numbers of the parts."""

from functools import cached_property

from ....data import PartMap
from ....drawing import PictureKind
from ....parts import SimplifyChoice
from ...config.part_checks import all_part_names
from ..hooked import has_figure, legibility_point, simplify_function
from ..stage import Inputs
from .parts import OfPartsStage

# The most colours of a flat drawing that stay apart, as many as have letters on a page.
MAX_COLOURS = 100


class SimplifiedStage(OfPartsStage):
    """Make the parts legible for fingers."""

    product = "simplified"

    @property
    def needs(self) -> tuple[str, ...]:
        return "views", "parts", *(("figure",) if has_figure(self.config, self.context.registry) else ())

    @property
    def _choice(self) -> SimplifyChoice:
        if self.config.simplify is not None:
            return self.config.simplify
        drawing = self.context.scene.kind.likely == PictureKind.drawing  # no two of its colours become one
        return SimplifyChoice(textures=MAX_COLOURS) if drawing else SimplifyChoice()

    @cached_property
    def key(self) -> str:
        names = sorted(self.config.part_names.items())
        code = self.code(legibility_point(self.context.registry, "simplify").module)
        widths_m = self.config.felt_widths_m or self.config.size.width_m
        return f"{code} {widths_m} {self._choice!r} {names} {self.grid.key}"

    def make(self, inputs: Inputs) -> PartMap:
        parts: PartMap = inputs["parts"]
        names = all_part_names(self.config, parts.count)
        picture = self.grid.views.left if self.grid.views else None
        simplify = simplify_function(self.context.registry)
        front = {"front": inputs["figure"].front_parts(parts)} if "figure" in self.needs else {}
        widths_m = self.config.felt_widths_m or (self.config.size.width_m,)
        for width_m in widths_m:  # a thin end that is short on one is long on a wider one
            parts = simplify(parts, width_m, self._choice, names, picture, **front)
        return parts

    @property
    def in_outcomes(self) -> bool:
        return self.config.felt_parts == self.product

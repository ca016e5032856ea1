"""The segments: by a texture method, from the left picture."""

from functools import cached_property

from ....data import SegmentMap
from ....scene import scaling
from ..stage import Inputs, MethodStage
from ..working_grid import add_ground_segment, known_segments


class SegmentsStage(MethodStage):
    """Divide the left picture into segments of one texture each."""

    product = "segments"
    kind = "texture"

    @property
    def needs(self) -> tuple[str, ...]:
        return ("views",)

    @cached_property
    def key(self) -> str:
        return f"{self.code(scaling.__name__)} {self.identity[1]} {self.grid.key}"

    def make(self, inputs: Inputs) -> SegmentMap:
        views = self.views
        segments = self.required_choice.method.segment(views.left)
        self.check_shape("labels", segments.labels.shape, views.shape)
        return add_ground_segment(known_segments(segments, self.grid.known_mask), self.grid.opaque_mask)

    def full_size(self, value: SegmentMap) -> SegmentMap:
        return self.grid.full_segments(value)

    @cached_property
    def skip(self) -> str | None:
        if self.config.texture is None:
            return "no `texture:` is configured; the whole surface is one material"
        if self.grid.views is None:
            return "the scene has heights and no picture"
        return super().skip

    @property
    def note(self) -> str:
        return self.grid.note

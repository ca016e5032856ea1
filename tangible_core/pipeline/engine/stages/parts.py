"""The parts: connected pieces of the segments."""

from functools import cached_property

from ....data import PartMap, SegmentMap
from ....errors import ConfigError
from ....parts import find as part_finding
from ..part_validation import check_parts, divide_segments, warn_small_parts
from ..stage import Context, Inputs, Stage


class OfPartsStage(Stage):
    """The base of a stage whose product is a map of parts."""

    def finish(self, value: PartMap) -> PartMap:
        if self.config.by_parts:
            check_parts(self.config, value, self.context.scene.shape[1])
        return value

    @cached_property
    def skip(self) -> str | None:
        return missing_segments(self.context)


class PartsStage(OfPartsStage):
    """Divide segments into connected parts, numbered by their first pixels."""

    product = "parts"

    @property
    def needs(self) -> tuple[str, ...]:
        return ("segments",)

    def __init__(self, context: Context) -> None:
        """Check the segments of the scene, if it has any. Raises: ConfigError for configured parts that they lack."""
        super().__init__(context)
        segments = context.scene_products.get("segments")
        if self.config.by_parts and isinstance(segments, SegmentMap):
            self.finish(divide_segments(segments))

    @cached_property
    def key(self) -> str:
        return self.code(part_finding.__name__)

    def make(self, inputs: Inputs) -> PartMap:
        parts = divide_segments(inputs["segments"])
        warn_small_parts(parts)
        return parts

    def full_size(self, value: PartMap) -> PartMap:
        return self.grid.full_parts(value)

    @cached_property
    def refusal(self) -> ConfigError | None:
        if not (self.config.by_parts and self.context.no_segments):
            return None
        config = self.config
        key = "heights" if config.heights else "parts" if config.parts is not None else "simplify"
        cure = (
            "give it a label picture, `segments:` under `scene:`, or name a method under `texture:` that finds segments"
        )
        return config.error_at(((key,), f"parts are pieces of segments, and the scene has none; {cure}"))

    @property
    def in_outcomes(self) -> bool:
        return self.config.by_parts


def missing_segments(context: Context) -> str | None:
    """Return why nothing is made of segments; None where there are some, or where the configuration demands parts."""
    reason = context.no_segments
    return f"there are no segments: {reason}" if reason and not context.config.by_parts else None

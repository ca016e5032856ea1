"""The materials: one for each segment, or for each part where anything is by parts."""

from functools import cached_property

from ....data import MaterialMap
from ....materials import assignment
from ....parts import find as part_finding
from ....scene import scaling
from ..part_validation import add_names_to_reasons, number_rules, own_materials
from ..stage import Context, Inputs, Stage, library_digest
from ..working_grid import transparent_parts
from .parts import missing_segments


class MaterialsStage(Stage):
    """Choose a material for each label of the surface."""

    product = "materials"

    def __init__(self, context: Context) -> None:
        """Read the library. Raises: MaterialError for a library that cannot be read."""
        super().__init__(context)
        self._library = assignment.load_library(self.config.materials.library)
        self._rules = number_rules(self.config)
        self._own = own_materials(self.config)

    @property
    def needs(self) -> tuple[str, ...]:
        return "views", self.config.felt_parts if self.config.by_parts else "segments"

    @cached_property
    def key(self) -> str:
        choice = self.config.materials.model_copy(update={"rules": self._rules}).model_dump(exclude={"library"})
        library = library_digest(tuple(self._library.values()))
        key = f"{self.code(assignment.__name__)} {choice} {library}{self.reduction}"
        if self.config.by_parts:
            key = f"{key} {sorted(self._own.items())} {self.code(part_finding.__name__)}"
        return key

    def make(self, inputs: Inputs) -> MaterialMap:
        config, grid = self.config, self.grid
        if config.by_parts:
            labels = grid.parts(inputs[config.felt_parts], config.felt_parts)
            ground = transparent_parts(labels, grid.opaque_mask)
        else:
            labels = scaling.reduced_segments(inputs["segments"], grid.shape)
            by_method = "segments" not in self.context.scene_products
            ground = [labels.count - 1] if by_method and grid.opaque_mask is not None else []
        choice, picture = config.materials, grid.views.left if grid.views else None
        return assignment.assign(
            labels, picture, choice.by, self._library, self._rules, choice.default, grid.scene.shape, ground, self._own
        )

    def finish(self, value: MaterialMap) -> MaterialMap:
        return add_names_to_reasons(self.config, value) if self.config.by_parts else value

    @cached_property
    def skip(self) -> str | None:
        return missing_segments(self.context)

"""What networks see in the picture: a figure, borders, faces."""

from functools import cached_property

from ....data import Figure
from ....errors import ModelAbsent, TangibleError
from ..hooked import look_function, networks_identity
from ..stage import Inputs, Stage


class FigureStage(Stage):
    """Look at the left view with the networks that are here."""

    product = "figure"

    @property
    def needs(self) -> tuple[str, ...]:
        return ("views",)

    @cached_property
    def key(self) -> str:
        look = look_function(self.context.registry)
        return f"{self.code(look.__module__)} {networks_identity(self.context.registry)}{self.reduction}"

    def make(self, inputs: Inputs) -> Figure:
        return look_function(self.context.registry)(self.views.left)

    @cached_property
    def refusal(self) -> TangibleError | None:
        if networks_identity(self.context.registry):
            return None
        return ModelAbsent(
            "relief: figure needs networks, and none is here; `tangible networks add figure borders faces` fetches "
            "them, and `relief: edges` needs none"
        )

    @property
    def in_outcomes(self) -> bool:
        return self.config.relief_kind == "figure"

"""What a pipeline will do, and what became of its products."""

from dataclasses import dataclass
from typing import Literal

Kind = Literal["depth", "texture", "render", "device"]


OutcomeKind = Literal["given", "ran", "cached", "skipped", "failed"]


@dataclass(frozen=True)
class Outcome:
    """What became of one product, and why."""

    product: str
    outcome: OutcomeKind
    why: str
    method: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Plan:
    """What asking for a product will do: one outcome a product, in order, nothing run."""

    want: str
    steps: tuple[Outcome, ...]

"""The kinds of question, and the entry points of procedures: ours, and others of the group `tangible.procedure`."""

from importlib.metadata import EntryPoint, distribution, entry_points

from tangible_core.plugins.naming import origin
from tangible_core.plugins.registry import Listing

QUESTIONS = ("rougher", "higher", "same", "different", "equal", "name", "rating")
"""The kinds of question, each a file in `questions/kinds/`."""
GROUP = "tangible.procedure"
# Our own procedures below `procedures/`, which no other package can replace.
OURS = {
    "constant": "listed:Constant",
    "2afc": "listed:TwoAfc",
    "oddity": "listed:Oddity",
    "same-different": "listed:SameDifferent",
    "quest": "quest:Quest",
    "adjustment": "listed:Adjustment",
    "naming": "listed:Naming",
    "rating": "listed:Rating",
}


def points() -> dict[str, EntryPoint]:
    """Return the entry points of all installed procedures by name, ours first. Nothing is imported."""
    others = {entry_point.name: entry_point for entry_point in entry_points(group=GROUP)}
    ours = {name: EntryPoint(name, f"{__package__}.procedures.{place}", GROUP) for name, place in OURS.items()}
    return {**ours, **{name: point for name, point in others.items() if name not in ours}}


def procedure_listings() -> list[Listing]:
    """Return all installed procedures as `tangible plugins` lists them. Nothing is imported."""
    own = distribution("tangible-images")
    return [
        Listing("procedure", name, point.value, str(origin(point.dist or own)), point)
        for name, point in points().items()
    ]

"""Plans: the outcome of each product, foreseen before anything is made."""

from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from ...data import Note, Outcome, Record
from .cache import Cache
from .stage import Stage

REQUESTED = "requested"
NOT_NEEDED = "not needed for what was requested"
WITHIN_CACHED = "within an unchanged product"
SAME = "unchanged"


class Outlook(NamedTuple):
    """The part of an engine that a plan looks at."""

    stages: Mapping[str, Stage]
    scene_products: Mapping[str, Record]
    # The function that returns where a given product comes from, with its notes.
    describe_source: Callable[[str], tuple[str, tuple[Note, ...]]]
    cache_for: Callable[[Stage], Cache | None]
    key: Callable[[str], str]


def needed_for(product: str) -> str:
    """Return why a product is made that was not requested itself."""
    return f"needed for the {product}"


def depends_on(stages: Mapping[str, Stage], name: str, products: Container[str]) -> bool:
    """Return True for these products and for all that is made of them."""
    needs = stages[name].needs if name in stages else ()
    return name in products or any(depends_on(stages, need, products) for need in needs)


def foresee(engine: Outlook, product: str, why: str, steps: dict[str, Outcome]) -> dict[str, Outcome]:
    """Add the outcomes of a product and, before it, of the products that it needs; return all steps."""
    stage = engine.stages.get(product)
    if product in steps:
        return steps
    if stage is None:
        if product in engine.scene_products:
            why, notes = engine.describe_source(product)
            steps[product] = Outcome(product, "given", why, notes=notes)
    elif stage.skip:
        steps[product] = Outcome(product, "skipped", stage.skip, stage.method)
    elif (cache := engine.cache_for(stage)) and engine.key(product) in cache:
        entry_notes = cache.notes(engine.key(product))
        within = (
            note
            for name in sorted(entry_notes)
            if name != product
            for note in entry_notes[name]
            if note.kind != "decision"
        )
        notes = (*entry_notes.get(product, ()), *within)
        steps[product] = Outcome(product, "cached", with_notes(notes, SAME), stage.method, notes=notes)
    elif stage.refusal is not None:
        steps[product] = Outcome(product, "refused", str(stage.refusal), stage.method)
    else:
        for name in stage.needs:
            foresee(engine, name, needed_for(product), steps)
            if any(step.outcome == "refused" for step in steps.values()):
                return steps
        notes = notes_ahead(stage)
        steps[product] = Outcome(product, "ran", with_notes(notes, why), stage.method, notes=notes)
    return steps


def not_needed(stage: Stage, notes: Sequence[Note]) -> Outcome:
    """Return the outcome of a product that no request needed; with notes, it is within a cached product."""
    why = with_notes(notes, WITHIN_CACHED) if notes else NOT_NEEDED
    return Outcome(stage.product, "skipped", why, stage.method, notes=tuple(notes))


def notes_ahead(stage: Stage) -> tuple[Note, ...]:
    """Return the stage's note on work that this scene does not need."""
    return (Note(stage.note),) if stage.note else ()


def with_notes(notes: Iterable[Note], why: str) -> str:
    """Append the texts of notes to a reason."""
    return "; ".join([why, *(note.text for note in notes)])


# The value of a product that is not made yet; None is the value of a skipped one.
NOT_MADE: Final = object()


@dataclass
class ProductEntry:
    """A product of a stage at the steps of its making, each made once and on request."""

    key: str | None = None  # the text that identifies its content before it is made
    value: Any = NOT_MADE  # the product as the stage or the cache returned it, on the working grid
    result: Any = NOT_MADE  # the product checked, and with names
    full_size: Any = NOT_MADE  # the finished product for every pixel of the pictures
    # The notes from when it was made, in this process or before; None while unknown.
    notes: tuple[Note, ...] | None = None

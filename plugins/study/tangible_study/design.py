"""The design of a study: the keys of its file, and its trials."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

from pydantic import Field

from tangible_core.data import Quantities
from tangible_core.scene import Section

from .points import QUESTIONS

if TYPE_CHECKING:
    Question = str
else:
    Question = Literal[QUESTIONS]
Order = Literal["latin-square", "random", "as-written"]
Sound = Literal["contact", "texture", "force", "height"]


class Condition(Section):
    """A condition: a pipeline, and the values in which it differs from others."""

    pipeline: Path | None = None
    """Pipeline file; by default that of the study."""
    set: Annotated[dict[str, Any], Field(default_factory=dict)]
    """Values of its keys, such as `render.use: penalty`, as `--set` takes them."""


class Scale(Section):
    """A scale for ratings in whole numbers."""

    of: str = ""
    """Word for what is rated, such as the roughness, in the language of the participants."""
    least: Annotated[int, Field(ge=0, le=9)] = 1
    """The least rating."""
    most: Annotated[int, Field(ge=1, le=9)] = 7
    """Greatest rating; each rating is a key."""
    ends: tuple[str, str] | None = None
    """Words for both ends of the scale."""


class Comparison(Section):
    """A comparison: its question, its procedure, and what is compared."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9]+(-[a-z0-9]+)*$", max_length=40)]
    """Name of the comparison in the results: lower-case words joined by hyphens."""
    question: Question
    """Kind of the question after each trial."""
    procedure: Annotated[dict[str, Any], Field(default_factory=dict)]
    """Procedure, with its options."""
    conditions: tuple[str, ...] = ()
    """Names of the conditions that take part; by default all."""
    vary: str = ""
    """Key of the pipeline that varies by level, such as `workspace.relief_m`."""
    levels: Annotated[tuple[float, ...], Field(max_length=100)] = ()
    """Values of this key, in rising order; a greater one is more of what the question is about."""
    standard: float | None = None
    """Value of this key to which each level is compared."""
    unit: str = ""
    """Unit of the levels, for the table of results."""
    names: Annotated[tuple[str, ...], Field(max_length=9)] = ()
    """Names of the parts that are to be named; each is a key."""
    scale: Scale = Scale()
    """Scale of a rating."""
    repetitions: Annotated[int, Field(ge=1, le=1000)] = 10
    """Number of trials of each condition and level; for `quest` and `adjustment`, of each condition."""
    training: Annotated[int, Field(ge=0, le=100)] = 0
    """Number of training trials before the first one; after each, the participant hears the right answer."""
    instruction: str = ""
    """Sentence before the first trial, in the language of the participants."""


class Breaks(Section):
    """Breaks between trials."""

    every: Annotated[int, Field(ge=1, le=1000)] = 30
    """Number of trials from break to break."""
    seconds: Annotated[float, Field(ge=0, le=3600)] = 60.0
    """The least duration of a break."""


class Limits(Section):
    """Limits above which a trial is marked as not rendered."""

    limited: Annotated[float, Field(ge=0, le=1)] = 0.01
    """Share of the time in contact in which the guard changed the force."""
    late: Annotated[float, Field(ge=0, le=1)] = 0.01
    """Share of the ticks of the force loop that came too late."""


class Study(Quantities):
    """A study file after all checks."""

    study: Annotated[str, Field(pattern=r"^[A-Za-z0-9]+$", max_length=40)]
    """Name of the study in the names of its files: letters and digits."""
    title: str = ""
    """Title in plain words."""
    pipeline: Path | None = None
    """Pipeline file of every condition that names no other."""
    conditions: Annotated[dict[str, Condition], Field(default_factory=dict)]
    """Conditions by name."""
    comparisons: tuple[Comparison, ...] = ()
    """Comparisons, each with its question and procedure."""
    order: Order = "latin-square"
    """Order of the comparisons: balanced over the participants by a Latin square, at random, or as written."""
    seed: Annotated[int, Field(ge=0, lt=2**32)] = 0
    """Seed of everything that is drawn at random."""
    feel_s: Annotated[float, Field(gt=0, le=600)] = 5.0
    """Duration of each interval in which the participant feels something."""
    pause_s: Annotated[float, Field(ge=0, le=60)] = 0.5
    """Duration of the pause between two intervals of a trial."""
    breaks: Breaks = Breaks()
    """Breaks between trials."""
    limits: Limits = Limits()
    """Limits above which a trial is marked as not rendered."""
    language: Literal["en", "de"] = "en"
    """Language of what the program says to participants."""
    sounds: tuple[Sound, ...] = ("contact", "texture", "force", "height")
    """Sounds by which the page renders touch where it is the device: taps, the material under a stroke, the force, and
    heights as tones. A device with a motor needs none."""
    hears: str = "nothing"
    """Sounds that a participant hears, such as pink noise on headphones; they are kept with the results."""
    sees: str = "a dark screen"
    """The view of a participant, such as a dark screen; it is kept with the results."""
    consent: str = ""
    """Text to which each participant agrees before the first trial; a copy is kept with the answers."""

    def comparison(self, name: str) -> Comparison:
        """Return the comparison of this name. Raises: StopIteration."""
        return next(comparison for comparison in self.comparisons if comparison.name == name)


SAME, DIFFERENT = "same", "different"  # responses to two intervals that may be equal


class Stimulus(NamedTuple):
    """A surface in an interval: that of a condition, at a level if one varies."""

    condition: str
    level: float | None = None


@dataclass(frozen=True)
class Trial:
    """A trial as a procedure asks for it; what it is called on the screen is its intervals' numbers alone."""

    comparison: str
    question: str
    procedure: str
    intervals: tuple[Stimulus, ...]  # the stimulus of each interval, in their order
    choices: tuple[str, ...]  # possible responses; of an adjustment, the levels that can be set, as text
    condition: str  # name of the condition under test
    other: str | None = None  # name of the condition with which it is compared
    level: float | None = None
    standard: float | None = None
    position: int | None = None  # interval, from 1, of the comparison or of the odd one
    # Right answer, where it is not the number of an interval: the name of a part, or `same` or `different`.
    target: str | None = None
    phase: str = "test"

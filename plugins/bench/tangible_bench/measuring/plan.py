"""What a comparison measures, in which order: rounds over all scenes and perturbations, methods side by side."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from tangible_core.data import digest_of
from tangible_core.errors import ConfigError, TangibleError
from tangible_core.pipeline.config.methods import NamedMethod
from tangible_core.plugins.interfaces import Method
from tangible_core.provenance.closure import closure
from tangible_core.provenance.versions import versions
from tangible_core.runtime.child_process import Place, place

from ..config.reading import Comparison, Damage, Entry
from .machine import machine
from .rows import Row
from .worker import Job


@dataclass(frozen=True)
class Measurement:
    """One process to start, and the row it fills."""

    job: Job
    row: Row
    place: Place
    """Where the method's class is from: the process must have the same."""


def measurements(comparison: Comparison) -> list[Measurement]:
    """Every process of a comparison, in order.

    A round runs every method on a scene before it goes on to the next one, so that a drift of the machine hits all
    alike and pairs of times can be compared; each round starts with another method.
    Raises: ConfigError naming every scene that cannot be read, before hours are spent on the others.
    """
    known = _scenes(comparison)
    found: list[Measurement] = []
    for repeat in range(comparison.protocol.repeats):
        turn = repeat % len(comparison.methods)
        methods = (*comparison.methods[turn:], *comparison.methods[:turn])
        for scene in comparison.scenes:
            for damage in comparison.damages:
                found += _side_by_side(comparison, methods, scene, known[scene], damage, repeat)
    return found


@dataclass(frozen=True)
class KnownScene:
    """What must be known of a scene before it is measured on."""

    digest: str
    facts: Mapping[str, Any]
    """Options that methods may be told."""


def _scenes(comparison: Comparison) -> dict[str, KnownScene]:
    known: dict[str, KnownScene] = {}
    complaints: list[str] = []
    for name, spec in comparison.scenes.items():
        try:
            scene = spec.open()
        except TangibleError as error:
            complaints.append(f"{comparison.path}: scene {name}: {error}")
        else:
            known[name] = KnownScene(scene.digest(), {key: tell(scene) for key, tell in comparison.task.given.items()})
    if complaints:
        raise ConfigError(*complaints)
    return known


def _side_by_side(
    comparison: Comparison, methods: Sequence[Entry], scene: str, known: KnownScene, damage: Damage, repeat: int
) -> Iterator[Measurement]:
    task, protocol = comparison.task, comparison.protocol
    for entry in methods:
        options = entry.method_for(known.facts).model_dump(mode="json")
        finishes = tuple(name for name, labels in comparison.finishes.items() if entry.label in labels)
        job = Job(
            task.kind, entry.chosen.name, options, comparison.scenes[scene].model_dump(mode="json"),
            damage.kind, damage.value, finishes, protocol.warmups, protocol.calls,
        )  # fmt: skip
        installed = versions(_distribution(entry.chosen))
        code = f"v{task.version} {_code(entry.chosen)} {installed} {machine()}"
        plain = repr((asdict(replace(job, scene={})), entry.label, known.digest, damage.name, repeat, code))
        row = Row(
            digest_of(plain), task.kind, entry.label, job.use, options, entry.chosen.origin, scene, known.digest,
            damage.name, finishes, repeat, installed, machine(), comparison.baseline,
        )  # fmt: skip
        cls = type(entry.chosen.method)
        yield Measurement(job, row, place(cls.__module__, cls.__qualname__))


def _code(chosen: NamedMethod[Method]) -> str:
    cls = type(chosen.method)
    return f"{cls.__module__}:{cls.__qualname__} v{cls.version} {closure(cls.__module__).digest}"


def _distribution(chosen: NamedMethod[Method]) -> str:
    return chosen.origin.partition(" ")[0]

"""The measurements of a comparison, in order: rounds over all scenes and perturbations, methods side by side."""

import logging
import platform
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from tangible_core.data import digest_of
from tangible_core.errors import ConfigError, TangibleError
from tangible_core.pipeline.config import NamedMethod
from tangible_core.plugins import Method
from tangible_core.provenance.closure import closure
from tangible_core.provenance.versions import versions
from tangible_core.runtime import Place, place

from ..config.reading import Comparison, Damage, Entry
from .rows import Row
from .worker import Job

log: logging.Logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Measurement:
    """A process to start, and the row that it fills."""

    job: Job
    row: Row
    place: Place  # the place of the method's class: the process must import it from the same place


def measurements(comparison: Comparison) -> list[Measurement]:
    """Return every measurement of a comparison, in order.

    A method whose options keep it from the truth of a scene is named in the log.
    Raises: ConfigError naming every unreadable scene.
    """
    scenes = _known_scenes(comparison)
    plan: list[Measurement] = []
    # A round runs every method on a scene before the next scene, so that a drift of the machine affects all alike and
    # times can be compared within the round; each round starts with another method.
    for repeat in range(comparison.protocol.repeats):
        turn = repeat % len(comparison.methods)
        methods = (*comparison.methods[turn:], *comparison.methods[:turn])
        for scene in comparison.scenes:
            for damage in comparison.damages:
                plan += _side_by_side(comparison, methods, scene, scenes[scene], damage, repeat)
    return plan


# The digest of a scene, and facts that methods may be given: option of a method -> value for this scene.
KnownScene = tuple[str, Mapping[str, Any]]


def _known_scenes(comparison: Comparison) -> dict[str, KnownScene]:
    scenes: dict[str, KnownScene] = {}
    complaints: list[str] = []
    for name, spec in comparison.scenes.items():
        try:
            scene = spec.open()
        except TangibleError as error:
            complaints.append(f"{comparison.path}: scene {name}: {error}")
        else:
            facts = {key: fact_of(scene) for key, fact_of in comparison.task.facts.items()}
            scenes[name] = scene.digest(), facts
            for entry in comparison.methods:
                if doubt := comparison.task.doubt(entry.method_for(facts), scene):
                    log.warning("%s on %s: %s", entry.label, name, doubt)
    if complaints:
        raise ConfigError(*complaints)
    return scenes


def _side_by_side(
    comparison: Comparison, methods: Sequence[Entry], scene: str, scene_facts: KnownScene, damage: Damage, repeat: int
) -> Iterator[Measurement]:
    task, protocol, (digest, facts) = comparison.task, comparison.protocol, scene_facts
    for entry in methods:
        options = entry.method_for(facts).model_dump(mode="json")
        finishes = tuple(name for name, labels in comparison.finishes.items() if entry.label in labels)
        job = Job(
            task.kind, entry.choice.name, options, comparison.scenes[scene].model_dump(mode="json"),
            damage.kind, damage.value, finishes, protocol.warmups, protocol.calls,
        )  # fmt: skip
        package_versions = versions(entry.choice.origin.partition(" ")[0])
        code = f"v{task.version} {_code(entry.choice)} {package_versions} {machine()}"
        plain = repr((asdict(replace(job, scene={})), entry.label, digest, damage.name, repeat, code))
        row = Row(
            digest_of(plain), task.kind, entry.label, job.use, options, entry.choice.origin, scene, digest,
            damage.name, finishes, repeat, package_versions, machine(), comparison.baseline,
        )  # fmt: skip
        cls = type(entry.choice.method)
        yield Measurement(job, row, place(cls.__module__, cls.__qualname__))


def _code(choice: NamedMethod[Method]) -> str:
    cls = type(choice.method)
    return f"{cls.__module__}:{cls.__qualname__} v{cls.version} {closure(cls.__module__).digest}"


@cache
def machine() -> dict[str, str | int]:
    """Return the processor, the number of cores that this process may use, and the system."""
    from tangible_core.compiled import thread_count

    return {"processor": _processor(), "cores": thread_count(), "system": f"{platform.system()} {platform.machine()}"}


def _processor() -> str:
    try:
        model = re.search(r"model name\s*: (.+)", Path("/proc/cpuinfo").read_text(encoding="utf-8"))
    except OSError:
        model = None
    return model[1] if model else platform.processor() or platform.machine()

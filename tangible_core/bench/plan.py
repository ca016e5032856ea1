"""What a comparison measures, in which order: rounds over all scenes and perturbations, methods side by side."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace

from ..config import Chosen
from ..data import digest_of
from ..errors import ConfigError, TangibleError
from ..interfaces import Method
from .config import Comparison, Damage, Entry
from .identity import code_digest, machine, versions
from .rows import Row
from .worker import Job


@dataclass(frozen=True)
class Measurement:
    """One process to start, and the row it fills."""

    job: Job
    row: Row


def measurements(comparison: Comparison) -> list[Measurement]:
    """Every process of a comparison, in order.

    A round runs every method on a scene before it goes on to the next one, so that a drift of the machine hits all
    alike and pairs of times can be compared; each round starts with another method.
    Raises: ConfigError naming every scene that cannot be read, before hours are spent on the others.
    """
    digests = _scene_digests(comparison)
    found: list[Measurement] = []
    for repeat in range(comparison.protocol.repeats):
        turn = repeat % len(comparison.methods)
        methods = (*comparison.methods[turn:], *comparison.methods[:turn])
        for scene in comparison.scenes:
            for damage in comparison.damages:
                found += _side_by_side(comparison, methods, scene, digests[scene], damage, repeat)
    return found


def _scene_digests(comparison: Comparison) -> dict[str, str]:
    digests: dict[str, str] = {}
    complaints: list[str] = []
    for name, spec in comparison.scenes.items():
        try:
            digests[name] = spec.open().digest()
        except TangibleError as error:
            complaints.append(f"{comparison.path}: scene {name}: {error}")
    if complaints:
        raise ConfigError("\n".join(complaints))
    return digests


def _side_by_side(
    comparison: Comparison, methods: Sequence[Entry], scene: str, digest: str, damage: Damage, repeat: int
) -> Iterator[Measurement]:
    task, protocol = comparison.task, comparison.protocol
    for entry in methods:
        options = entry.chosen.method.model_dump(mode="json")
        finishes = tuple(name for name, labels in comparison.finishes.items() if entry.label in labels)
        job = Job(
            task.kind, entry.chosen.name, options, comparison.scenes[scene].model_dump(mode="json"),
            damage.kind, damage.value, finishes, protocol.warmups, protocol.calls,
        )  # fmt: skip
        known = versions(_distribution(entry.chosen))
        code = f"v{task.version} {_code(entry.chosen)} {known} {machine()}"
        plain = repr((asdict(replace(job, scene={})), entry.label, digest, damage.name, repeat, code))
        row = Row(
            digest_of(plain), task.kind, entry.label, job.use, options, entry.chosen.origin, scene, digest,
            damage.name, finishes, repeat, known, machine(), comparison.baseline,
        )  # fmt: skip
        yield Measurement(job, row)


def _code(chosen: Chosen[Method]) -> str:
    cls = type(chosen.method)
    return f"{cls.__module__}:{cls.__qualname__} v{cls.version} {code_digest(cls.__module__)}"


def _distribution(chosen: Chosen[Method]) -> str:
    return chosen.origin.partition(" ")[0]

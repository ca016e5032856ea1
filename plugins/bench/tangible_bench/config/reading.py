"""A comparison file: which methods, on which scenes, damaged how; every complaint at once, each with its place."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from os.path import normpath
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import Field

from tangible_core.errors import TangibleError, did_you_mean, quoted
from tangible_core.files.source import Source, parse_source, read_text
from tangible_core.plugins.registry import Registry
from tangible_core.scene.workspace import Section

from ..tasks.task import TASKS, SceneSpec, Task, load_task
from .methods import Entry, read_methods

NONE = "none"
UNCOMPARED = {
    "device": "devices are not compared; `tangible devices stress NAME` measures how fast one is",
    "export": "exporters are not compared, as there is no truth that files could be held against",
}
Place = tuple[Any, ...]


class Protocol(Section):
    """How often and how long each method is measured."""

    repeats: Annotated[int, Field(ge=1, le=1000)] = 5
    """Rounds; in each, every method runs once on every scene, in a process of its own."""
    warmups: Annotated[int, Field(ge=0, le=100)] = 1
    """Calls before the clock starts: imports, compilation, caches."""
    calls: Annotated[int, Field(ge=1, le=1000)] = 3
    """Timed calls in a process; its time is their median."""
    timeout_s: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 600.0
    """A process that takes longer is ended, and its row says so."""


@dataclass(frozen=True)
class Damage:
    """A perturbation with its strength, or none."""

    kind: str = NONE
    value: float = 0.0

    @property
    def name(self) -> str:
        """`none`, or such as `noise 5`."""
        return NONE if self.kind == NONE else f"{self.kind} {self.value:g}"


@dataclass(frozen=True)
class Comparison:
    """A comparison file that was checked."""

    path: Path
    task: Task
    methods: tuple[Entry, ...]
    scenes: Mapping[str, SceneSpec]
    damages: tuple[Damage, ...]
    protocol: Protocol
    finishes: Mapping[str, frozenset[str]]
    """Step -> labels of the methods whose results it is done to."""
    baseline: str | None
    """Label of the method that times are compared with."""
    out: Path


def quick(comparison: Comparison) -> Comparison:
    """The same in a fraction of the time, for a first look: one round, one call, no perturbations; in a folder beside.

    Times of it are rough; errors are those of the whole comparison, for methods are deterministic.
    """
    protocol = comparison.protocol.model_copy(update={"repeats": 1, "calls": 1})
    out = comparison.out.with_name(f"{comparison.out.name}-quick")
    return replace(comparison, protocol=protocol, damages=(Damage(),), out=out)


def load_comparison(path: Path, registry: Registry, overrides: Iterable[str] = ()) -> Comparison:
    """Read and check a comparison file; relative paths start at the file.

    Raises: ConfigError with every complaint, one a line.
    """
    return parse_comparison(read_text(path), path, registry, overrides)


def parse_comparison(text: str, path: Path, registry: Registry, overrides: Iterable[str] = ()) -> Comparison:
    """`load_comparison` for a text; `path` is what complaints name."""
    source = parse_source(text, path, "a comparison is a mapping that starts with `compare:`", overrides)
    task = _task(source)
    source.check_keys(
        ("compare", "methods", "scenes", "perturb", *Protocol.model_fields, *task.finishes, "baseline", "out")
    )
    protocol = source.model(
        (), Protocol, {key: source.tree[key] for key in Protocol.model_fields if key in source.tree}
    )
    methods = read_methods(source, task, registry)
    labels = [each.label for each in methods]
    scenes = _scenes(source, task)
    damages = _damages(source, task)
    finishes = {name: frozenset(_labels(source, name, labels)) for name in task.finishes if name in source.tree}
    baseline = _baseline(source, labels)
    out = source.tree.get("out", f"out/{path.stem}")
    if not isinstance(out, str):
        source.complain(("out",), f"out: a folder is wanted, not {quoted(out)}")
    source.settle()
    folder = path.parent if "out" in source.tree else Path()
    return Comparison(path, task, methods, scenes, damages, protocol, finishes, baseline, Path(normpath(folder / out)))


def _task(source: Source) -> Task:
    """Without it, nothing else can be checked."""
    kind = source.tree.get("compare")
    if kind in TASKS:
        return load_task(kind)
    if kind in UNCOMPARED:
        said = f"{UNCOMPARED[kind]}; what is compared are methods for {', '.join(TASKS)}"
    else:
        hint = did_you_mean(str(kind), TASKS) if "compare" in source.tree else ""
        said = f"`compare:` names what kind of method to compare{hint}; known: {', '.join(TASKS)}"
    source.complain(("compare",), said)
    source.settle()
    raise AssertionError("a complaint was settled")


def _scenes(source: Source, task: Task) -> dict[str, SceneSpec]:
    found: dict[str, SceneSpec] = {}
    for index, block in enumerate(source.items("scenes")):
        place = ("scenes", index)
        try:
            options = task.scene.named(block) if isinstance(block, str) else block
            spec: SceneSpec | None = source.model(place, task.scene, options)
            several: Mapping[str, SceneSpec] = {} if spec is None else spec.expand()
        except (TangibleError, ValueError) as error:
            source.complain(place, str(error))
            continue
        for name, each in several.items():
            if name in found:
                source.complain(place, f"two scenes are called {quoted(name)}; name other folders")
            found[name] = each
    return found


def _damages(source: Source, task: Task) -> tuple[Damage, ...]:
    if "perturb" not in source.tree:
        return (Damage(),)
    found: list[Damage] = []
    for index, block in enumerate(source.items("perturb")):
        if block == NONE:
            found.append(Damage())
        elif isinstance(block, dict):
            for kind, values in cast("dict[Any, Any]", block).items():
                found += _strengths(source, ("perturb", index, kind), task, kind, values)
        else:
            source.complain(("perturb", index), f"write none, or such as {{noise: [2, 5]}}, not {quoted(block)}")
    return tuple(dict.fromkeys(found))


def _strengths(source: Source, place: Place, task: Task, kind: Any, values: Any) -> Iterable[Damage]:
    if kind not in task.perturbations:
        hint = did_you_mean(str(kind), task.perturbations)
        source.complain(
            place, f"nothing perturbs by {quoted(kind)}{hint}; known: none, {', '.join(task.perturbations)}"
        )
        return
    known = task.perturbations[kind]
    for value in cast("list[Any]", values if isinstance(values, list) else [values]):
        if isinstance(value, bool) or not isinstance(value, int | float) or not known.allowed(float(value)):
            source.complain(place, f"{kind}: {known.meaning}, not {quoted(value)}")
        else:
            yield Damage(kind, float(value))


def _labels(source: Source, key: str, labels: list[str]) -> Iterable[str]:
    for index, label in enumerate(source.items(key)):
        if label in labels:
            yield label
        else:
            source.complain((key, index), _no_label(label, labels))


def _baseline(source: Source, labels: list[str]) -> str | None:
    label = source.tree.get("baseline")
    if label is not None and label not in labels:
        source.complain(("baseline",), _no_label(label, labels))
    return label


def _no_label(label: Any, labels: list[str]) -> str:
    return f"no method here is called {quoted(label)}{did_you_mean(str(label), labels)}; there are: {', '.join(labels)}"

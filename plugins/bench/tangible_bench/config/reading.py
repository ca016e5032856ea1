"""Comparison files: methods, scenes and perturbations; all mistakes are reported at once, each with its place."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from os.path import normpath
from pathlib import Path
from typing import Annotated, Any, cast

from pydantic import Field

from tangible_core.errors import ConfigError, TangibleError, did_you_mean, quoted
from tangible_core.files.yaml import Source, parse_source, plain_tree, read_text
from tangible_core.plugins import Method
from tangible_core.plugins.registry import Registry
from tangible_core.scene import Section

from ..datasets import pairs
from ..tasks.depth_scenes import named_set
from ..tasks.task import TASKS, SceneSpec, Task, load_task
from .methods import Entry, read_methods

SET_TEMPLATE = """\
compare: depth
methods: [semi-global, {{use: opencv-sgbm, given: [max_disparity_px]}}, zncc, ssd]
scenes: [{scene}]
repeats: 1
calls: 1
"""

"""The comparison file of a standard set for which the user has none."""
NONE = "none"  # the name of the perturbation that leaves scenes as they are
UNCOMPARED = {
    "device": "devices are not compared; `tangible devices stress NAME` measures how fast one is",
    "export": "exporters are not compared, as there is no truth that files could be compared with",
}
Place = tuple[Any, ...]


class Protocol(Section):
    """The number of rounds and calls, and the time limit."""

    repeats: Annotated[int, Field(ge=1, le=1000)] = 5
    """Number of rounds; in each round, every method runs once on every scene, in a new process."""
    warmups: Annotated[int, Field(ge=0, le=100)] = 1
    """Number of calls before the timed ones, for imports, compilation and caches."""
    calls: Annotated[int, Field(ge=1, le=1000)] = 3
    """Number of timed calls in a process; its time is their median."""
    timeout_s: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 600.0
    """Time limit of a process, seconds; a process that takes longer is ended, and its row reports it."""


@dataclass(frozen=True)
class Damage:
    """A perturbation with its strength, or `none`."""

    kind: str = NONE
    value: float = 0.0

    @property
    def name(self) -> str:
        """The name in tables: `none`, or for example `noise 5`."""
        return NONE if self.kind == NONE else f"{self.kind} {self.value:g}"


@dataclass(frozen=True)
class Comparison:
    """A comparison file after all checks."""

    path: Path
    task: Task
    methods: tuple[Entry, ...]
    scenes: Mapping[str, SceneSpec]
    damages: tuple[Damage, ...]
    protocol: Protocol
    # Finishing step -> labels of the methods whose results it is applied to.
    finishes: Mapping[str, frozenset[str]]
    baseline: str | None  # the label of the method that times are compared with
    out: Path


def shorten(comparison: Comparison) -> Comparison:
    """Return the comparison for a first look: one round, one call, no perturbations; its folder ends with `-quick`."""
    protocol = comparison.protocol.model_copy(update={"repeats": 1, "calls": 1})
    out = comparison.out.with_name(f"{comparison.out.name}-quick")
    return replace(comparison, protocol=protocol, damages=(Damage(),), out=out)


def errors_only(comparison: Comparison) -> Comparison:
    """Return the comparison without times: one round, no timed call, no baseline; its folder ends with `-errors`."""
    protocol = comparison.protocol.model_copy(update={"repeats": 1, "warmups": 0, "calls": 0})
    out = comparison.out.with_name(f"{comparison.out.name}-errors")
    return replace(comparison, protocol=protocol, baseline=None, out=out)


def comparison_of_set(name: str, folder: Path | None = None) -> str:
    """Return the text of a comparison of a standard set, such as `NAME@Q`. Raises: ConfigError, PictureError."""
    options = named_set(name)
    if options is None:
        raise ConfigError(f"{name}: is not a standard set")
    folder = (folder or Path(options["set"])).absolute()
    pairs(options["set"], folder, **{key: value for key, value in options.items() if key != "set"})
    return SET_TEMPLATE.format(scene=json.dumps({**options, "folder": str(folder)}))


def preset(name: str) -> Path | None:
    """Return the shipped comparison file of this name, such as compare-depth; None if there is none."""
    folders = Path(__file__).parents[1] / "presets", Path(__file__).parents[4] / "configs"  # installed, in a checkout
    return next((file for folder in folders if (file := folder / f"{name}.yaml").is_file()), None)


def comparison_of_methods(names: Sequence[str], registry: Registry) -> str:
    """Return the text of a comparison of these methods with their defaults, on the scenes of the shipped file.

    An option that is a number by default, and that the truth of a scene tells, is given: others would miss the truth.
    Raises: ConfigError for names that no kind of comparable methods has together.
    """
    kinds = {kind: registry.names(kind) for kind in TASKS}
    kind = next((kind for kind, all_names in kinds.items() if set(names) <= set(all_names)), None)
    file = kind and preset(f"compare-{kind}")
    if not (kind and file):
        all_names = [name for some in kinds.values() for name in some]
        wrong = next((name for name in names if name not in all_names), "")
        if not wrong:
            raise ConfigError(f"{' and '.join(names)}: are methods of several kinds; compare those of one")
        hint = did_you_mean(wrong, all_names) or "; `tangible plugins` lists these"
        raise ConfigError(f"{wrong}: is neither a file, nor a standard set, nor the name of a method{hint}")
    scenes = plain_tree(read_text(file), file)["scenes"]
    methods = [{"use": name, "given": _given(registry.load(kind, name), load_task(kind))} for name in names]
    return json.dumps({"compare": kind, "methods": methods, "scenes": scenes})


def _given(method: type[Method], task: Task) -> list[str]:
    fields = method.model_fields
    return [name for name in task.facts if name in fields and isinstance(fields[name].default, int)]


def load_comparison(path: Path, registry: Registry, overrides: Iterable[str] = ()) -> Comparison:
    """Read and check a comparison file; relative paths are relative to its folder. Raises: ConfigError."""
    return parse_comparison(read_text(path), path, registry, overrides)


def parse_comparison(text: str, path: Path, registry: Registry, overrides: Iterable[str] = ()) -> Comparison:
    """Check the text of a comparison file, as `load_comparison` does. path: the file that error messages name."""
    source = parse_source(text, path, "a comparison is a mapping that starts with `compare:`", overrides)
    task = _task(source)
    source.check_keys(
        ("compare", "methods", "scenes", "perturb", *Protocol.model_fields, *task.finishes, "baseline", "out")
    )
    of_protocol = {key: source.tree[key] for key in Protocol.model_fields if key in source.tree}
    protocol = source.model((), Protocol, of_protocol)
    methods = read_methods(source, task, registry)
    labels = [method.label for method in methods]
    scenes = _scenes(source, task)
    damages = _damages(source, task)
    finishes = {name: frozenset(_labels(source, name, labels)) for name in task.finishes if name in source.tree}
    baseline = _baseline(source, labels)
    out = source.tree.get("out", f"out/{path.stem}")
    if not isinstance(out, str):
        source.complain(("out",), f"out: must be a folder, not {quoted(out)}")
    source.settle()
    folder = path.parent if "out" in source.tree else Path()
    return Comparison(path, task, methods, scenes, damages, protocol, finishes, baseline, Path(normpath(folder / out)))


def _task(source: Source) -> Task:
    """Return the task of the file. Raises: ConfigError at once, as nothing else can be checked without the task."""
    kind = source.tree.get("compare")
    if kind in TASKS:
        return load_task(kind)
    if kind in UNCOMPARED:
        message = f"{UNCOMPARED[kind]}; methods that can be compared are those for {', '.join(TASKS)}"
    else:
        hint = did_you_mean(str(kind), TASKS) if "compare" in source.tree else ""
        message = f"`compare:` names what kind of method to compare{hint}; known: {', '.join(TASKS)}"
    source.complain(("compare",), message)
    source.settle()
    raise AssertionError("a complaint was settled")


def _scenes(source: Source, task: Task) -> dict[str, SceneSpec]:
    scenes: dict[str, SceneSpec] = {}
    for index, block in enumerate(source.items("scenes")):
        place = ("scenes", index)
        try:
            options = task.scene.parse_name(block) if isinstance(block, str) else block
            spec: SceneSpec | None = source.model(place, task.scene, options)
            several: Mapping[str, SceneSpec] = {} if spec is None else spec.expand()
        except (TangibleError, ValueError) as error:
            source.complain(place, str(error))
            continue
        for name, scene in several.items():
            if name in scenes:
                source.complain(place, f"two scenes are called {quoted(name)}; name other folders")
            scenes[name] = scene
    return scenes


def _damages(source: Source, task: Task) -> tuple[Damage, ...]:
    if "perturb" not in source.tree:
        return (Damage(),)
    damages: list[Damage] = []
    for index, block in enumerate(source.items("perturb")):
        if block == NONE:
            damages.append(Damage())
        elif isinstance(block, dict):
            for kind, values in cast("dict[Any, Any]", block).items():
                damages += _strengths(source, ("perturb", index, kind), task, kind, values)
        else:
            source.complain(("perturb", index), f"write none, or for example {{noise: [2, 5]}}, not {quoted(block)}")
    return tuple(dict.fromkeys(damages))


def _strengths(source: Source, place: Place, task: Task, kind: Any, values: Any) -> Iterable[Damage]:
    if kind not in task.perturbations:
        hint = did_you_mean(str(kind), task.perturbations)
        names = ", ".join(task.perturbations)
        source.complain(place, f"no perturbation is called {quoted(kind)}{hint}; known: none, {names}")
        return
    perturbation = task.perturbations[kind]
    for value in cast("list[Any]", values if isinstance(values, list) else [values]):
        if isinstance(value, bool) or not isinstance(value, int | float) or not perturbation.is_valid(float(value)):
            source.complain(place, f"{kind}: {perturbation.meaning}, not {quoted(value)}")
        else:
            yield Damage(kind, float(value))


def _labels(source: Source, key: str, labels: list[str]) -> Iterable[str]:
    for index, label in enumerate(source.items(key)):
        if label in labels:
            yield label
        else:
            source.complain((key, index), _unknown_label(label, labels))


def _baseline(source: Source, labels: list[str]) -> str | None:
    label = source.tree.get("baseline")
    if label is not None and label not in labels:
        source.complain(("baseline",), _unknown_label(label, labels))
    return label


def _unknown_label(label: Any, labels: list[str]) -> str:
    return f"no method here is called {quoted(label)}{did_you_mean(str(label), labels)}; there are: {', '.join(labels)}"

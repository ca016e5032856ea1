"""A study file, read and checked before anybody sits down; all mistakes are reported at once, each with its place."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple, cast

from tangible_core.errors import Complaint, ConfigError, TangibleError, did_you_mean, quoted
from tangible_core.files.yaml import Location, Source, json_in_yaml, parse_source, plain, read_text
from tangible_core.pipeline.config import PipelineConfig, load_config
from tangible_core.plugins.registry import Registry, default_registry

from .design import Comparison, Stimulus, Study
from .procedures.procedure import Procedure, load_procedure, procedure_names
from .questions import load_question

EXPECTED = "a study is a mapping that starts with `study:`"


class Recipe(NamedTuple):
    """The pipeline of a stimulus: its file, and the changes to it."""

    pipeline: Path
    sets: tuple[str, ...]  # changes, `key.key=value` each


@dataclass(frozen=True)
class StudyFile:
    """A study file after all checks that need no device."""

    path: Path
    text: str
    study: Study
    procedures: Mapping[str, Procedure]  # procedure of each comparison, by its name
    source: Source = field(repr=False)

    @property
    def digest(self) -> str:
        """Digest of the text, by which another version of the file is recognised."""
        return sha256(self.text.encode()).hexdigest()[:16]

    def recipes(self) -> dict[tuple[str, Stimulus], Recipe]:
        """Return the pipeline of everything that may be presented, by comparison and stimulus."""
        return {
            (comparison.name, stimulus): make_recipe(self.study, self.path.parent, comparison, stimulus)
            for comparison in self.study.comparisons
            for stimulus in self.procedures[comparison.name].stimuli(comparison)
        }

    def place(self, comparison: str, stimulus: Stimulus) -> Location:
        """Return the location in the file of what makes a stimulus: its level, or its condition."""
        index = [entry.name for entry in self.study.comparisons].index(comparison)
        levels = self.study.comparisons[index].levels
        if stimulus.level is None:
            return ("conditions", stimulus.condition)
        if stimulus.level in levels:
            return ("comparisons", index, "levels", levels.index(stimulus.level))
        return ("comparisons", index, "standard")


def load_study(path: Path) -> StudyFile:
    """Read and check a study file; its pipelines are relative to its folder. Raises: ConfigError with all mistakes."""
    return parse_study(read_text(path), path)


def read_design(path: Path) -> Study:
    """Read the keys of a study file alone: the pipelines of a finished study may be gone. Raises: ConfigError."""
    return _design(parse_source(read_text(path), path, EXPECTED))


def parse_study(text: str, path: Path) -> StudyFile:
    """Check the text of a study file, as `load_study` does. path: the file that complaints name."""
    source = parse_source(text, path, EXPECTED)
    study = _design(source)
    if not study.comparisons:
        source.complain(("comparisons",), "asks nothing; write `comparisons:`, each with a `name:` and a `question:`")
    names = [comparison.name for comparison in study.comparisons]
    for index, name in enumerate(names):
        if name in names[:index]:
            source.complain(("comparisons", index, "name"), f"two comparisons are called {quoted(name)}; rename one")
    for name, condition in study.conditions.items():
        if condition.pipeline is None and study.pipeline is None:
            source.complain(("conditions", name), f"{name}: has no pipeline; write `pipeline:` here or for the study")
    procedures = {
        comparison.name: procedure
        for index, comparison in enumerate(study.comparisons)
        if (procedure := _procedure(source, index, comparison, study)) is not None
    }
    source.settle()
    file = StudyFile(path, text, study, procedures, source)
    _check_pipelines(file, default_registry())
    source.settle()
    return file


def make_recipe(study: Study, folder: Path, comparison: Comparison, stimulus: Stimulus) -> Recipe:
    """Return the pipeline of a stimulus. folder: that of the study file."""
    condition = study.conditions[stimulus.condition]
    pipeline = condition.pipeline or study.pipeline
    assert pipeline is not None
    sets = [_override(key, value) for key, value in condition.set.items()]
    if stimulus.level is not None and comparison.vary:
        sets.append(_override(comparison.vary, stimulus.level))
    return Recipe(folder / pipeline, tuple(sets))


def _override(key: str, value: Any) -> str:
    return f"{key}={json_in_yaml(value)}"


def _expand(tree: Any) -> Any:
    """Return the tree with a procedure's name alone as a block."""
    block = plain(tree)
    for entry in block.get("comparisons") or () if isinstance(block.get("comparisons"), list) else ():
        if isinstance(entry, dict) and isinstance(cast(Any, entry).get("procedure"), str):
            entry["procedure"] = {"use": entry["procedure"]}
    return block


def _design(source: Source) -> Study:
    """Return the keys of the file; a comparison that names no conditions has all. Raises: ConfigError."""
    study: Study | None = source.model((), Study, _expand(source.tree))
    source.settle()
    assert study is not None
    everything = {"conditions": tuple(study.conditions)}
    comparisons = (
        comparison if comparison.conditions else comparison.model_copy(update=everything)
        for comparison in study.comparisons
    )
    return study.model_copy(update={"comparisons": tuple(comparisons)})


def _procedure(source: Source, index: int, comparison: Comparison, study: Study) -> Procedure | None:
    """Return the procedure of a comparison; None after complaints."""
    here: Location = ("comparisons", index)
    question = load_question(comparison.question)
    before = len(source.complaints)
    for number, name in enumerate(comparison.conditions):
        if name not in study.conditions:
            hint = did_you_mean(name, study.conditions)
            conditions = ", ".join(study.conditions) or "none"
            where = (*here, "conditions", number)
            source.complain(where, f"no condition is called {quoted(name)}{hint}; there are: {conditions}")
    if list(comparison.levels) != sorted(set(comparison.levels)):
        source.complain((*here, "levels"), "levels: must rise, each once")
    options = dict(comparison.procedure)
    name = options.pop("use", None) or question.procedures[0]
    if name not in procedure_names():
        hint = did_you_mean(str(name), procedure_names())
        conditions = ", ".join(procedure_names())
        source.complain((*here, "procedure"), f"no procedure is called {quoted(name)}{hint}; known: {conditions}")
        return None
    try:
        procedure: Procedure | None = source.model((*here, "procedure"), load_procedure(name), options)
    except TangibleError as error:
        source.complain((*here, "procedure"), str(error))
        return None
    if procedure is None or len(source.complaints) > before:
        return None
    if refusal := procedure.refusal(comparison):
        source.complain(here, f"{comparison.name}: the procedure {name} {refusal}")
    elif len(procedure.stimuli(comparison)) < 2 and not question.names_parts:
        source.complain(
            here, f"{comparison.name}: has one condition only; write at least two `conditions:`, or `levels:`"
        )
    return procedure


def _check_pipelines(file: StudyFile, registry: Registry) -> None:
    """Complain about pipelines that cannot be read: unknown files, keys and values."""
    reported = set[tuple[Location, str]]()
    for (comparison, stimulus), recipe in file.recipes().items():
        try:
            config_of_recipe(recipe, registry)
        except ConfigError as error:
            index = [entry.name for entry in file.study.comparisons].index(comparison)
            for complaint in error.complaints:
                where = _origin(file, index, stimulus, complaint)
                if (where, complaint.text) not in reported:
                    reported.add((where, complaint.text))
                    file.source.complain(where, f"{recipe.pipeline.name}: {complaint.text}")


def config_of_recipe(recipe: Recipe, registry: Registry) -> PipelineConfig:
    """Read the configuration of a stimulus. Raises: ConfigError with every complaint."""
    return load_config(recipe.pipeline, registry, recipe.sets)


def _origin(file: StudyFile, index: int, stimulus: Stimulus, complaint: Complaint) -> Location:
    """Return the location in the study file that caused a complaint about a pipeline."""
    comparison = file.study.comparisons[index]
    condition = file.study.conditions[stimulus.condition]
    if comparison.vary and _overlap(comparison.vary, complaint.location):
        unknown = "unknown" in complaint.text or stimulus.level is None
        return ("comparisons", index, "vary") if unknown else file.place(comparison.name, stimulus)
    for key in condition.set:
        if _overlap(key, complaint.location):
            return ("conditions", stimulus.condition, "set", key)
    return ("conditions", stimulus.condition, "pipeline") if condition.pipeline else ("pipeline",)


def _overlap(key: str, location: Iterable[Any]) -> bool:
    parts, there = key.split("."), [str(key_part) for key_part in location]
    shorter = min(len(parts), len(there))
    return shorter > 0 and parts[:shorter] == there[:shorter]

"""All stimuli of a study, made before the first trial: so that no trial waits, and none fails for what was known."""

from collections.abc import Callable, Mapping

from tangible_core.errors import ConfigError, TangibleError
from tangible_core.pipeline import Feeling, Pipeline
from tangible_core.plugins.registry import default_registry
from tangible_core.preflight import Loop, Preflight

from ..design import Stimulus
from ..questions import load_question
from ..study_file import Recipe, StudyFile, config_of_recipe

QUICK = Loop(seconds=0.2)  # time for which this machine's lateness is measured for each stimulus
# Checks of preflight that tell that a device renders something else than requested, even if that is safe.
NOT_RENDERED = frozenset(("clipping", "contact", "workspace"))


class Stimuli:
    """The surfaces of a study on a device, by comparison and stimulus; equal ones are made once."""

    def __init__(self, file: StudyFile, device: tuple[str, ...] = ()) -> None:
        """Read all pipelines; nothing is made yet. Raises: ConfigError."""
        self.file = file
        registry = default_registry()
        self._pipelines: dict[Recipe, Pipeline] = {}
        self.recipes: Mapping[tuple[str, Stimulus], Recipe] = {
            key: Recipe(recipe.pipeline, (*recipe.sets, *device)) for key, recipe in file.recipes().items()
        }
        for key, recipe in self.recipes.items():
            if recipe not in self._pipelines:
                config = config_of_recipe(recipe, registry)
                for missing in ("device", "render"):
                    if getattr(config, missing) is None:
                        file.source.complain(file.place(*key), str(config.missing(missing)))
                like = next(iter(self._pipelines.values()), None)
                self._pipelines[recipe] = Pipeline.from_config(config, registry, like=like)
        file.source.settle()
        devices = {pipeline.config.device.name for pipeline in self._pipelines.values() if pipeline.config.device}
        if len(devices) > 1:
            raise ConfigError(
                f"{file.path}: its pipelines have different devices, {' and '.join(sorted(devices))}, which would tell "
                "conditions apart; choose one with --device"
            )
        self.device: str = next(iter(devices))

    def __len__(self) -> int:
        return len(self._pipelines)

    @property
    def has_film(self) -> bool:
        """True if anything that may be presented is a film."""
        return any(pipeline.engine.scene.frames is not None for pipeline in self._pipelines.values())

    def feeling(self, comparison: str, stimulus: Stimulus) -> Feeling:
        """Return the surface of a stimulus on its device."""
        return Feeling(self._pipelines[self.recipes[comparison, stimulus]])

    def make(self, progress: Callable[[int], None]) -> None:
        """Make every surface and force law. progress: called with the number of these so far. Raises: ConfigError."""
        visited, count = set[Recipe](), 0
        for key, recipe in self.recipes.items():
            if recipe in visited:
                continue
            visited.add(recipe)
            try:
                self._pipelines[recipe].make("touch")
            except TangibleError as error:
                self.file.source.complain(self.file.place(*key), str(error))
            else:
                count += 1
                progress(count)
        self._check_names()
        self.file.source.settle()

    def check(self) -> None:
        """Check by preflight, without opening the device, that it renders everything. Raises: ConfigError."""
        visited = set[Recipe]()
        for key, recipe in self.recipes.items():
            if recipe not in visited:
                visited.add(recipe)
                if problem := _problem(self.feeling(*key).preflight(None, QUICK)):
                    self.file.source.complain(self.file.place(*key), f"{self.device} cannot render this: {problem}")
        self.file.source.settle()

    def _check_names(self) -> None:
        """Complain about names that are to be chosen and that a surface has no part of."""
        for (comparison, stimulus), recipe in self.recipes.items():
            names = self.file.study.comparison(comparison).names
            if not (names and load_question(self.file.study.comparison(comparison).question).names_parts):
                continue
            part_names = self._pipelines[recipe].surface.names or ()
            for name in names:
                if name not in part_names:
                    index = [entry.name for entry in self.file.study.comparisons].index(comparison)
                    listing = ", ".join(filter(None, part_names)) or "none"
                    where = ("comparisons", index, "names", names.index(name))
                    self.file.source.complain(
                        where, f"{stimulus.condition} has no part named {name!r}; it has: {listing} (see `parts:`)"
                    )


def _problem(verdicts: Preflight) -> str:
    """Return why a device does not render what was requested; "" if it does."""
    wrong = (
        verdict
        for verdict in verdicts
        if verdict.verdict == "unsafe" or (verdict.verdict != "ok" and verdict.check in NOT_RENDERED)
    )
    return next((f"{worst.says} ({worst.cure})" if worst.cure else worst.says for worst in wrong), "")

"""Which pairs of which set, as a file, a command or a program says it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, cast, get_args

from pydantic import model_validator

from tangible_core.errors import ConfigError, PictureError, TangibleError, did_you_mean, quoted, shown
from tangible_core.files.paths import as_path
from tangible_core.scene.scene_files import SceneFiles, SceneReader

from .sets import SETS, StandardSet
from .standard_pair import FULL_PX, Resolution, StandardPair

Split = Literal["training", "test"]
SetName = Literal[
    "middlebury-2001", "middlebury-2003", "middlebury-2005", "middlebury-2006", "middlebury-2014", "middlebury-2021",
    "middlebury-eval3", "kitti-2012", "kitti-2015", "eth3d", "sintel", "booster",
]  # fmt: skip


def pairs(
    name: str,
    folder: Path | str,
    *,
    resolution: str | None = None,
    split: str | None = None,
    variant: str | None = None,
    only: Sequence[str | int] = (),
) -> tuple[StandardPair, ...]:
    """The pairs of a set that lies in a folder, by name; no picture is read before one is opened.

    resolution: F, H, T or Q, for full, half, third or quarter size; a size that does not lie there is made of a larger
    one. Without it, the largest there is. split: training, or test for pairs whose truth the benchmark keeps; without
    it, training where there is any. variant: `clean` or `final` of Sintel. only: names of pairs, in this order;
    a number stands for the name that YAML reads it from, such as 000000_10.
    Raises: ConfigError for a set, a size, a variant or a pair that there is not; PictureError, with the archive to
    fetch, for a folder that is missing or holds no pair of the set.
    """
    if name not in SETS:
        raise ConfigError(f"no set is named {quoted(name)}{did_you_mean(str(name), SETS)}; known: {', '.join(SETS)}")
    known, root = SETS[name], as_path(folder, "folder")
    sizes: dict[str, Resolution] = {each: each for each in known.sizes}
    size = sizes.get(resolution or "")
    if resolution is not None and size is None:
        there = f"one of {', '.join(known.sizes)}" if known.sizes else "left out, for it has one size"
        raise ConfigError(f"resolution: {name} has none called {quoted(resolution)}; it is {there}")
    if (variant is not None and variant not in known.read) or variant == "":
        variants = " and ".join(each for each in known.read if each)
        raise ConfigError(f"variant: {name} has none called {quoted(variant)}; {_variants(variants)}")
    if split not in (None, *get_args(Split)):
        raise ConfigError(f"split: there is none called {quoted(split)}; it is {' or '.join(get_args(Split))}")
    if not root.is_dir():
        raise PictureError(f"{root}: there is no such folder; {known.fetch}")
    read = known.read[next(iter(known.read)) if variant is None else variant]
    found = _of_split(read(root), split)
    if not found:
        part = f" for {split}" if split else ""
        raise PictureError(f"{root}: holds no pair of {known.title}{part}; {known.fetch}")
    sized = _sized(found, size, known, root)
    return _chosen(sized, only, root)


def _variants(names: str) -> str:
    return f"there are {names}" if names else "leave `variant:` out"


def _of_split(found: Iterable[StandardPair], split: str | None) -> list[StandardPair]:
    pairs_of = {True: list[StandardPair](), False: list[StandardPair]()}
    for each in found:
        pairs_of[each.test].append(each)
    return pairs_of[split == "test"] if split else pairs_of[False] or pairs_of[True]


def _sized(
    found: Iterable[StandardPair], wanted: Resolution | None, known: StandardSet, root: Path
) -> dict[str, StandardPair]:
    """Of each name the pair at the wanted size: as it lies there, or the largest one, to be made smaller."""
    of_name = dict[str, list[StandardPair]]()
    for each in found:
        of_name.setdefault(each.name, []).append(each)
    return {name: _at(same, wanted, known, root) for name, same in sorted(of_name.items())}


def _at(same: list[StandardPair], wanted: Resolution | None, known: StandardSet, root: Path) -> StandardPair:
    largest = min(same, key=lambda each: FULL_PX[each.resolution])
    if wanted is None:
        return largest
    if there := next((each for each in same if each.resolution == wanted), None):
        return there
    larger = [each for each in same if FULL_PX[wanted] % FULL_PX[each.resolution] == 0]
    if not larger:
        raise PictureError(
            f"{root}: {largest.name} lies there at {largest.resolution}, of which {wanted} cannot be made; "
            f"{known.fetch}, at {wanted}"
        )
    best = min(larger, key=lambda each: FULL_PX[each.resolution])
    return replace(best, resolution=wanted, shrink=FULL_PX[wanted] // FULL_PX[best.resolution])


def _chosen(there: dict[str, StandardPair], only: Sequence[str | int], root: Path) -> tuple[StandardPair, ...]:
    numbers = {int(plain): name for name in there if (plain := name.replace("_", "")).isdecimal()}
    wanted = [numbers.get(name, str(name)) if isinstance(name, int) else name for name in only]
    if missing := next((name for name in wanted if name not in there), None):
        names = ", ".join(list(there)[:8]) + (f" and {len(there) - 8} more" if len(there) > 8 else "")
        hint = did_you_mean(missing, there)
        raise ConfigError(f"{root}: no pair in it is named {quoted(missing)}{hint}; there are: {shown(names, 400)}")
    return tuple(there[name] for name in wanted or there)


class SetScene(SceneReader):
    """A pair of a standard set, which stands for left, right, truth and the cameras."""

    set: SetName
    """Whose layout the folder has."""
    folder: Path | None = None
    """Where the set lies; a folder of its name beside the file if left out. Nothing is downloaded."""
    name: str | int
    """Which pair of it, such as `Adirondack-perfect`, `000000_10` or `alley_1/frame_0001`."""
    resolution: Resolution | None = None
    """Full size, a half, a third or a quarter; must lie in the folder. The largest there is if left out."""
    split: Split | None = None
    """`test` for pairs whose truth the benchmark keeps; if left out, `training` where there is any."""
    variant: Literal["final", "clean"] | None = None
    """Which pass of Sintel; `final` if left out."""
    segments: Path | None = None
    """A label picture of the left view: one colour or number per segment. No texture is segmented."""
    crop: tuple[int, int, int, int] | None = None
    """The part that is felt, [x, y, width, height] in pixels of the left view."""

    @model_validator(mode="before")
    @classmethod
    def _beside_the_file(cls, said: Any) -> Any:
        return with_folder(said)

    def files(self) -> SceneFiles:
        """The pair as files. Raises: ConfigError, PictureError as `pairs`."""
        assert self.folder is not None  # by _beside_the_file
        (pair,) = pairs(
            self.set, self.folder, resolution=self.resolution, split=self.split, variant=self.variant, only=(self.name,)
        )
        more = {"segments": self.segments, "crop": self.crop}
        said = pair.files().model_dump(exclude_defaults=True) | {key: each for key, each in more.items() if each}
        return SceneFiles.model_validate(said)

    @classmethod
    def suggest(cls, key: str, block: Mapping[str, Any]) -> Iterable[str]:
        """Return the names of all sets, or those of the pairs of one that lies there."""
        try:
            return list(_values_of(key, block))
        except (TangibleError, TypeError):  # the earlier keys are not finished
            return ()


def _values_of(key: str, block: Mapping[str, Any]) -> Iterable[str]:
    if key == "set":
        return SETS
    scene = with_folder(dict(block))
    if key != "name" or scene.get("set") not in SETS:
        return ()
    chosen = {key: scene[key] for key in ("resolution", "split", "variant") if key in scene}
    return (each.name for each in pairs(scene["set"], scene["folder"], **chosen))


def with_folder(said: Any) -> Any:
    """What is said of a set, with a folder of its name where none is."""
    if not isinstance(said, dict):
        return said
    block = cast("dict[str, Any]", said)
    name = block.get("set")
    return {**block, "folder": Path(name)} if isinstance(name, str) and block.get("folder") is None else block

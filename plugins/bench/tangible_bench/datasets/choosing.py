"""The choice of pairs of a standard set, for files, commands and programs."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, cast, get_args

from pydantic import model_validator

from tangible_core.errors import ConfigError, PictureError, TangibleError, did_you_mean, quoted, shown
from tangible_core.files import as_path
from tangible_core.scene import SceneFiles, SceneReader

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
    """Return the pairs of a set in a folder, by name; no picture is read before its pair is opened.

    resolution: F, H, T or Q; by default the largest in the folder, from which smaller ones are made. split: training,
    or test for pairs whose truth the benchmark keeps. variant: `clean` or `final` of Sintel. only: names of pairs, in
    this order; a number stands for the name that YAML reads as that number, such as 000000_10.
    Raises: ConfigError for an unknown name; PictureError, with the archive to fetch, for a folder without the set.
    """
    if name not in SETS:
        raise ConfigError(f"no set is named {quoted(name)}{did_you_mean(str(name), SETS)}; known: {', '.join(SETS)}")
    standard_set, root = SETS[name], as_path(folder, "folder")
    sizes: dict[str, Resolution] = {size_name: size_name for size_name in standard_set.sizes}
    size = sizes.get(resolution or "")
    if resolution is not None and size is None:
        cure = f"one of {', '.join(standard_set.sizes)}" if standard_set.sizes else "left out, for it has one size"
        raise ConfigError(f"resolution: {name} has none called {quoted(resolution)}; it is {cure}")
    if (variant is not None and variant not in standard_set.read) or variant == "":
        variants = " and ".join(size_name for size_name in standard_set.read if size_name)
        cure = f"there are {variants}" if variants else "leave `variant:` out"
        raise ConfigError(f"variant: {name} has none called {quoted(variant)}; {cure}")
    if split not in (None, *get_args(Split)):
        raise ConfigError(f"split: there is none called {quoted(split)}; it is {' or '.join(get_args(Split))}")
    if not root.is_dir():
        raise PictureError(f"{root}: there is no such folder; {standard_set.fetch}")
    read = standard_set.read[next(iter(standard_set.read)) if variant is None else variant]
    by_name = dict[str, list[StandardPair]]()
    for pairs_of_word in _pairs_of_split(read(root), split):
        by_name.setdefault(pairs_of_word.name, []).append(pairs_of_word)
    if not by_name:
        part = f" for {split}" if split else ""
        raise PictureError(f"{root}: holds no pair of {standard_set.title}{part}; {standard_set.fetch}")
    return _pick({name: _at_size(same, size, standard_set, root) for name, same in sorted(by_name.items())}, only, root)


def _pairs_of_split(all_pairs: Iterable[StandardPair], split: str | None) -> list[StandardPair]:
    pairs_of = {True: list[StandardPair](), False: list[StandardPair]()}
    for pair in all_pairs:
        pairs_of[pair.test].append(pair)
    return pairs_of[split == "test"] if split else pairs_of[False] or pairs_of[True]


def _at_size(same: list[StandardPair], size: Resolution | None, standard_set: StandardSet, root: Path) -> StandardPair:
    """Return, of the sizes of one pair, the requested one; if it is not in the folder, a larger one to be shrunk."""
    largest = min(same, key=lambda pair: FULL_PX[pair.resolution])
    if size is None:
        return largest
    if exact := next((pair for pair in same if pair.resolution == size), None):
        return exact
    larger = [pair for pair in same if FULL_PX[size] % FULL_PX[pair.resolution] == 0]
    if not larger:
        raise PictureError(
            f"{root}: holds {largest.name} at {largest.resolution}, from which {size} cannot be made; "
            f"{standard_set.fetch}, at {size}"
        )
    best = min(larger, key=lambda pair: FULL_PX[pair.resolution])
    return replace(best, resolution=size, shrink=FULL_PX[size] // FULL_PX[best.resolution])


def _pick(by_name: dict[str, StandardPair], only: Sequence[str | int], root: Path) -> tuple[StandardPair, ...]:
    numbers = {int(plain): name for name in by_name if (plain := name.replace("_", "")).isdecimal()}
    requests = [numbers.get(name, str(name)) if isinstance(name, int) else name for name in only]
    if missing := next((name for name in requests if name not in by_name), None):
        names = ", ".join(list(by_name)[:8]) + (f" and {len(by_name) - 8} more" if len(by_name) > 8 else "")
        hint = did_you_mean(missing, by_name)
        raise ConfigError(f"{root}: no pair in it is named {quoted(missing)}{hint}; there are: {shown(names, 400)}")
    return tuple(by_name[name] for name in requests or by_name)


class SetScene(SceneReader):
    """A pair of a standard set: it gives left, right, truth and the cameras."""

    set: SetName
    """The standard set whose layout the folder has."""
    folder: Path | None = None
    """The folder of the set; if left out, a folder of its name next to the file. Nothing is downloaded."""
    name: str | int
    """The name of the pair, such as `Adirondack-perfect`, `000000_10` or `alley_1/frame_0001`."""
    resolution: Resolution | None = None
    """Full size, a half, a third or a quarter; must be in the folder. If left out, the largest in the folder."""
    split: Split | None = None
    """`test` for pairs whose truth the benchmark keeps; if left out, `training`, or `test` without any training."""
    variant: Literal["final", "clean"] | None = None
    """The pass of Sintel; `final` if left out."""
    segments: Path | None = None
    """A label picture of the left view: one colour or number per segment. No texture is segmented."""
    crop: tuple[int, int, int, int] | None = None
    """The part to be felt, [x, y, width, height] in pixels of the left view."""

    @model_validator(mode="before")
    @classmethod
    def _complete_folder(cls, block: Any) -> Any:
        return with_folder_of_set(block)

    def files(self) -> SceneFiles:
        assert self.folder is not None  # by _complete_folder
        (pair,) = pairs(
            self.set, self.folder, resolution=self.resolution, split=self.split, variant=self.variant, only=(self.name,)
        )
        more = {"segments": self.segments, "crop": self.crop}
        files = pair.files().model_dump(exclude_defaults=True) | {key: value for key, value in more.items() if value}
        return SceneFiles.model_validate(files)

    @classmethod
    def suggest(cls, key: str, block: Mapping[str, Any]) -> Iterable[str]:
        try:
            return list(_suggestions(key, block))
        except (TangibleError, TypeError):  # the earlier keys are not finished
            return ()


def _suggestions(key: str, block: Mapping[str, Any]) -> Iterable[str]:
    if key == "set":
        return SETS
    scene = with_folder_of_set(dict(block))
    if key != "name" or scene.get("set") not in SETS:
        return ()
    options = {key: scene[key] for key in ("resolution", "split", "variant") if key in scene}
    return (pair.name for pair in pairs(scene["set"], scene["folder"], **options))


def with_folder_of_set(block: Any) -> Any:
    """Return the options of a set; without a folder, they get a folder of the set's name."""
    if not isinstance(block, dict):
        return block
    options = cast("dict[str, Any]", block)
    name = options.get("set")
    return {**options, "folder": Path(name)} if isinstance(name, str) and options.get("folder") is None else options

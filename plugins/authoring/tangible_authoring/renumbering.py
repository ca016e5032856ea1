"""The numbers of parts after their label picture was painted over: reported, drawn again, followed by the file."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple, cast

from tangible_core.data import label_of_number, name_part, shown_number
from tangible_core.errors import ConfigError
from tangible_core.files import atomic_write
from tangible_core.files.yaml import parse_source, plain, read_text, with_parts
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.engine import Cache
from tangible_core.plugins.registry import default_registry
from tangible_report.numbered_parts import Before, as_drawn

from .first_parts import check_free
from .listed_parts import ListedPart, ListedParts, list_parts

MAX_NAMED = 6  # parts in a message: more do not fit its line


class Moved(NamedTuple):
    """A part of the file, and the number that it has now; None for a part that is gone."""

    before: int
    now: int | None
    name: str


class Numbers(NamedTuple):
    """The parts of a pipeline file, their numbers when they were last drawn, and the files written since."""

    parts: ListedParts
    before: tuple[Before, ...] | None  # the earlier number of each part; None where these are unknown
    moves: list[Moved]
    title: str
    files: tuple[Path, ...]
    wrong: ConfigError | None  # the mistakes that are left, with the cure


def draw_numbers(
    file: Path,
    numbered: Path,
    overrides: Sequence[str] = (),
    *,
    renumber: bool = False,
    force: bool = False,
    with_cache: bool = True,
) -> Numbers:
    """List the parts of a pipeline file, and draw their numbers and names at `numbered`. Raises: OutputError."""
    earlier = as_drawn(numbered)
    if earlier is None:
        check_free([numbered], force=force)
    text, cache = read_text(file), Cache() if with_cache else None
    config = parse_config(text, file, default_registry(), overrides)
    parts = list_parts(Pipeline.from_config(config, default_registry(), cache))
    before = earlier.before(parts.part_map) if earlier else None
    by_rules = {label_of_number(rule.part): "" for rule in config.materials.rules if isinstance(rule.part, int)}
    part_moves = moves({**by_rules, **parts_in(text, file)}, before or ())
    title = config.title or Path(parts.scene_name).name
    if part_moves and not (renumber or force):
        wrong = ConfigError(
            f"{file}: {in_words(part_moves)}, since {numbered} was drawn; --renumber lets what the file says of them "
            "follow, --force draws the numbers alone"
        )
        return Numbers(parts, before, part_moves, title, (), wrong)
    contents = {numbered: parts.numbers_png}
    if part_moves and renumber and before:
        _check_rules(file, by_rules, part_moves)
        text = renumber_parts(text, file, before, parts.parts)
        config = parse_config(text, file, default_registry(), overrides)
        parts = list_parts(Pipeline.from_config(config, default_registry(), cache))
        contents = {numbered: parts.numbers_png, file: text.encode()}
    _write_together(contents)
    return Numbers(parts, before, part_moves, title, tuple(contents), parts.wrong)


def _check_rules(file: Path, by_rules: Collection[int], all_moves: Iterable[Moved]) -> None:
    if move := next((move for move in all_moves if move.before in by_rules), None):
        raise ConfigError(
            f"{file}: a rule of materials.rules is for {name_part(move.before)} by its number, which has "
            "changed; give the part a name, and write that into the rule"
        )


def _write_together(contents: Mapping[Path, bytes]) -> None:
    """Write all files or none: one file alone would move the numbers twice. Raises: OutputError."""
    with ExitStack() as stack:
        for path, content in contents.items():
            file = stack.enter_context(atomic_write(path))
            file.write(content)
            file.flush()


def moves(choices: Mapping[int, Any], before: Sequence[Before]) -> list[Moved]:
    """Find the parts of the file that have another number now, or are gone. before: the earlier number of each part."""
    now = {part.number: number for number, part in enumerate(before) if part.number is not None}
    all_moves = (
        Moved(number, now.get(number), str(_block(choice).get("name") or "")) for number, choice in choices.items()
    )
    return [part for part in all_moves if before and part.now != part.before]


def in_words(all_moves: Sequence[Moved]) -> str:
    """Name the parts whose numbers have changed.

    >>> in_words([Moved(2, 3, "head"), Moved(3, None, "")])
    'numbers of parts have changed: 3 (head) is now 4, 4 is no more'
    """
    changes = (
        f"{shown_number(move.before)}{move.name and f' ({move.name})'} is "
        f"{'no more' if move.now is None else f'now {shown_number(move.now)}'}"
        for move in all_moves[:MAX_NAMED]
    )
    more = [f"and {len(all_moves) - MAX_NAMED} more"] if len(all_moves) > MAX_NAMED else []
    return f"numbers of parts have changed: {', '.join([*changes, *more])}"


def parts_in(text: str, path: Path) -> dict[int, Any]:
    """Read the parts of a pipeline file by label, as plain values. Raises: ConfigError if it is not YAML."""
    block = plain(parse_source(text, path, "a configuration is a mapping that starts with `scene:`").tree).get("parts")
    entries = cast("dict[int, Any]", block) if isinstance(block, dict) else {}
    return {label_of_number(number): entry for number, entry in entries.items()}


def renumber_parts(text: str, path: Path, before: Sequence[Before], rows: Sequence[ListedPart]) -> str:
    """Return the text with a line for each part, as that of its earlier number. Raises: ConfigError."""
    choices = parts_in(text, path)
    parts = {number: _earlier_choice(choices, earlier) for number, earlier in enumerate(before, 1)}
    comments = {shown_number(part.number): _comment(was, part) for was, part in zip(before, rows, strict=True)}
    try:
        return with_parts(text, path, parts, comments)
    except ConfigError as error:
        raise ConfigError(f"{error}; number them by hand, as the table says") from error


def _earlier_choice(choices: Mapping[int, Any], before: Before) -> Any:
    if before.number is not None:
        return choices.get(before.number, {"name": ""})
    height = _block(choices.get(before.cut_from)).get("height_m")
    return {"name": ""} if height is None else {"name": "", "height_m": height}


def _comment(before: Before, part: ListedPart) -> str:
    new = f", new, cut from what was {name_part(before.cut_from)}" if before.number is None else ""
    return f"{name_part(part.number)}: {part.where}{new}"


def _block(choice: Any) -> dict[str, Any]:
    return cast("dict[str, Any]", choice) if isinstance(choice, dict) else {"name": choice}

"""The block `parts:` of a pipeline file, one line for each part."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...errors import ConfigError
from .editing import on_one_line
from .source import plain_tree

BLOCK = re.compile(r"^parts:.*\n(?:(?:[ \t]*\n)*[ \t]+\S.*\n)*", re.MULTILINE)
"""The key with the lines below it, up to the next key at the top."""


def part_lines(parts: Mapping[int, Any], comments: Mapping[int, str] | None = None) -> str:
    """Write a line for each part, the comments in a column behind them.

    >>> print(part_lines({1: "wall", 7: {"name": "helmet"}}, {1: "on the left", 7: "in the middle"}), end="")
      1: wall             # on the left
      7: {name: helmet}   # in the middle
    """
    heads = {number: f"  {number}: {on_one_line(part)}" for number, part in parts.items()}
    wide, comments = max(map(len, heads.values()), default=0), comments or {}
    behind = {number: f"   # {comment}" for number, comment in comments.items() if comment}
    return "".join(f"{head:<{wide}}{behind.get(number, '')}".rstrip() + "\n" for number, head in heads.items())


def with_parts(text: str, path: Path, parts: Mapping[int, Any], comments: Mapping[int, str] | None = None) -> str:
    """Return the text with a line for each part in place of the lines of `parts:`, or at its end if it has none."""
    block = f"parts:\n{part_lines(parts, comments)}"
    before = f"{text}\n" if text and not text.endswith("\n") else text
    after, times = BLOCK.subn(lambda _: block, before, count=1)
    after = after if times else f"{before}{block}"
    if plain_tree(after, path) != {**plain_tree(text, path), "parts": dict(parts)}:
        raise ConfigError(f"{path}: `parts:` is not a block of lines, one for each part")
    return after

"""What is asked before a surface is felt that is hardly worth it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import typer

from .options import FAILED

if TYPE_CHECKING:
    from ..pipeline.pipeline import Pipeline


def ask_first(pipeline: Pipeline, yes: bool) -> None:
    """Make the touch, and go on if it is worth feeling, or if the user, asked at a terminal or by `--yes`, wants it.

    Raises: Exit with 1 if the user does not; PictureError where nobody can be asked; TangibleError as `Pipeline.make`.
    """
    from ..errors import PictureError

    pipeline.make("touch")
    doubts = "; ".join(each.text.partition(":")[0] for each in pipeline.outcomes.doubts)
    if yes or not doubts:
        return
    if sys.stdin is None or not sys.stdin.isatty():
        raise PictureError(f"{doubts}; put it right as the warning says, or feel it all the same with --yes")
    if not typer.confirm(f"{doubts[:1].upper()}{doubts[1:]}. Feel it all the same?", err=True):
        raise typer.Exit(FAILED)

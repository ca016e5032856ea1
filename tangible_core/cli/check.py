"""`check`: the conformance kit against one installed method."""

from typing import Annotated

import typer

from ..plugins.registry import KIND_NAMES
from . import completing
from .options import FAILED, Json


def check(
    kind: Annotated[
        str, typer.Argument(help=" | ".join(KIND_NAMES), show_default=False, autocompletion=completing.kinds)
    ],
    name: Annotated[
        str,
        typer.Argument(
            help="The method, as `tangible plugins` lists it.", show_default=False, autocompletion=completing.methods
        ),
    ],
    as_json: Json = False,
) -> None:
    """Test an installed method with the conformance kit.

    Exit 1 if a check fails.
    """
    from rich.markup import escape

    from ..testing import run_checks
    from . import show

    results = list(run_checks(kind, name))
    failed = [each for each in results if not each.passed]
    if as_json:
        show.print_json([{"name": each.name, "passed": each.passed, "message": each.message} for each in results])
    else:
        grades = {True: "[green]passed[/]", False: "[red]FAILED[/]"}
        rows = [(each.name, grades[each.passed], escape(each.message)) for each in results]
        show.table(("check", "result", "message"), rows)
        show.say(f"\n{len(results) - len(failed)} passed, {len(failed)} failed")
    if failed:
        raise typer.Exit(FAILED)

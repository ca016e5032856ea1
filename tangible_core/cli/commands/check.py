"""`check`: the conformance kit against one installed method."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Annotated

import typer

from ...plugins.registry import KIND_NAMES
from .. import completing
from ..options import FAILED, Json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...testing import CheckResult


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

    Exit 1 if a check fails that the method does not declare to fail, or passes that it declares to fail.
    """
    from rich.markup import escape

    from ...testing import run_checks
    from .. import sentences, show

    results = list(run_checks(kind, name))
    if as_json:
        show.print_json([each._asdict() for each in results])
    else:
        rows = [(each.name, GRADES[each.passed, bool(each.expected_failure)], escape(_said(each))) for each in results]
        show.sentence(sentences.checked(f"{kind} method {name}", results))
        show.table(("check", "result", "message"), rows)
        show.say(f"\n{_count(results)}")
    if not all(each.as_declared for each in results):
        raise typer.Exit(FAILED)


GRADES = {
    (True, False): "[green]passed[/]",
    (False, False): "[red]FAILED[/]",
    (False, True): "[yellow]fails as declared[/]",
    (True, True): "[red]PASSED, declared to fail[/]",
}
"""By whether it passed, and whether it was declared to fail."""


def _said(result: CheckResult) -> str:
    return (
        f"{result.expected_failure} ({result.message})"
        if result.expected_failure and not result.passed
        else result.message
    )


def _count(results: Sequence[CheckResult]) -> str:
    numbers = Counter((each.passed, bool(each.expected_failure)) for each in results)
    parts = [f"{numbers[True, False]} passed", f"{numbers[False, False]} failed"]
    if declared := numbers[False, True]:
        parts.append(f"{declared} failed as the method declares")
    if wrong := numbers[True, True]:
        parts.append(f"{wrong} passed that the method declares to fail")
    return ", ".join(parts)

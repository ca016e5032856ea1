"""`check`: the conformance kit against one installed method."""

from rich.markup import escape

from ..testing import run_checks
from . import show


def check(kind: str, name: str, as_json: bool) -> bool:
    """Run every check of the kind; True if all passed."""
    results = list(run_checks(kind, name))
    failed = [each for each in results if not each.passed]
    if as_json:
        show.print_json([{"name": each.name, "passed": each.passed, "message": each.message} for each in results])
        return not failed
    rows = [
        (each.name, "[green]passed[/]" if each.passed else "[red]FAILED[/]", escape(each.message)) for each in results
    ]
    show.table(("check", "result", "message"), rows)
    show.say(f"\n{len(results) - len(failed)} passed, {len(failed)} failed")
    return not failed

"""`compare --submission`: a folder of disparity maps to send to a benchmark."""

from dataclasses import asdict
from pathlib import Path

import typer

from tangible_core.cli import FAILED, is_quiet, show
from tangible_core.data import Outcome
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry

from ..config.reading import Comparison
from ..submitting import Submitted, submit


def write_submissions(comparison: Comparison, folder: Path, as_json: bool) -> None:
    """Write the disparity maps of all methods. Raises: Exit with 1 if a method has no result on a pair."""
    plugins = default_registry().plugins

    def report_start(method: str, scene: str) -> None:
        hooks.tell(plugins, "tangible_stage_started", product=scene, method=method)

    submitted: list[Submitted] = []
    for each in submit(comparison, folder, report_start):
        submitted.append(each)
        kind, why = ("failed", each.error) if each.error else ("ran", "written")
        outcome = Outcome(each.scene, kind, why, each.method, each.seconds)
        hooks.tell(plugins, "tangible_stage_finished", outcome=outcome)
    failed = [each for each in submitted if each.error]
    if as_json:
        show.print_json([{**asdict(each), "files": [str(path) for path in each.files]} for each in submitted])
    elif not is_quiet():
        for method in dict.fromkeys(each.method for each in submitted):
            count = sum(len(each.files) for each in submitted if each.method == method)
            show.plain(f"{method}: {count} files in {folder}")
    for each in failed:
        show.flush()
        show.note(f"no result of {each.method} on {each.scene}: {each.error}")
    if failed:
        raise typer.Exit(FAILED)

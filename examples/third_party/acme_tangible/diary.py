"""An observer: one line for each stage, in the file that ACME_DIARY names."""

import os
from pathlib import Path

from tangible_core.plugins import Outcome, hookimpl


@hookimpl
def tangible_stage_finished(outcome: Outcome) -> None:
    """Write down what became of a product, and why."""
    if diary := os.environ.get("ACME_DIARY"):
        with Path(diary).open("a", encoding="utf-8") as file:
            file.write(f"{outcome.product}: {outcome.outcome}, {outcome.why}\n")

"""Writes what happens to the log: `--log-level info`, or `tangible_core.plugins.observers.log=info` for this alone."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from ..hooks import hookimpl

if TYPE_CHECKING:
    from ...data import Outcome, Plan, ServoReport

log = logging.getLogger(__name__)


@hookimpl
def tangible_plan_made(plan: Plan) -> None:
    """One line a plan."""
    log.info("plan for %s: %s", plan.want, ", ".join(f"{step.product} {step.outcome}" for step in plan.steps))


@hookimpl
def tangible_stage_started(product: str, method: str) -> None:
    """One line a start."""
    log.debug("making %s with %s", product, method)


@hookimpl
def tangible_stage_finished(outcome: Outcome) -> None:
    """One line a product; whoever asked for one that failed hears of it by the error itself."""
    log.info("%s: %s, %s (%.3f s)", outcome.product, outcome.outcome, outcome.why, outcome.seconds)


@hookimpl
def tangible_servo_report(report: ServoReport) -> None:
    """Ten lines a second, for who asks for them."""
    under = ", ".join(filter(None, (report.part, report.material)))
    on = f", on {under}" if under else ""
    log.debug("servo: %d ticks, %.1f s, force %.2f N%s", report.ticks, report.time_s, report.peak_force_n, on)

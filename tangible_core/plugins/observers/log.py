"""Log lines about each plan and each product: `--log-level info`, or `tangible_core.plugins.observers.log=info`."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from ..hooks import hookimpl

if TYPE_CHECKING:
    from ...data import Outcome, Plan, ServoReport

log: logging.Logger = logging.getLogger(__name__)


@hookimpl
def tangible_plan_made(plan: Plan) -> None:
    """Log a line for the plan."""
    log.info("plan for %s: %s", plan.want, ", ".join(f"{step.product} {step.outcome}" for step in plan.steps))


@hookimpl
def tangible_stage_started(product: str, method: str) -> None:
    """Log the start of a product, for debugging."""
    log.debug("computing %s with %s", product, method)


@hookimpl
def tangible_stage_finished(outcome: Outcome) -> None:
    """Log a line for the product; a failed product raises its error as well."""
    log.info("%s: %s, %s (%.3f s)", outcome.product, outcome.outcome, outcome.why, outcome.seconds)


@hookimpl
def tangible_servo_report(report: ServoReport) -> None:
    """Log a line for the report, for debugging: ten lines a second."""
    under = ", ".join(filter(None, (report.part, report.material)))
    on = f", on {under}" if under else ""
    log.debug("servo: %d ticks, %.1f s, force %.2f N%s", report.ticks, report.time_s, report.peak_force_n, on)

"""Moments that plugins may watch or add to. Nouns come by entry point, moments by pluggy."""

from __future__ import annotations

import logging
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import pluggy

from ..errors import did_you_mean, shown
from ..runtime.failure_log import where_kept
from ..runtime.slowness import warn_if_slow
from .origin import origin

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from typer import Typer

    from ..data import Kind, Outcome, Plan, ServoReport
    from .panel import Panel

log = logging.getLogger(__name__)
hookspec = pluggy.HookspecMarker("tangible")
hookimpl = pluggy.HookimplMarker("tangible")
_failed: WeakKeyDictionary[pluggy.PluginManager, set[tuple[str, str]]] = WeakKeyDictionary()
"""Observers that failed, and the moments: a moment may come ten times a second, and is complained of once."""


class Specs:
    """Every moment. A module that implements some of them is named in the entry-point group `tangible.hooks`."""

    @hookspec
    def tangible_methods(self, kind: Kind) -> Mapping[str, str]:  # pyright: ignore[reportReturnType]
        """More names for this kind, as 'package.module:Class'; nothing is imported."""

    @hookspec
    def tangible_plan_made(self, plan: Plan) -> None:
        """A plan was made; what follows runs it, unless only the plan was asked for."""

    @hookspec
    def tangible_stage_started(self, product: str, method: str) -> None:
        """A product is being made."""

    @hookspec
    def tangible_stage_finished(self, outcome: Outcome) -> None:
        """A product is given, ran, cached, skipped, failed or refused; outcome.why says why."""

    @hookspec
    def tangible_servo_report(self, report: ServoReport) -> None:
        """Ten times a second of the loop's time, from the host, never inside the loop."""

    @hookspec
    def tangible_panels(self) -> Sequence[Panel]:  # pyright: ignore[reportReturnType]
        """Panels to add to a run's sheet, after those that are there; asked for whenever a sheet is drawn."""

    @hookspec
    def tangible_commands(self, app: Typer) -> None:
        """Add commands to `tangible`."""


def manager() -> pluggy.PluginManager:
    """A manager with every installed hook module; one that cannot be imported is logged and left out."""
    plugins = pluggy.PluginManager("tangible")
    plugins.add_hookspecs(Specs)
    for point in entry_points(group="tangible.hooks"):
        try:
            with warn_if_slow(log, f"importing hooks {point.name} ({point.value})"):
                module = point.load()
            plugins.register(module, name=f"{origin(point.dist).name}/{point.name}")
        except (Exception, SystemExit) as error:
            log.warning("hooks %s (%s) cannot be loaded and are left out: %r", point.name, point.value, error)
            log.debug("the import of %s", point.value, exc_info=True)
    _say_unknown_moments(plugins)
    return plugins


def _say_unknown_moments(plugins: pluggy.PluginManager) -> None:
    moments = [name for name in vars(Specs) if name.startswith("tangible_")]
    for name, plugin in plugins.list_name_plugin():
        for each in plugins.get_hookcallers(plugin) or []:
            if each.name not in moments:
                near = did_you_mean(each.name, moments)
                log.warning("hooks %s watch %s, which is not a moment%s", name, each.name, near)


def tell(plugins: pluggy.PluginManager, moment: str, **facts: Any) -> list[Any]:
    """Call every observer of a moment, one at a time; one that raises is logged, and the rest still hear."""
    answers: list[Any] = []
    for each in plugins.hook.__getattribute__(moment).get_hookimpls():
        try:
            answers.append(each.function(*(facts[name] for name in each.argnames)))
        except Exception as error:  # noqa: BLE001 - whatever it raises, the others hear
            _say_failed(plugins, each.plugin_name, moment, error)
    return [answer for answer in answers if answer is not None]


def _say_failed(plugins: pluggy.PluginManager, name: str, moment: str, error: Exception) -> None:
    known = _failed.setdefault(plugins, set())
    if (name, moment) in known:
        log.debug("observer %s failed in %s again", name, moment, exc_info=error)
        return
    known.add((name, moment))
    what = f"{type(error).__name__}: {shown(str(error), 500)}"
    log.warning("observer %s failed in %s and is ignored: %s; %s", name, moment, what, where_kept(error))

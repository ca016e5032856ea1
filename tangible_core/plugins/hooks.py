"""The hooks: moments that plugins watch or contribute to, by pluggy; methods come by entry points."""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakKeyDictionary

import pluggy

from ..errors import did_you_mean, shown
from ..runtime.failure_log import where_kept
from ..runtime.stopping import warn_if_slow
from .naming import origin

if TYPE_CHECKING:
    from typer import Typer

    from ..data import Kind, Outcome, Plan, ServoReport

log: logging.Logger = logging.getLogger(__name__)
hookspec: pluggy.HookspecMarker = pluggy.HookspecMarker("tangible")
hookimpl: pluggy.HookimplMarker = pluggy.HookimplMarker("tangible")
# Observers that failed and the hooks in which they did: a hook may run ten times a second, and is reported once.
_failed: WeakKeyDictionary[pluggy.PluginManager, set[tuple[str, str]]] = WeakKeyDictionary()


class Panel(NamedTuple):
    """A panel of a run's sheet: its drawing, the products that it shows, and its size."""

    draw: Callable[..., str]
    """A function of matplotlib's axes and, by name, the products below; it draws and returns a headline."""
    needs: Collection[str]
    """The products without which the panel is left out: views, truth, disparity, segments, parts, materials, relief,
    surface, recording."""
    likes: Collection[str] = ()
    """Further products, passed where the run has them."""
    aspect: float | Callable[..., float] = 0.0
    """Width over height; 0 is the scene's. A function is called with the products by name."""
    left_in: float = 0.15
    right_in: float = 0.15
    bottom_in: float = 0.4
    least_in: float = 2.9
    """The width for the headline, in inches, where the axes are narrower."""


class Specs:
    """The hooks. A module that implements some of them is named in the entry-point group `tangible.hooks`."""

    @hookspec
    def tangible_methods(self, kind: Kind) -> Mapping[str, str]:  # pyright: ignore[reportReturnType]
        """Return more names for this kind, as 'package.module:Class'; nothing is imported."""

    @hookspec
    def tangible_plan_made(self, plan: Plan) -> None:
        """Watch a plan that was made; its stages follow, unless only the plan was requested."""

    @hookspec
    def tangible_stage_started(self, product: str, method: str) -> None:
        """Watch the start of a product."""

    @hookspec
    def tangible_stage_finished(self, outcome: Outcome) -> None:
        """Watch the end of a product: given, ran, cached, skipped, failed or refused; outcome.why has the reason."""

    @hookspec
    def tangible_servo_report(self, report: ServoReport) -> None:
        """Watch the force loop: ten times a second of its time, called in the host process, never inside the loop."""

    @hookspec
    def tangible_panels(self) -> Sequence[Panel]:  # pyright: ignore[reportReturnType]
        """Return panels to add to the end of a run's sheet; called for every sheet."""

    @hookspec
    def tangible_listings(self) -> Sequence[Any]:  # pyright: ignore[reportReturnType]
        """Return what `tangible plugins` lists besides methods, a `registry.Listing` each; nothing is imported."""

    @hookspec
    def tangible_legibility(self) -> Mapping[str, str]:  # pyright: ignore[reportReturnType]
        """Return the functions that `judge` and `simplify` parts for fingers, as 'package.module:function'; nothing is
        imported, and the first answer counts."""

    @hookspec
    def tangible_networks(self) -> Mapping[str, str]:  # pyright: ignore[reportReturnType]
        """Return the functions that `look` at a photograph with networks, `read` the texts of a picture, and tell the
        `identity` of those that are here, for some tasks or for those of photographs, as 'package.module:function';
        nothing is imported, and the first answer counts.
        """

    @hookspec
    def tangible_commands(self, app: Typer) -> None:
        """Add commands to `tangible`."""


def manager() -> pluggy.PluginManager:
    """Make a manager with all installed hook modules; a module that cannot be imported is logged and left out."""
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
    specs = [name for name in vars(Specs) if name.startswith("tangible_")]
    for name, plugin in plugins.list_name_plugin():
        for hookcaller in plugins.get_hookcallers(plugin) or []:
            if hookcaller.name not in specs:
                near = did_you_mean(hookcaller.name, specs)
                log.warning("%s implements an unknown hook: %s%s", name, hookcaller.name, near)
    return plugins


def tell(plugins: pluggy.PluginManager, moment: str, **facts: Any) -> list[Any]:
    """Call the implementations of a hook one by one, and return their answers; an error is logged, the rest go on."""
    answers: list[Any] = []
    for hookimpl in plugins.hook.__getattribute__(moment).get_hookimpls():
        try:
            answers.append(hookimpl.function(*(facts[name] for name in hookimpl.argnames)))
        except Exception as error:  # noqa: BLE001 - the other observers are called all the same
            _warn_of_failure(plugins, hookimpl.plugin_name, moment, error)
    return [answer for answer in answers if answer is not None]


def _warn_of_failure(plugins: pluggy.PluginManager, name: str, moment: str, error: Exception) -> None:
    failures = _failed.setdefault(plugins, set())
    if (name, moment) in failures:
        log.debug("observer %s failed in %s again", name, moment, exc_info=error)
        return
    failures.add((name, moment))
    what = f"{type(error).__name__}: {shown(str(error), 500)}"
    log.warning("observer %s failed in %s and is ignored: %s; %s", name, moment, what, where_kept(error))

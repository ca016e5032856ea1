"""Panels that plugins add to a run's sheet."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

from tangible_core.errors import shown
from tangible_core.plugins import hooks
from tangible_core.plugins.hooks import Panel
from tangible_core.plugins.registry import default_registry

if TYPE_CHECKING:
    from matplotlib.axes import Axes

log = logging.getLogger(__name__)


def added_panels() -> Iterator[Panel]:
    """What hook modules add by `tangible_panels`; what is no panel is logged and left out."""
    for answer in hooks.tell(default_registry().plugins, "tangible_panels"):
        for panel in answer if isinstance(answer, Iterable) else [answer]:  # pyright: ignore[reportUnknownVariableType]
            if isinstance(panel, Panel):
                yield panel._replace(draw=_guarded(panel.draw))
            else:
                log.warning("tangible_panels gave %s, which is no Panel; it is left out", shown(repr(panel)))  # pyright: ignore[reportUnknownArgumentType]


def _guarded(draw: Callable[..., str]) -> Callable[..., str]:
    """A panel that fails says so in its place: the others are worth drawing."""

    def guarded(axes: Axes, **run: Any) -> str:
        try:
            return str(draw(axes, **run))
        except Exception as error:
            log.warning("a panel of a plugin could not be drawn", exc_info=True)
            axes.clear()
            axes.set_axis_off()
            return shown(f"Not drawn, {type(error).__name__}: {error}", 60)

    return guarded

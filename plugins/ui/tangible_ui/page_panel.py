"""Panels that plugins bring to the page, found by the entry-point group `tangible.page`."""

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, Literal

log: logging.Logger = logging.getLogger(__name__)
GROUP = "tangible.page"


@dataclass(frozen=True)
class PagePanel:
    """A panel of the page, the last of its task, closed at first."""

    module: Path  # the panel's ES module; the page may fetch the files of its folder, and no others
    title: Mapping[str, str]  # heading by language, "en" at least
    # Functions of the panel's requests: called with the document's pipeline, and JSON arguments by name.
    requests: Mapping[str, Callable[..., Any]] = field(default_factory=dict[str, Callable[..., Any]])
    # The task of the page that the panel serves; "advanced" puts it among the settings.
    task: Literal["picture", "parts", "feel", "hand-on", "advanced"] = "advanced"


@cache
def installed_panels() -> Mapping[str, PagePanel]:
    """Return the installed panels by name; one that cannot be loaded is logged and left out."""
    panels: dict[str, PagePanel] = {}
    for point in entry_points(group=GROUP):
        try:
            panel = point.load()
            if not isinstance(panel, PagePanel) or not panel.module.is_file():
                raise TypeError(f"{point.value} is not a PagePanel with a module that exists")
            panels[point.name] = panel
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an import of a plugin raises
            log.warning("the page's panel %s (%s) cannot be loaded and is left out: %r", point.name, point.value, error)
    return panels

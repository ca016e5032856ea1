"""A plugin brings a panel to the page: otherwise it is not there, or opens other files of its folder to the page."""

import os
import re
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from page_files import ROOT, built_page
from page_panels import bring, wait_for_force
from page_server import KEY, PageServer
from sessions import small_scene
from tangible_core.errors import ConfigError
from tangible_ui import page_panel
from tangible_ui.page_panel import PagePanel
from waiting import until

pytestmark = pytest.mark.anyio


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """The folder in which the example is installed."""
    section = (ROOT / "docs/how-to/write-a-plugin.md").read_text("utf-8").partition("## A panel of the page")[2]
    python, script, toml = (block.partition("\n")[2] for block in section.split("```")[1:6:2])
    folder = tmp_path / "site"
    about = folder / "acme_panel-1.dist-info"
    about.mkdir(parents=True)
    (folder / "acme_panel.py").write_text(python, "utf-8")
    (folder / "acme_panel.js").write_text(script, "utf-8")
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: acme-panel\nVersion: 1\n")
    (about / "entry_points.txt").write_text(
        toml.replace('project.entry-points."tangible.page"', "tangible.page").replace('"', "")
    )
    return folder


def test_panel_of_a_plugin_is_opened_and_answered(installed: Path, serve, open_page, tmp_path: Path) -> None:
    built_page()
    path = f"{installed}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    page = open_page(serve(small_scene(tmp_path), cwd=tmp_path, PYTHONPATH=path).url)
    wait_for_force(page)
    panel = bring(page, "plugin-acme")
    assert panel.locator("summary").inner_text() == "Highest point"
    panel.locator("summary").press("Enter")
    panel.get_by_role("button", name="Measure").press("Enter")
    until(lambda: re.fullmatch(r"3\.\d\d mm", panel.locator("p").inner_text()))
    until(lambda: page.locator("#said").inner_text().strip() == panel.locator("p").inner_text())


@pytest.fixture
def panels(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> dict[str, Any]:
    """Objects that entry points of the group lead to, by name."""
    found: dict[str, Any] = {}

    class Point:
        def __init__(self, name: str) -> None:
            self.name, self.value = name, f"{name}:panel"

        def load(self) -> Any:
            return found[self.name]

    points = lambda group: [Point(name) for name in found] if group == "tangible.page" else EntryPoint  # noqa: E731
    monkeypatch.setattr(page_panel, "entry_points", points)
    page_panel.installed_panels.cache_clear()
    yield found
    page_panel.installed_panels.cache_clear()


def module(folder: Path) -> Path:
    folder.mkdir()
    (folder / "glove.js").write_text("export default () => undefined")
    (folder.parent / "secret.js").write_text("secret")
    return folder / "glove.js"


async def test_request_of_a_panel_gets_the_pipeline_and_an_unknown_one_is_refused(
    panels: dict[str, Any], ask: Any, tmp_path: Path
) -> None:
    requests = {"width": lambda pipeline, by: by * pipeline.config.size.width_m}
    panels["glove"] = PagePanel(module(tmp_path / "glove"), {"en": "Glove"}, requests)
    assert await ask("panels") == [
        {"name": "glove", "title": {"en": "Glove"}, "module": "/panels/glove/glove.js", "task": "advanced"}
    ]
    assert await ask("ask_panel", panel="glove", request="width", arguments={"by": 2}) == pytest.approx(0.12)
    with pytest.raises(ConfigError, match=r"'glvoe' is not a panel of a plugin .did you mean 'glove'"):
        await ask("ask_panel", panel="glvoe", request="width")
    with pytest.raises(ConfigError, match=r"the panel glove answers no request 'witdh' .did you mean 'width'"):
        await ask("ask_panel", panel="glove", request="witdh")


def test_files_of_a_panel_are_served_and_no_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    glove = module(tmp_path / "glove")
    with PageServer(tmp_path, monkeypatch) as server:
        server.done(lambda: server.session.panel_folders.update(glove=glove.parent))
        answer = server.ask(f"/panels/glove/glove.js?token={KEY}")
        assert (answer.status, answer.text) == (200, glove.read_text())
        assert "javascript" in answer.headers["content-type"]
        assert server.ask("/panels/glove/glove.js").status == 403
        for path in ("glove/other.js", "glove/..%2fsecret.js", "other/glove.js", "glove/%2e%2e"):
            assert server.ask(f"/panels/{path}?token={KEY}").status == 404

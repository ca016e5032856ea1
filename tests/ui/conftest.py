"""A browser for the tests of the page: Chromium as the system has it, drawing in software.

Everything that a page complains of fails its test, and so does every request that leaves this machine. A module that
uses a browser has it for itself: playwright runs an event loop in the thread of the tests as long as it is open, beside
which `asyncio.run` does not work.
"""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from browser_tabs import OpenPage, tabs
from needed import lacking
from ui_server import UiServer

if TYPE_CHECKING:
    from playwright.sync_api import Browser

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = [
    "--no-sandbox",  # which root may not have
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--autoplay-policy=no-user-gesture-required",
]
DIRS = ("CACHE", "RUNTIME", "CONFIG", "LOG", "DATA")

Serve = Callable[..., UiServer]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Whatever needs a browser or a server is slow."""
    for item in items:
        if {"browser", "serve"} & set(getattr(item, "fixturenames", ())):
            item.add_marker("slow")


@pytest.fixture(scope="module")
def browser() -> "Iterator[Browser]":
    """Chromium without a window, named by TANGIBLE_UI_BROWSER or found where the system keeps it."""
    found = [path for name in BROWSERS if (path := shutil.which(name))]
    path = os.environ.get("TANGIBLE_UI_BROWSER") or next(iter(found), "")
    if not path:
        lacking("no Chromium is installed (on Debian: apt-get install chromium), and TANGIBLE_UI_BROWSER names none")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def serve(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serve]:
    """`serve("p.yaml", cwd=folder)` starts `tangible ui`, which has folders of its own; all end with the module.

    A test that must not meet what another one left behind takes one for itself: `with serve(...) as server`.
    """
    started: list[UiServer] = []

    def serve(*words: object, cwd: Path | None = None, **env: str) -> UiServer:
        folder = tmp_path_factory.mktemp("served")
        own = {f"TANGIBLE_{name}_DIR": str(folder / name.lower()) for name in DIRS}
        for path in own.values():
            Path(path).mkdir()
        started.append(UiServer(*words, cwd=cwd or folder, env={**own, **env}))
        return started[-1]

    yield serve
    for server in started:
        if server.process.returncode is None:
            server.stop()


@pytest.fixture
def complaints() -> list[str]:
    """What pages complained of so far; a test that provokes a complaint looks for it here and clears it."""
    return []


@pytest.fixture
def open_page(browser: "Browser", complaints: list[str]) -> Iterator[OpenPage]:
    """`open_page(server.url, color_scheme="dark")`: a tab of its own, watched; options as of `new_context`.

    The page's policy lets nothing evaluate text: `wait_for_function` is given a function, `"() => window.ready"`.
    """
    with tabs(browser, complaints) as opened:
        yield opened

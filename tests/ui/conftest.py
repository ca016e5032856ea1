"""A browser for the tests of the page: Chromium as the system has it, drawing in software.

Everything that a page complains of fails its test, and so does every request that leaves this machine. A worker has one
browser and one server for all tests of the page: a test has a context of its own in the one, and opens its file in the
other. A test that ends its server, or looks at what its start does, starts one for itself.
"""

import asyncio
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from browser_tabs import Chromium, OpenPage, tabs
from lasting_server import LastingServer
from needed import lacking
from page_files import built_page
from ui_server import UiServer

if TYPE_CHECKING:
    from playwright.sync_api import Browser

    from tangible_ui.worker.state import WorkerState

BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""The first that is installed; the shell is the same without windows, at two thirds of the processor time."""
FLAGS = [
    "--no-sandbox",  # which root may not have
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-gpu-rasterization",  # in software, a processor draws text and boxes sooner than it plays a graphics card
    "--autoplay-policy=no-user-gesture-required",
]
DIRS = ("CACHE", "RUNTIME", "CONFIG", "LOG", "DATA")

Serve = Callable[..., UiServer]
Opened = Callable[..., str]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark as slow what needs a browser or a server, and leave it time on a machine that stands still meanwhile."""
    for item in items:
        if {"browser", "serve", "opened"} & set(getattr(item, "fixturenames", ())):
            item.add_marker("slow")
            item.add_marker(pytest.mark.timeout(1200))


@pytest.fixture(scope="package")
def chromium() -> Iterator[Chromium]:
    """Chromium without a window, named by TANGIBLE_UI_BROWSER or found where the system keeps it."""
    found = [path for name in BROWSERS if (path := shutil.which(name))]
    path = os.environ.get("TANGIBLE_UI_BROWSER") or next(iter(found), "")
    if not path:
        install = "apt-get install chromium-headless-shell"
        lacking(f"no Chromium is installed (on Debian: {install}), and TANGIBLE_UI_BROWSER names none")
    from playwright.sync_api import sync_playwright

    playwright = sync_playwright().start()
    chromium = Chromium(playwright.chromium.launch(executable_path=path, args=FLAGS))
    asyncio._set_running_loop(None)
    yield chromium
    with chromium.used():
        chromium.browser.close()
        playwright.stop()


@pytest.fixture
def browser(chromium: Chromium) -> "Iterator[Browser]":
    """The worker's Chromium."""
    with chromium.used() as browser:
        yield browser


@pytest.fixture
def serve(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Serve]:
    """`serve("p.yaml", cwd=folder)` starts `tangible ui`, which has folders of its own; all end with the test."""
    with ExitStack() as started:

        def serve(*words: object, cwd: Path | None = None, **env: str) -> UiServer:
            folder = tmp_path_factory.mktemp("served")
            server = UiServer(*words, cwd=cwd or folder, env={**own_folders(folder), **env})
            return started.enter_context(server)

        yield serve


@pytest.fixture(scope="package")
def lasting(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LastingServer]:
    """The worker's server, which `opened` opens files in."""
    built_page()
    folder = tmp_path_factory.mktemp("lasting")
    with LastingServer(folder, own_folders(folder)) as server:
        yield server


@pytest.fixture
def opened(lasting: LastingServer) -> Opened:
    """`opened("p.yaml")`: the file is opened and felt in the worker's server; gives the page's address.

    As after a start there are no recordings, no unsaved documents and no verdicts, and the page's own hand is felt;
    what was made of earlier files is cached.
    """
    return lasting.open


def own_folders(folder: Path) -> dict[str, str]:
    """Environment of a server that shares no folder with others."""
    own = {f"TANGIBLE_{name}_DIR": folder / name.lower() for name in DIRS}
    for path in own.values():
        path.mkdir()
    return {name: str(path) for name, path in own.items()}


@pytest.fixture
def complaints() -> list[str]:
    """Complaints of pages so far; a test that provokes one looks for it here and clears the list."""
    return []


@pytest.fixture
def open_page(browser: "Browser", complaints: list[str], serve: Serve) -> Iterator[OpenPage]:
    """`open_page(server.url, color_scheme="dark")`: a tab of its own, watched; options as of `new_context`.

    Tabs are closed before the test's servers end: a tab complains of a server that is gone.
    The page's policy lets nothing evaluate text: `wait_for_function` is given a function, `"() => window.ready"`.
    """
    with tabs(browser, complaints) as opened:
        yield opened


@pytest.fixture
def worker_state(tmp_path: Path) -> "WorkerState":
    """A worker's state, whose events are in `worker_state.heard`."""
    from tangible_core.pipeline.engine.cache import Cache
    from tangible_ui.worker.state import WorkerState

    heard: list[tuple[str, dict[str, Any]]] = []
    made = WorkerState(tmp_path, lambda event, **told: heard.append((event, told)), Cache(tmp_path / "cache"))
    made.heard = heard  # pyright: ignore[reportAttributeAccessIssue]
    return made

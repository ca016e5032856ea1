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

    from sessions import Heard, SmallSession
    from tangible_ui.state.session import Session
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
DAILY = {
    "test_depth_and_texture_are_run_separately",
    "test_preflight_cure_corrects_the_document",
    "test_stroke_is_recorded_played_and_replayed_with_another_law",
    "test_two_laws_are_compared_and_a_blind_study_of_them_is_written",
    "test_enlarged_region_is_saved_and_opens_the_same",
    "test_tab_that_is_frozen_or_closed_gives_no_force",
    "test_page_with_results_has_no_violations_by_axe_and_fits_every_size",
    "test_parts_editor_has_no_violations_by_axe_in_any_size",
    "test_address_of_an_earlier_start_is_reported",
    "test_draft_of_a_killed_program_is_offered_once",
    "test_mouse_gives_force_until_the_page_is_hidden_or_frozen",
    "test_closed_tab_leaves_no_force",
    "test_keyboard_gives_force_and_the_stop_key_works_in_a_field",
    "test_network_is_added_from_a_file_checked_and_removed",
}
"""The fourteen browser cases of a daily change; axe looks at the page in German, whose words are the longest."""
DIRS = ("CACHE", "RUNTIME", "CONFIG", "LOG", "DATA")

Serve = Callable[..., UiServer]
Opened = Callable[..., str]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Function]) -> None:
    """Leave to `--whole` what needs a browser or a server, but `DAILY`; give it time on a machine that stands still."""
    for item in items:
        if {"chromium", "serve", "lasting"} & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.timeout(1200))
            if item.originalname not in DAILY:
                item.add_marker(pytest.mark.whole)


@pytest.fixture(scope="session")
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


@pytest.fixture(scope="session")
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
def anyio_backend() -> str:
    """Tests that are coroutines run in asyncio's event loop."""
    return "asyncio"


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """The pipeline file that `small` opens."""
    from sessions import small_scene

    return small_scene(tmp_path)


@pytest.fixture
async def small(tmp_path: Path, scene: Path, monkeypatch: pytest.MonkeyPatch) -> "SmallSession":
    """A session on which the scene is opened, and nothing is made."""
    from sessions import SmallSession

    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))
    small = SmallSession(tmp_path, monkeypatch)
    await small.ask("begin", files=[str(scene)], make_it=False)
    return small


@pytest.fixture
def ask(small: "SmallSession") -> Callable[..., Any]:
    """`await ask("undo")` sends a request of the session's tab."""
    return small.ask


@pytest.fixture
def worker_state(tmp_path: Path) -> "WorkerState":
    """A worker's state, whose events are in `worker_state.heard`."""
    from tangible_core.pipeline.engine.cache import Cache
    from tangible_ui.worker.state import WorkerState

    heard: list[tuple[str, dict[str, Any]]] = []
    made = WorkerState(tmp_path, lambda event, **told: heard.append((event, told)), Cache(tmp_path / "cache"))
    made.heard = heard  # pyright: ignore[reportAttributeAccessIssue]
    return made


@pytest.fixture
def tab(session: "Session") -> "Heard":
    """A tab of the session."""
    from sessions import Heard

    tab = Heard()
    session.tabs.enter(tab)
    return tab

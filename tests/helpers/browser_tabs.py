"""Tabs of a browser that are watched: nothing that a page complains of is missed, nor whom it asks for something."""

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from waiting import LONGEST_MS

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

HERE = (
    "http://127.0.0.1:",
    "ws://127.0.0.1:",
    "http://localhost:",
    "ws://localhost:",
    "data:",
    "blob:",
    "about:",
    "file:",
)
OPTIONS = {"locale": "en-GB", "viewport": {"width": 1180, "height": 720}}

FEWER_FRAMES = """(() => {
  const next = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (act) => setTimeout(() => next(act), 80);
  window.cancelAnimationFrame = clearTimeout;
})()"""
"""A dozen frames a second: without a graphics card, sixty take a whole processor, and no test looks at them."""
NO_WEBGL = """(() => {
  const { prototype } = HTMLCanvasElement;
  const real = prototype.getContext;
  prototype.getContext = function (kind, ...more) {
    return kind.startsWith("webgl") ? null : real.call(this, kind, ...more);
  };
})()"""
"""As where a browser has no WebGL: the surface is not drawn, and all else works."""

SETTLED = """new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))).then(
  () => Promise.allSettled(document.getAnimations().map((each) => each.finished)))"""
"""Laid out anew, marks turned, colours changed."""

OpenPage = Callable[..., "Page"]


class Chromium:
    """A browser that lasts for many tests.

    Playwright's event loop is the running one of this thread only while the browser is used: beside a running loop
    `asyncio.run` does not work.
    """

    def __init__(self, browser: "Browser") -> None:
        self.browser, self._loop = browser, asyncio.get_running_loop()

    @contextmanager
    def used(self) -> "Iterator[Browser]":
        """Yield the browser; it and its pages can be used in the block alone."""
        asyncio._set_running_loop(self._loop)
        try:
            yield self.browser
        finally:
            asyncio._set_running_loop(None)


@contextmanager
def tabs(browser: "Browser", complaints: list[str]) -> Iterator[OpenPage]:
    """Yield a function that opens an address in a context of its own; at the end no page may have complained."""
    contexts = []

    def open_page(url: str, draws: bool = False, **options: Any) -> "Page":
        context = browser.new_context(**{**OPTIONS, **options})
        contexts.append(context)
        context.add_init_script(FEWER_FRAMES if draws else NO_WEBGL)
        context.set_default_timeout(LONGEST_MS)
        context.on("page", lambda page: watch(page, complaints))  # those that a page opens too
        page = context.new_page()
        page.goto(url)
        return page

    try:
        yield open_page
    finally:
        for context in contexts:
            for page in context.pages:
                with suppress(Exception):  # it may have crashed; whatever it said until now is heard before it answers
                    page.evaluate("() => 0")
            context.close()
    if complaints:
        raise AssertionError("\n".join(complaints))


def watch(page: "Page", complaints: list[str]) -> None:
    """Collect a page's errors, and its requests to other machines."""

    def asks(url: str) -> None:
        if not url.startswith(HERE):
            complaints.append(f"asks {url}")

    page.on("console", lambda said: complaints.append(f"console: {said.text}") if said.type == "error" else None)
    page.on("pageerror", lambda error: complaints.append(f"error: {error}"))
    page.on("crash", lambda _: complaints.append("the page crashed"))
    page.on("request", lambda request: asks(request.url))
    page.on("websocket", lambda socket: asks(socket.url))

"""The tests in a browser themselves: a page is served and drawn, and none of its complaints is missed."""

import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from browser_tabs import tabs
from needed import lacking
from ui_server import UiServer
from waiting import until

NOT_HERE = "http://tangible.invalid/picture.png"


def data(html: str) -> str:
    return f"data:text/html,<title>t</title>{html}"


class TestWatch:
    @pytest.mark.parametrize(
        ("html", "complaint"),
        [
            ("<script>console.error('broken')</script>", "console: broken"),
            ("<script>throw new Error('thrown')</script>", "error: thrown"),
            ("<script>Promise.reject(new Error('unanswered'))</script>", "error: unanswered"),
            (f"<img src={NOT_HERE}>", f"asks {NOT_HERE}"),
            ("<script>new WebSocket('ws://tangible.invalid/')</script>", "asks ws://tangible.invalid/"),
        ],
        ids=["console", "thrown", "rejected", "request", "socket"],
    )
    def test_complaint_of_a_page_is_kept(self, open_page, complaints: list[str], html: str, complaint: str):
        page = open_page(data(html))
        until(lambda: page.title() and complaint in complaints)
        complaints.clear()

    def test_page_without_complaints_has_an_empty_list(self, open_page, complaints: list[str]):
        page = open_page(data("<script>console.warn('as you like'); document.title = 'done'</script>"))
        assert page.title() == "done"
        assert complaints == []

    def test_complaint_of_a_page_fails_its_test(self, browser):
        with pytest.raises(AssertionError, match="console: broken"), tabs(browser, []) as open_page:
            open_page(data("<script>console.error('broken')</script>"))


class TestServed:
    def test_page_is_served_and_drawn(self, opened, open_page):
        """The policy lets script and style in, WebGL is there, the surface is drawn."""
        page = open_page(f"{opened('builtin/brick')}&measure", draws=True)
        page.wait_for_function("() => window.figures?.firstMs > 0")
        assert page.title().endswith("Tangible Images")
        assert page.evaluate("document.styleSheets.length") == 1
        with Image.open(io.BytesIO(page.locator("#terrain").screenshot())) as picture:
            assert np.asarray(picture.convert("L")).std() > 5

    def test_server_that_does_not_listen_raises_its_output(self, tmp_path: Path):
        with pytest.raises(AssertionError, match="no such thing"):
            UiServer(cwd=tmp_path, start="raise SystemExit('no such thing')")

    def test_server_that_ends_leaves_no_child_process(self, tmp_path: Path):
        child = "subprocess.Popen(['sleep', '60']).pid"
        start = f"import subprocess, time; print({child}); print('http://127.0.0.1:1/', flush=True); time.sleep(60)"
        with UiServer(cwd=tmp_path, start=start) as server:
            pid = int(server.lines[0])
        until(lambda: not alive(pid))


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("name", ["CI", "TANGIBLE_UI_REQUIRED"])
def test_missing_program_skips_on_a_persons_machine_and_fails_in_ci(name: str, monkeypatch):
    for each in ("CI", "TANGIBLE_UI_REQUIRED"):
        monkeypatch.delenv(each, raising=False)
    with pytest.raises(pytest.skip.Exception, match="no browser"):
        lacking("no browser")
    monkeypatch.setenv(name, "1")
    with pytest.raises(pytest.fail.Exception, match="no browser"):
        lacking("no browser")

"""The pictures of the page in the docs: always made and looked at, and with TANGIBLE_UI_PICTURES=1 written there."""

import io
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from page_files import ROOT, built_page

if TYPE_CHECKING:
    from playwright.sync_api import Page

DOCS = ROOT / "docs"
MOST_BYTES = 150_000
COLOURS = 200
"""Of a palette: the photograph is small, and the rest has few."""
PICTURES: dict[str, dict[str, Any]] = {
    "ui": {"viewport": {"width": 1440, "height": 900}, "color_scheme": "light"},
    "ui-dark": {"viewport": {"width": 1440, "height": 900}, "color_scheme": "dark"},
    "ui-phone": {"viewport": {"width": 390, "height": 844}, "color_scheme": "light", "locale": "de-DE"},
}


@pytest.fixture(scope="module")
def url(serve: Callable[..., Any]) -> str:
    built_page()
    return serve("builtin/motorcycle").url


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_of_the_page(open_page: Callable[..., Any], url: str, tmp_path: Path, name: str):
    page = open_page(url, **PICTURES[name])
    page.wait_for_function("() => document.querySelector('#status').dataset.state === 'felt'", timeout=120_000)
    if name == "ui-dark":
        page.locator("#view input[value=materials]").check()
    touch(page)
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    page.mouse.up()
    assert np.asarray(picture).std() > 20, "something is drawn"
    path = (DOCS if os.environ.get("TANGIBLE_UI_PICTURES") else tmp_path) / f"{name}.png"
    picture.quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(path, optimize=True)
    assert path.stat().st_size < MOST_BYTES


def touch(page: "Page") -> None:
    """Press the hand onto the surface, so that there is a force to be seen."""
    box = page.locator("#terrain").bounding_box()
    assert box
    page.mouse.move(box["x"] + 0.45 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    for step in range(20):
        page.mouse.move(box["x"] + (0.45 + 0.001 * step) * box["width"], box["y"] + 0.5 * box["height"])
        page.wait_for_timeout(50)

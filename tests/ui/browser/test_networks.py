"""The panel of networks: otherwise a person who never opens a terminal has none, or a wrong file runs as one."""

import hashlib
import os
from pathlib import Path

import pytest

from page_files import built_page
from page_panels import open_panel
from sessions import small_scene
from waiting import until

CONTENT = b"a network of mine"
DIGEST = hashlib.sha256(CONTENT).hexdigest()
CARD = f"title: Mine\ntask: figure\nsha256: {DIGEST}\nlicence: ours\noutput: {{means: figure}}\n"


@pytest.mark.whole
def test_network_is_added_from_a_file_checked_and_removed(serve, open_page, tmp_path: Path) -> None:
    built_page()
    models = tmp_path / "models"
    models.mkdir()
    (models / "mine.yaml").write_text(CARD)
    page = open_page(serve(small_scene(tmp_path), TANGIBLE_MODELS_DIR=str(models)).url)
    box = open_panel(page, "networks")
    item = box.locator("li", has_text="Licence: ours")
    status, kept = page.locator("#networks-status"), models / "mine.onnx"

    def give(content: bytes) -> None:
        item.get_by_label("From a file: Mine").set_input_files({"name": "m.onnx", "mimeType": "", "buffer": content})

    give(b"another network")
    until(lambda: "Mine: the file is not the one that its card describes" in status.inner_text())
    assert not kept.exists() and "not here" in item.inner_text()
    give(CONTENT)
    until(lambda: "Done." in status.inner_text())
    until(lambda: item.get_by_role("button", name="Remove Mine").count() == 1)
    when_ns = kept.stat().st_mtime_ns
    kept.write_bytes(CONTENT[::-1])
    os.utime(kept, ns=(when_ns, when_ns))
    box.get_by_role("button", name="Check all").press("Enter")
    until(lambda: "Damaged: Mine" in status.inner_text())
    give(CONTENT)
    until(lambda: item.get_by_role("button", name="Remove Mine").count() == 1)
    item.get_by_role("button", name="Remove Mine").press("Enter")
    until(lambda: "Mine was removed." in status.inner_text())
    assert not kept.exists() and list(models.iterdir()) == [models / "mine.yaml"]
    assert "mine.onnx" not in box.inner_text() and box.locator("#networks-add").is_visible()

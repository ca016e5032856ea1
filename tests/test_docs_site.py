"""The docs site is built as CONTRIBUTING says, and a reference that leads nowhere fails it."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.whole
ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
FAULTS = {
    "[a page](nowhere.md)": "nowhere.md",
    "[a heading](other.md#nowhere)": "nowhere",
    "![a picture](nowhere.png)": "nowhere.png",
    "{py:func}`tangible_core.nowhere`": "tangible_core.nowhere",
    "{py:class}`Nowhere`": "Nowhere",
    "```{eval-rst}\n.. autoclass:: tangible_core.nowhere.Nobody\n```": "tangible_core.nowhere",
}
"""What a page may say wrong, and what the complaint names."""


def build(pages: Path, site: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "sphinx", "-q", "-nW", "--keep-going", "-d", site / "trees", pages, site / "html"]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_docs_site_builds_and_loads_nothing_from_elsewhere(tmp_path: Path):
    built = build(DOCS, tmp_path)
    assert built.returncode == 0, built.stderr
    page = tmp_path.joinpath("html/reference/methods.html").read_text("utf-8")
    assert "Penalties" in page and "P1" in page
    fetched = [f'{word}="http' for word in ("src", 'rel="stylesheet" href')]
    pages = [page.read_text("utf-8") for page in tmp_path.joinpath("html").rglob("*.html")]
    assert not [word for word in fetched for page in pages if word in page]


def test_docs_site_with_a_dead_link_fails_to_build(tmp_path: Path):
    pages = tmp_path / "docs"
    pages.mkdir()
    pages.joinpath("conf.py").write_text(DOCS.joinpath("conf.py").read_text("utf-8").replace(', "generated"', ""))
    pages.joinpath("_ext").symlink_to(DOCS / "_ext")
    pages.joinpath("other.md").write_text("# Other\n")
    pages.joinpath("index.md").write_text("# Index\n\n```{toctree}\nother\n```\n\n" + "\n\n".join(FAULTS))
    built = build(pages, tmp_path)
    assert built.returncode != 0
    complaints = [line for line in built.stderr.splitlines() if "WARNING" in line]
    assert len(complaints) == len(FAULTS), built.stderr
    assert not [said for said in FAULTS.values() if not any(said in line for line in complaints)], built.stderr

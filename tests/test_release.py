"""What a release needs to agree: version, groups of dependencies, digests, links of the docs."""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
LOCKED = (ROOT / "requirements-dev.txt").read_text("utf-8")
WITHOUT_DIGEST = {"torch", "kornia", "pandora"}
"""Packages of extras that are not locked: torch, what needs it, and what the benchmark alone uses."""
HEADING = re.compile(r"^#+ +(.+?) *#*$", re.MULTILINE)
LINK = re.compile(r"(?<!\\)\]\(<?([^)\s>]+)>?(?: +\"[^\"]*\")?\)|^\[[^\]]+\]: +(\S+)", re.MULTILINE)
FENCED = re.compile(r"^ *(`{3,}|~{3,}).*?^ *\1`* *$|`[^`\n]*`", re.MULTILINE | re.DOTALL)


def name_of(requirement: str) -> str:
    """Return a requirement's package in its one form."""
    return re.sub(r"[-_.]+", "-", re.match(r"[\w.-]+", requirement)[0]).lower()  # pyright: ignore[reportOptionalSubscript]


def versions(text: str) -> dict[str, str]:
    """Return the versions of packages by their names, `name==version` a line."""
    return {name_of(name): version for name, version in re.findall(r"^([\w.-]+)==([\w.!+]+)", text, re.MULTILINE)}


def group(name: str) -> list[str]:
    """Return the requirements of a dependency group, those of included groups too."""
    entries = PROJECT["dependency-groups"][name]
    return [
        each for entry in entries for each in ([entry] if isinstance(entry, str) else group(entry["include-group"]))
    ]


def test_version_of_a_tree_without_git_is_the_next_release_in_work():
    citation = dict(
        line.split(": ", 1) for line in (ROOT / "CITATION.cff").read_text("utf-8").splitlines() if ": " in line
    )
    assert PROJECT["tool"]["hatch"]["version"]["fallback-version"] == f"{citation['version']}.dev0"
    assert PROJECT["project"]["license"] == citation["license"]


def test_dependency_group_dev_is_the_extra_dev():
    extras = PROJECT["project"]["optional-dependencies"]
    own = [each for each in extras["dev"] if not each.startswith("tangible-images[")]
    assert sorted(group("dev")) == sorted([*own, *extras["docs"]])


class TestLock:
    def test_every_package_has_a_digest_and_no_address(self):
        entries = re.split(r"\n(?=\S)", LOCKED.strip())
        for entry in (each for each in entries if not each.startswith("#")):
            assert re.match(r"[\w.-]+==[\w.!+]+( ; [^/:\\]+)? \\\n( +--hash=sha256:[0-9a-f]{64}( \\\n|$))+$", entry), (
                entry
            )

    def test_every_direct_dependency_is_locked(self):
        extras = PROJECT["project"]["optional-dependencies"]
        wanted = [*PROJECT["project"]["dependencies"], *group("dev")]
        wanted += (
            each for name, needs in extras.items() if name not in ("dev", "torch", "peers", "falcon") for each in needs
        )
        assert {name_of(each) for each in wanted} - versions(LOCKED).keys() == set(), "run .ci/lock"

    def test_locked_versions_are_those_of_the_constraints(self):
        locked = {
            name_of(name): version for name, version in re.findall(r"^([\w.-]+)==([\w.!+]+)", LOCKED, re.MULTILINE)
        }
        pinned = re.findall(r"^([\w.-]+)==([\w.!+]+)", (ROOT / "constraints.txt").read_text("utf-8"), re.MULTILINE)
        pinned = {name_of(name): version for name, version in pinned if name_of(name) not in WITHOUT_DIGEST}
        assert {name: locked.get(name) for name in pinned} == pinned, "run .ci/lock"


def anchors(text: str) -> set[str]:
    """Return the anchors of a page's headings, as GitHub and myst-parser make them."""
    plain = (re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", each) for each in HEADING.findall(text))
    return {re.sub(r" ", "-", re.sub(r"[^\w\- ]", "", each.strip().lower())) for each in plain}


def links(path: Path) -> Iterator[tuple[str, str]]:
    """Return file and anchor of every link of a page that leads to another place in the repository."""
    for found in LINK.finditer(FENCED.sub("", path.read_text("utf-8"))):
        target = found[1] or found[2]
        if not re.match(r"[a-z]+:", target):
            file, _, anchor = target.partition("#")
            yield file, anchor


def pages() -> list[Path]:
    """Return every page that people read, but not what is installed or built."""
    found = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")]
    return sorted(each for each in (*found, ROOT / "benchmarks/RESULTS.md") if "node_modules" not in each.parts)


@pytest.mark.parametrize("page", pages(), ids=lambda each: str(each.relative_to(ROOT)))
def test_links_lead_to_files_and_headings_that_are_there(page: Path):
    wrong: list[str] = []
    for file, anchor in links(page):
        target = (page.parent / file).resolve() if file else page
        if not target.exists() or not target.is_relative_to(ROOT):
            wrong.append(file)
        elif anchor and target.suffix == ".md" and anchor not in anchors(target.read_text("utf-8")):
            wrong.append(f"{file}#{anchor}")
    assert wrong == []

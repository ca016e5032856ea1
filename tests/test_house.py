"""Rules that hold for the house as a whole: floors, light listings, documented hooks, nothing left unregistered."""

import ast
import json
import re
import subprocess
import sys
import tomllib
from importlib import import_module
from inspect import isabstract
from pathlib import Path
from types import ModuleType

import pytest

import tangible_core
from benchmarks.house_structure import PLUGINS_IMPORT, modules_for_plugins
from benchmarks.house_things import THINGS, fault
from benchmarks.house_words import count_words, shipped
from tangible_core.plugins import hooks
from tangible_core.plugins.interfaces import (
    KINDS,
    Adjustable,
    Attended,
    Drawing,
    Filming,
    Following,
    Hierarchical,
    Previewing,
    Reshaping,
    Scripted,
    Serviceable,
    Skippable,
)
from tangible_core.plugins.registry import KIND_NAMES, default_registry
from tangible_core.testing.every_method import HEAVY

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
BARE_LABEL = re.compile(r"\b(?:part|segment|Teil|Segment) \$?\{(?!name_part|shown_number|shownNumber)(\w+)")
"""A label that stands behind the noun in a text."""
LABEL_SLOTS = {"number", "part"}
"""Slots of tables of words, which are filled with a shown number."""
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PACKAGES = {
    "depth": ROOT / "plugins/depth/tangible_depth",
    "texture": ROOT / "plugins/texture/tangible_texture",
    "render": ROOT / "plugins/render/tangible_render",
    "device": ROOT / "plugins/devices/tangible_devices",
    "export": ROOT / "plugins/export/tangible_export",
}
REPORT = ROOT / "plugins/report/tangible_report"
"""A package above the families, with two exporters: the sheet and the description."""
SEND = ROOT / "plugins/send/tangible_send"
"""A package above the page, with an exporter that is made of it."""
MOMENTS = sorted(name for name in vars(hooks.Specs) if name.startswith("tangible_"))


def run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *words], cwd=ROOT, capture_output=True, text=True, check=False)


def test_names_of_rooms_have_a_budget_and_are_not_hidden():
    budget = json.loads((ROOT / "tests" / "budget.json").read_text("utf-8"))
    rooms = {path.parent.relative_to(ROOT).parts for path in ROOT.joinpath("tests").rglob("test_*.py")}
    names = {"/".join(parts[:3] if parts[1:2] in (("core",), ("plugins",)) else parts[:2]) for parts in rooms}
    assert names <= budget.keys()
    assert sum(budget.values()) <= 660  # what they took, and a fifth
    for stub in ROOT.joinpath("tangible_core").rglob("__init__.pyi"):
        room = ".".join(stub.parent.relative_to(ROOT).parts)
        names = {
            each.asname or each.name
            for node in ast.walk(ast.parse(stub.read_text()))
            if isinstance(node, ast.ImportFrom)
            for each in node.names
        }
        for name in names & {path.stem for path in stub.parent.iterdir()}:
            import_module(f"{room}.{name}")
            assert not isinstance(getattr(import_module(room), name), ModuleType), f"{room}.{name} is the file"


def test_imports_are_of_the_floors_below_and_the_rooms_that_are_named():
    ran = run(
        "-c", "from importlinter.cli import lint_imports; raise SystemExit(lint_imports(no_cache=True, no_logo=True))"
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    page = (ROOT / "CONTRIBUTING.md").read_text("utf-8").partition("A plugin imports from")[2].partition("\n\n")[0]
    rooms = {f"tangible_core.{name}" for name in re.findall(r"`([a-z._]+)`", page.partition(":\n")[2])}
    assert {"tangible_core", *rooms} == set(modules_for_plugins())
    assert len(rooms) < PLUGINS_IMPORT


@pytest.mark.parametrize("words", [None, [], ["--help"], ["plugins"], ["plugins", "--json"], ["run", "--help"]])
def test_listing_imports_nothing_heavy(words):
    call = "" if words is None else f"sys.argv[1:] = {words}; from tangible_core.cli import main; main()"
    code = f"import atexit, sys, tangible_core; atexit.register(lambda: print(*sys.modules, file=sys.stderr)); {call}"
    imported = set(run("-c", code).stderr.split())
    assert "tangible_core" in imported
    assert not imported & {*HEAVY, "pandas", "PIL"}
    assert not {
        name for name in imported if re.match(r"tangible_(depth|texture|render|devices|export)\.(?!commands)", name)
    }


@pytest.mark.parametrize(
    ("tests", "house"),
    [("core", ROOT / "tangible_core"), *((f"plugins/{path.parent.name}", path) for path in PACKAGES.values())],
)
def test_folders_of_tests_mirror_rooms(tests: str, house: Path):
    folder = ROOT / "tests" / tests
    rooms = {
        path.relative_to(house).with_suffix("") for path in house.rglob("*") if path.is_dir() or path.suffix == ".py"
    }
    folders = {path.parent.relative_to(folder) for path in folder.rglob("test_*.py")} - {Path()}
    assert folders <= rooms
    if tests == "core":  # a family's methods are tested beside its rooms; the core has rooms alone
        assert {Path(path.stem.removeprefix("test_")) for path in folder.glob("test_*.py")} <= rooms


def test_tests_lie_in_their_house_and_no_text_advises_to_delete_kernels():
    there = {path.relative_to(ROOT / "tests").parts[0] for path in ROOT.joinpath("tests").rglob("test_*.py")}
    assert {name for name in there if not name.endswith(".py")} == {"benchmarks", "core", "plugins", "ui"}
    assert not list(ROOT.joinpath("tests/plugins").glob("test_*.py"))
    texts = [*ROOT.glob("*.md"), *ROOT.joinpath("docs").rglob("*.md")]
    texts += [path for each in (ROOT / "tangible_core", ROOT / "plugins") for path in each.rglob("*.py")]
    assert [path for path in texts if "__pycache__" in path.read_text()] == []


@pytest.mark.parametrize("moment", MOMENTS)
def test_hooks_are_documented_and_called_somewhere(moment):
    assert len(getattr(hooks.Specs, moment).__doc__ or "") > 20
    houses = [ROOT.joinpath("tangible_core"), REPORT]
    rooms = [path for house in houses for path in house.rglob("*.py") if "observers" not in path.parts]
    assert any(f'"{moment}"' in path.read_text() for path in rooms), f"nothing in the core or the report calls {moment}"


def concrete_methods():
    """(kind, package.module:Class) of every class that derives from an interface, by the source of the plugins."""
    kinds = {cls.__name__: kind for kind, cls in KINDS.items()}
    for package in (*PACKAGES.values(), REPORT, SEND):
        classes = {
            node.name: (path, [ast.unparse(base).rpartition(".")[2] for base in node.bases])
            for path in sorted(package.rglob("*.py"))
            for node in ast.parse(path.read_text()).body
            if isinstance(node, ast.ClassDef)
        }
        derived_from = {base for _, bases in classes.values() for base in bases}
        abstract = {
            name: kinds[base]
            for name, (_, bases) in classes.items()
            for base in bases
            if base in kinds and name in derived_from
        }
        for name, (path, bases) in classes.items():
            module = ".".join(path.relative_to(package.parent).with_suffix("").parts)
            for base in bases:
                if name not in abstract and (kind := (kinds | abstract).get(base)) is not None:
                    yield kind, f"{module}:{name}"


def registered():
    groups = PROJECT["project"]["entry-points"]
    return {(kind, target) for kind in KIND_NAMES for target in groups.get(f"tangible.{kind}", {}).values()}


def test_methods_live_in_their_family_in_the_file_named_after_them():
    assert sorted(concrete_methods()) == sorted(registered())
    for kind, target in registered():
        homes = (PACKAGES[kind], REPORT, SEND) if kind == "export" else (PACKAGES[kind],)
        assert target.partition(".")[0] in {home.name for home in homes}, f"{target} is registered as {kind}"
    for _, target in registered():
        module, _, cls = target.partition(":")
        assert module.rpartition(".")[2].replace("_", "") == cls.lower(), target


@pytest.mark.parametrize("kind", KIND_NAMES)
def test_methods_are_final_and_inherit_from_interfaces_alone(kind):
    """From interfaces of the core, or from an abstract class of its family that inherits from these."""
    capabilities = {
        Adjustable, Attended, Drawing, Filming, Following, Hierarchical, Previewing, Reshaping, Scripted, Serviceable,
        Skippable,
    }  # fmt: skip
    for listing in default_registry().listings:
        if listing.kind == kind and listing.distribution == "tangible-images":
            bases = default_registry().load(kind, listing.name).__bases__
            shared = {base for base in bases if base not in KINDS.values() and isabstract(base)} - capabilities
            interfaces = {*bases, *(above for base in shared for above in base.__bases__)} - shared
            assert interfaces <= {KINDS[kind], *capabilities}, listing.target


def test_methods_and_names_that_are_installed_are_those_of_the_project():
    ours = {
        (listing.kind, listing.target)
        for listing in default_registry().listings
        if listing.distribution == "tangible-images"
    }
    assert ours == registered()
    for name in tangible_core.__all__:
        value = getattr(tangible_core, name)
        assert name in (getattr(value, "__name__", ""), "hookimpl")
    with pytest.raises(AttributeError, match="Nothing"):
        tangible_core.Nothing  # noqa: B018


@pytest.mark.whole
@pytest.mark.parametrize(
    ("thing", "command"),
    [
        ("device", "check device handle"),
        ("exporter", "check export contours"),
        ("option of a force law", f"plan {ROOT / 'configs/demo.yaml'} --set render.use=penalty --set render.share=0.5"),
    ],
)
def test_thing_of_the_house_touches_three_files(thing: str, command: str, tmp_path: Path):
    assert len(THINGS[thing]) <= 3
    assert fault(thing, command.split(), tmp_path) == ""


@pytest.mark.parametrize("package", PACKAGES.values(), ids=PACKAGES)
def test_names_of_a_family_are_its_methods(package: Path):
    module = import_module(package.name)
    ours = {target for _, target in registered()}
    assert {f"{getattr(module, name).__module__}:{name}" for name in module.__all__} <= ours


def test_blocks_of_files_and_options_cannot_be_changed():
    """Keys of the cache are made of them, and threads share them."""
    files = [*(ROOT / "tangible_core").rglob("*.py"), *(ROOT / "plugins").glob("*/tangible_*/**/*.py")]
    models = [
        (path, node.value)
        for path in files
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(node.value, ast.Call)
        for target in (node.targets if isinstance(node, ast.Assign) else [node.target])
        if isinstance(target, ast.Name) and target.id == "model_config"
    ]
    assert len(models) > 5
    frozen = ast.dump(ast.Constant(True))
    loose = [
        path
        for path, call in models
        if {keyword.arg: ast.dump(keyword.value) for keyword in call.keywords}.get("frozen") != frozen
    ]
    assert not loose


@pytest.mark.parametrize("package", ["tangible_core", *(path.name for path in PACKAGES.values())])
def test_packages_are_typed_and_documented(package):
    module = import_module(package)
    assert module.__doc__
    assert Path(module.__file__).with_name("py.typed").exists()


def test_only_kernels_are_untyped():
    """Ruff passes functions that have no annotation at all: numba finds the types of kernels, and of nothing else."""
    for path in (path for house in ("tangible_core", "plugins") for path in (ROOT / house).rglob("*.py")):
        if "node_modules" in path.parts or re.search(r"\b(njit|inner|intrinsic)\b", text := path.read_text("utf-8")):
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("__"):
                assert node.returns or any(arg.annotation for arg in node.args.args), f"{path}: {node.name}"


def test_dependencies_have_their_reasons():
    reasons = ROOT.joinpath("docs/decisions/0002-dependencies.md").read_text()
    for dependency in PROJECT["project"]["dependencies"]:
        name = re.split(r"[^\w.-]", dependency)[0]
        assert name in reasons, f"{name} is not explained"


def test_names_are_nouns_and_docstrings_open_with_a_verb_or_a_noun():
    """`python -m benchmarks.house_words --list` names the places."""
    words = count_words(shipped())
    bounds = {"docstrings": 1, "functions": 1, "functions x_of": 0.2, "constants": 0, "loop variables": 2}
    assert all(words.counts[kind] > 1000 for kind in bounds)
    assert {kind: words.places[kind] for kind, bound in bounds.items() if words.share(kind) > bound} == {}


def test_no_text_names_a_part_by_its_label():
    """People read its number, which counts from one."""
    pages = (ROOT / "plugins/web/kit", ROOT / "plugins/ui/web/src")
    rooms = [ROOT / "tangible_core", *(ROOT / "plugins").glob("*/tangible_*"), *pages]
    files = [each for room in rooms for each in [*room.rglob("*.py"), *room.rglob("*.ts")]]
    files = [file for file in files if file.stem != "part_words"]
    assert len(files) > 500
    found = [
        f"{path.relative_to(ROOT)}: {match[0]}"
        for path in files
        for match in BARE_LABEL.finditer(path.read_text(encoding="utf-8"))
        if not (match[1] in LABEL_SLOTS and ("words" in path.name or "words" in path.parts))
    ]
    assert found == []

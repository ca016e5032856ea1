"""The registry of methods. Otherwise one broken package would hide all others, or be imported by a list."""

import sys

import pytest

from tangible_core.errors import BrokenMethod, UnknownMethod
from tangible_core.plugins.interfaces import DepthEstimator
from tangible_core.plugins.registry import KIND_NAMES, Registry

MINE = '''
    import numpy as np
    from tangible_core import DisparityMap, Views
    from tangible_core.plugins import DepthEstimator

    class Mine(DepthEstimator):
        """The same everywhere.

        More of it.
        """

        def estimate(self, views: Views) -> DisparityMap:
            return DisparityMap(np.zeros(views.shape, np.float32))
    '''


def install_mine(install, name="acme", **points):
    return install(name, {"tangible.depth": points or {"mine": f"{name}:Mine"}}, **{name: MINE})


def test_method_is_listed_without_being_imported_and_loaded_by_name(install):
    assert Registry().listings == ()
    install_mine(install)
    [listing] = Registry().listings
    assert (listing.kind, listing.name, listing.target) == ("depth", "mine", "acme:Mine")
    assert (listing.origin, listing.distribution) == ("acme 1.0", "acme")
    assert listing.summary == "The same everywhere."
    assert "acme" not in sys.modules
    cls = Registry().load("depth", "mine")
    assert issubclass(cls, DepthEstimator)
    assert cls is Registry().load("depth", "acme/mine")


def test_listings_are_sorted_by_kind_and_name(install):
    install("b", {f"tangible.{kind}": {"y": "b:Y", "x": "b:X"} for kind in reversed(KIND_NAMES)})
    install("a", {"tangible.depth": {"y": "a:Y"}, "tangible.other": {"z": "a:Z"}})
    listings = [(listing.kind, listing.name, listing.distribution) for listing in Registry().listings]
    depth = [("depth", "x", "b"), ("depth", "y", "a"), ("depth", "y", "b")]
    assert listings == depth + [(kind, name, "b") for kind in KIND_NAMES[1:] for name in ("x", "y")]


@pytest.mark.parametrize(
    ("kind", "name", "complaint"),
    [
        ("depth", "mime", r"'mime' \(did you mean 'mine'\?\); installed: mine"),
        ("depth", "other/mine", "'other/mine'.*; installed: mine"),
        ("depth", "", "''; installed: mine"),
        ("texture", "mine", "no texture method is named 'mine'"),
        ("dept", "mine", r"'dept' \(did you mean 'depth'\?\)"),
    ],
)
def test_name_that_is_not_installed_is_refused_with_the_nearest(install, kind, name, complaint):
    install_mine(install)
    with pytest.raises(UnknownMethod, match=complaint):
        Registry().load(kind, name)


@pytest.mark.parametrize(
    ("source", "complaint"),
    [
        ("import a_module_that_is_not_there", "ModuleNotFoundError"),
        ("1 / 0", "ZeroDivisionError"),
        ("def (", "SyntaxError"),
        ("", "AttributeError"),
        ("Mine = 3", "is not a DepthEstimator"),
        ("class Mine: 'A class'", "is not a DepthEstimator"),
        ("from tangible_core.plugins import Segmenter as Mine", "is not a DepthEstimator"),
        ("from tangible_core.plugins import DepthEstimator as Mine", "does not implement estimate"),
        ("raise SystemExit(3)", "SystemExit"),
    ],
)
def test_broken_plugin_leaves_the_others_usable(install, source, complaint):
    install("broken", {"tangible.depth": {"broken": "broken:Mine"}}, version="2.0", broken=source)
    install_mine(install)
    registry = Registry()
    assert registry.names("depth") == ["broken", "mine"]
    assert [type(listing.summary) for listing in registry.listings] == [str, str]
    with pytest.raises(BrokenMethod, match=rf"depth method 'broken' \(broken:Mine.*{complaint}"):
        registry.load("depth", "broken")
    assert registry.load("depth", "mine")().estimate


@pytest.mark.parametrize(
    ("target", "summary"),
    [
        ("acme:Mime", "(cannot be read: acme has no class Mime (did you mean 'Mine'?))"),
        ("acme:Bare", "(no docstring)"),
        *(
            (each, "(cannot be read:")
            for each in ("no_package.module:Mine", "acme.no_module:Mine", "acme", "acme:", "?")
        ),
    ],
)
def test_target_that_leads_nowhere_is_listed_and_not_loaded(install, target, summary):
    install("acme", {"tangible.depth": {"lost": target}}, acme=MINE + "\n    class Bare: ...")
    [listing] = Registry().listings
    assert listing.summary.startswith(summary)
    with pytest.raises(BrokenMethod, match="depth method 'lost'"):
        Registry().load("depth", "lost")


def test_two_plugins_of_one_name_are_chosen_by_distribution(install):
    install_mine(install, "acme", mine="acme:Mine")
    install_mine(install, "rival", mine="rival:Mine", other="rival:Mine")
    registry = Registry()
    assert registry.names("depth") == ["acme/mine", "rival/mine", "other"]
    with pytest.raises(
        BrokenMethod, match=r"'mine' is offered by acme 1\.0 and rival 1\.0; write acme/mine or rival/mine"
    ):
        registry.load("depth", "mine")
    assert registry.load("depth", "rival/mine").__module__ == "rival"
    assert registry.load("depth", "acme/mine").__module__ == "acme"
    assert registry.load("depth", "other").__module__ == "rival"


def test_plugin_with_a_heavy_library_is_listed_without_importing_it(install):
    heavy = "import heavy_library\n" + MINE.replace("\n    ", "\n")
    install("heavy", {"tangible.depth": {"heavy": "heavy:Mine"}}, heavy=heavy, heavy_library="raise AssertionError")
    assert [listing.summary for listing in Registry().listings] == ["The same everywhere."]
    with pytest.raises(BrokenMethod, match="AssertionError"):
        Registry().load("depth", "heavy")


def test_method_in_a_package_has_its_summary_read_from_the_file(install):
    site = install("deep", {"tangible.depth": {"file": "deep.rooms.mine:Mine", "folder": "deep.rooms:Mine"}})
    (site / "deep" / "rooms").mkdir(parents=True)
    (site / "deep" / "__init__.py").write_text("imported = True")
    (site / "deep" / "rooms" / "__init__.py").write_text("class Mine:\n    '''In the folder.'''")
    (site / "deep" / "rooms" / "mine.py").write_text("class Mine:\n    '''In the file.'''")
    assert [listing.summary for listing in Registry().listings] == ["In the file.", "In the folder."]
    assert "deep" not in sys.modules


def test_names_from_a_hook_are_listed_and_loaded(install):
    install(
        "acme",
        {"tangible.hooks": {"names": "acme_names"}},
        acme=MINE,
        acme_names="""
            from tangible_core.plugins.hooks import hookimpl
            @hookimpl
            def tangible_methods(kind):
                return {"computed": "acme:Mine", "lost": "acme:Gone"} if kind == "depth" else {}
            """,
    )
    registry = Registry()
    assert (registry.names("depth"), registry.names("texture")) == (["computed", "lost"], [])
    assert "acme" not in sys.modules
    assert registry.find("depth", "computed").origin == "computed by a hook"
    assert registry.load("depth", "computed").__name__ == "Mine"
    with pytest.raises(BrokenMethod, match=r"'lost' \(acme:Gone, from computed by a hook\) cannot be loaded"):
        registry.load("depth", "lost")


@pytest.mark.parametrize(
    "answer", ["1 / 0", "return ['odd']", "return {'odd': 3}", "return {3: 'odd:Odd'}", "return 3"]
)
def test_hook_with_nonsense_names_leaves_the_others_usable(install, answer):
    install_mine(install)
    install(
        "odd",
        {"tangible.hooks": {"names": "odd_names"}},
        odd_names=f"""
            from tangible_core.plugins.hooks import hookimpl
            @hookimpl
            def tangible_methods(kind):
                {answer}
            """,
    )
    assert "mine" in Registry().names("depth")
    assert Registry().load("depth", "mine")

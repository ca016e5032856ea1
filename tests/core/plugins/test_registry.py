import subprocess
import sys

import pytest

from tangible_core.errors import BrokenMethod, UnknownMethod
from tangible_core.plugins import hooks
from tangible_core.plugins.interfaces import DepthEstimator
from tangible_core.plugins.registry import KIND_NAMES, Registry, load_method

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


def test_registry_without_plugins_is_empty(install):
    assert Registry().listings == ()
    with pytest.raises(UnknownMethod, match="no depth method is named 'mine'; installed: none"):
        Registry().load("depth", "mine")


def test_method_is_listed_without_being_imported(install):
    install_mine(install)
    [listing] = Registry().listings
    assert (listing.kind, listing.name, listing.target) == ("depth", "mine", "acme:Mine")
    assert (listing.origin, listing.distribution) == ("acme 1.0", "acme")
    assert listing.summary == "The same everywhere."
    assert "acme" not in sys.modules


def test_method_is_loaded_by_name(install):
    install_mine(install)
    cls = Registry().load("depth", "mine")
    assert issubclass(cls, DepthEstimator)
    assert cls is Registry().load("depth", "acme/mine")


def test_listings_are_sorted_by_kind_and_name(install):
    install("b", {f"tangible.{kind}": {"y": "b:Y", "x": "b:X"} for kind in reversed(KIND_NAMES)})
    install("a", {"tangible.depth": {"y": "a:Y"}, "tangible.other": {"z": "a:Z"}})
    listings = [(each.kind, each.name, each.distribution) for each in Registry().listings]
    depth = [("depth", "x", "b"), ("depth", "y", "a"), ("depth", "y", "b")]
    assert listings == depth + [(kind, name, "b") for kind in KIND_NAMES[1:] for name in ("x", "y")]


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("mime", r"no depth method is named 'mime' \(did you mean 'mine'\?\); installed: mine"),
        ("other/mine", r"no depth method is named 'other/mine'.*; installed: mine"),
        ("", "no depth method is named ''; installed: mine"),
        ("Mine", "installed: mine"),
    ],
)
def test_name_that_is_not_installed_is_refused_with_the_nearest(install, name, complaint):
    install_mine(install)
    with pytest.raises(UnknownMethod, match=complaint):
        Registry().load("depth", name)


def test_unknown_kind_is_refused_with_the_nearest(install):
    with pytest.raises(UnknownMethod, match=r"no kind of methods is named 'dept' \(did you mean 'depth'\?\)"):
        Registry().load("dept", "mine")


def test_name_of_another_kind_is_refused(install):
    install_mine(install)
    with pytest.raises(UnknownMethod, match="no texture method is named 'mine'"):
        Registry().load("texture", "mine")


@pytest.mark.parametrize(
    ("source", "complaint"),
    [
        ("import a_module_that_is_not_there", "ModuleNotFoundError: No module named 'a_module_that_is_not_there'"),
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("def (", "SyntaxError"),
        ("", "AttributeError: module 'broken' has no attribute 'Mine'"),
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
    assert [type(each.summary) for each in registry.listings] == [str, str]
    with pytest.raises(BrokenMethod, match=rf"depth method 'broken' \(broken:Mine.*{complaint}"):
        registry.load("depth", "broken")
    assert registry.load("depth", "mine")().estimate


@pytest.mark.parametrize(
    ("target", "summary"),
    [
        ("no_such_package.module:Mine", "(cannot be read: there is no module no_such_package)"),
        ("acme.no_such_module:Mine", "(cannot be read:"),
        ("acme:Mime", "(cannot be read: acme has no class Mime (did you mean 'Mine'?))"),
        ("acme", "(cannot be read:"),
        ("acme:", "(cannot be read:"),
        ("?", "(cannot be read:"),
        ("acme:Bare", "(no docstring)"),
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
        BrokenMethod,
        match=r"'mine' is offered by acme 1\.0 and rival 1\.0; write acme/mine or rival/mine",
    ):
        registry.load("depth", "mine")
    assert registry.load("depth", "rival/mine").__module__ == "rival"
    assert registry.load("depth", "acme/mine").__module__ == "acme"
    assert registry.load("depth", "other").__module__ == "rival"


@pytest.mark.parametrize(
    ("group", "what"), [("depth", "depth method slow (slow:Slow, from acme 1.0)"), ("hooks", "hooks slow (slow)")]
)
def test_plugin_with_a_slow_import_is_logged_meanwhile(install, monkeypatch, caplog, group, what):
    monkeypatch.setattr("tangible_core.runtime.slowness.LONG_S", 0.01)
    slow = """
        import time
        until = time.monotonic() + 60
        while not heard.messages and time.monotonic() < until:
            time.sleep(0.005)
        class Slow: pass
        """
    monkeypatch.setattr("builtins.heard", caplog, raising=False)
    target = "slow" if group == "hooks" else "slow:Slow"
    install("acme", {f"tangible.{group}": {"slow": target}}, slow=slow)
    if group == "hooks":
        hooks.manager()
    else:
        with pytest.raises(BrokenMethod, match="is not a DepthEstimator"):
            Registry().load("depth", "slow")
    assert caplog.messages[0].startswith(f"importing {what}")
    assert caplog.messages[0].endswith("has taken 0.01 s so far and goes on; Ctrl-C ends it")


def test_plugin_with_a_heavy_library_is_listed_without_importing_it(install):
    site = install(
        "heavy",
        {"tangible.depth": {"heavy": "heavy:Mine"}},
        heavy="import heavy_library\n" + MINE.replace("\n    ", "\n"),
        heavy_library="raise AssertionError('imported by a listing')",
    )
    install_mine(install)
    assert [each.summary for each in Registry().listings] == ["The same everywhere."] * 2
    code = (
        f"import sys; sys.path.insert(0, {str(site)!r}); from tangible_core.plugins.registry import Registry; "
        "names = Registry().names('depth'); assert 'heavy' in names, names; "
        "print([each.summary for each in Registry().listings if each.name == 'heavy'], 'heavy_library' in sys.modules)"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "['The same everywhere.'] False"


def test_method_in_a_package_has_its_summary_read_from_the_file(install):
    site = install("deep", {"tangible.depth": {"file": "deep.rooms.mine:Mine", "folder": "deep.rooms:Mine"}})
    (site / "deep" / "rooms").mkdir(parents=True)
    (site / "deep" / "__init__.py").write_text("imported = True")
    (site / "deep" / "rooms" / "__init__.py").write_text("class Mine:\n    '''In the folder.'''")
    (site / "deep" / "rooms" / "mine.py").write_text("class Mine:\n    '''In the file.'''")
    assert [each.summary for each in Registry().listings] == ["In the file.", "In the folder."]
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
    assert registry.names("depth") == ["computed", "lost"]
    assert registry.names("texture") == []
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


def test_shipped_methods_are_installed():
    assert load_method("depth", "opencv-sgbm").__name__ == "OpenCVSGBM"
    assert load_method("device", "mock").__name__ == "Mock"

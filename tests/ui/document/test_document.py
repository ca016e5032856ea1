"""The document that all tabs edit: key by key, never more than the key, one step back and forth."""

import asyncio
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest

from sessions import TEXT, SmallSession, small_scene
from tangible_core.errors import ConfigError
from tangible_ui.requests import REQUESTS
from tangible_ui.state.session import MOST_HISTORY

Run = Callable[[Callable[[SmallSession, Any], Coroutine[Any, Any, None]]], None]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Do something with a session on which the small scene is opened, and nothing was made."""
    path = small_scene(tmp_path)

    def do(what: Callable[[SmallSession, Any], Coroutine[Any, Any, None]]) -> None:
        async def all_of_it() -> None:
            small = SmallSession(tmp_path, monkeypatch)

            async def ask(name: str, **told: Any) -> Any:
                return await REQUESTS[name](small.session, small.tab, **told)

            small.session.path = path
            await ask("edit", text=TEXT)
            await what(small, ask)

        asyncio.run(all_of_it())

    return do


def test_change_of_a_key_leaves_the_rest(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        await ask("set", changes={"render.stiffness_n_per_m": 500})
        assert small.session.text == TEXT.replace("400", "500")
        said = small.tab.last("document")
        assert said["values"]["render"]["stiffness_n_per_m"] == 500
        assert (said["said"]["render"], said["complaints"]) == ({"use": "penalty", "stiffness_n_per_m": 500}, [])
        await ask("set", changes={"workspace.smooth_m": "2 mm"})
        assert "{width_m: 0.06, relief_m: 0.004, smooth_m: 2 mm}" in small.session.text
        assert small.tab.last("document")["values"]["workspace"]["smooth_m"] == 0.002
        await ask("set", removed=["workspace.smooth_m", "render.stiffness_n_per_m"])
        assert small.session.text == TEXT.replace(", stiffness_n_per_m: 400", "")
        await ask("set", changes={"depth.use": "contour"})
        assert "depth: {use: contour}  # bright is near" in small.session.text

    run(check)


def test_change_leaves_keys_without_a_form(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        more = "simplify: {gap_m: 4 mm}\nexport: [text, {use: heights, width_m: 160 mm}]  # for others\n"
        await ask("edit", text=TEXT + more)
        await ask("set", changes={"render.stiffness_n_per_m": 500})
        assert small.session.text == (TEXT + more).replace("400", "500")
        said = small.tab.last("document")
        assert said["values"]["simplify"]["gap_m"] == 0.004
        assert [each["use"] for each in said["values"]["export"]] == ["text", "heights"]
        await ask("set", changes={"export.heights.width_m": "120 mm"})
        assert "export: [text, {use: heights, width_m: 120 mm}]  # for others" in small.session.text

    run(check)


def test_change_takes_a_value_in_yaml(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        await ask("set", written={"materials.by": "{0: ice, 1: sand, 2: brick}"})
        assert small.tab.last("document")["values"]["materials"]["by"] == {"0": "ice", "1": "sand", "2": "brick"}
        before = small.session.text
        with pytest.raises(ConfigError) as refused:
            await ask("set", written={"materials.by": "{0: ice"})
        assert refused.value.complaints[0].location == ("materials", "by")
        assert small.session.text == before

    run(check)


def test_complaint_names_its_field_and_leaves_the_text(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        await ask("set", changes={"render.stiffness_n_per_m": -5})
        said = small.tab.last("document")
        assert said["values"] is None
        (complaint,) = said["complaints"]
        assert tuple(complaint["location"]) == ("render", "stiffness_n_per_m")
        assert complaint["line"] == 7
        assert said["said"]["render"]["stiffness_n_per_m"] == -5
        assert "-5}  # soft" in small.session.text
        await ask("edit", text="scene: [")
        said = small.tab.last("document")
        assert (said["said"], said["values"], len(said["complaints"])) == (None, None, 1)

    run(check)


def test_document_tells_what_its_scene_is_and_what_its_relief_is_made_of(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        parts = (
            "scene: {photo: p.png, segments: s.png}\nheights: {by: given}\nparts: {0: {name: wall, height_m: 0.001}}\n"
        )
        for text, kinds in (
            ("scene: {photo: p.png}\n", ("photograph", "photograph")),
            ("scene: {photo: p.png}\nrelief: edges\n", ("photograph", "edges")),
            ("scene: {left: l.png, right: r.png}\ndepth: luminance\nrelief: edges\n", ("depth", "edges")),
            ("scene: {height: h.npy}\n", ("heights", "heights")),
            (parts, ("photograph", "parts")),
            ("scene: {photo: p.png\n", (None, None)),
        ):
            await ask("edit", text=text)
            said = small.tab.last("document")
            assert (said["scene_kind"], said["relief_from"]) == kinds, (text, said["complaints"])

    run(check)


def test_changes_at_the_same_time_are_all_kept(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        keys = {"render.stiffness_n_per_m": 700, "workspace.width_m": 0.07, "depth.smoothing_px": 2}
        await asyncio.gather(*(ask("set", changes={key: value}) for key, value in keys.items()))
        values = small.tab.last("document")["values"]
        assert values["render"]["stiffness_n_per_m"] == 700
        assert values["workspace"]["width_m"] == 0.07
        assert values["depth"]["smoothing_px"] == 2

    run(check)


def test_edit_of_an_older_text_is_refused(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        old = small.tab.last("document")["digest"]
        await ask("set", changes={"render.stiffness_n_per_m": 500})
        with pytest.raises(ConfigError, match="changed elsewhere"):
            await ask("edit", text=TEXT + "# mine\n", of=old)
        assert "500" in small.session.text
        await ask("edit", text=small.session.text + "# mine\n", of=small.session.digest)
        assert small.session.text.endswith("# mine\n")

    run(check)


def test_undo_and_redo_step_through_the_history(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        assert await ask("undo") is None
        for stiffness in range(500, 620):
            await ask("set", changes={"render.stiffness_n_per_m": stiffness})
        await ask("set", changes={"render.stiffness_n_per_m": 619})  # as it is: no step
        await ask("undo")
        assert "618" in small.session.text
        await ask("redo")
        assert "619" in small.session.text
        assert await ask("redo") is None
        steps = 0
        while small.tab.last("document")["can_undo"]:
            await ask("undo")
            steps += 1
        assert steps == 100
        await ask("set", changes={"render.stiffness_n_per_m": 300})
        assert small.tab.last("document")["can_redo"] is False

    run(check)


def test_tab_opened_later_gets_the_last_document_alone(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        small.session.tell("error", text="kept")
        for stiffness in range(3):
            await ask("set", changes={"render.stiffness_n_per_m": 500 + stiffness})
        await small.tab.until("plan")
        names = [each["event"] for each in small.session.history]
        assert names.count("document") == 1
        assert names.count("plan") <= 1
        assert "error" in names
        assert next(each for each in small.session.history if each["event"] == "document")["text"] == small.session.text
        assert len(names) < MOST_HISTORY

    run(check)


def test_changes_of_the_command_line_are_in_the_text(run: Run, tmp_path: Path):
    async def check(small: SmallSession, ask: Any) -> None:
        small.session.sets = ["render.stiffness_n_per_m=0.3 N/mm"]
        await ask("begin", files=[str(tmp_path / "mine.yaml")])
        await small.tab.until("touch")
        assert "stiffness_n_per_m: 0.3 N/mm}  # soft" in small.session.text
        await ask("set", changes={"render.stiffness_n_per_m": 350})
        assert small.tab.last("document")["values"]["render"]["stiffness_n_per_m"] == 350

    run(check)


def test_library_gives_the_sources_of_its_figures(run: Run):
    async def check(small: SmallSession, ask: Any) -> None:
        ice = next(each for each in await ask("library") if each["name"] == "ice")
        assert ice["stiffness_n_per_m"] == 1400
        assert "physics.info" in str(ice["source"])

    run(check)

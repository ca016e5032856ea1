"""The document that all tabs edit: otherwise a change of one key loses a comment, or another tab's edit."""

import asyncio
from pathlib import Path
from typing import Any

import pytest

from sessions import TEXT, SmallSession
from tangible_core.errors import ConfigError, PictureError

pytestmark = pytest.mark.anyio


async def test_change_of_a_key_leaves_the_rest(small: SmallSession, ask: Any):
    await ask("set", changes={"render.stiffness_n_per_m": 500})
    assert small.session.document.text == TEXT.replace("400", "500")
    said = small.tab.last("document")
    assert said["values"]["render"]["stiffness_n_per_m"] == 500
    assert (said["said"]["render"], said["complaints"]) == ({"use": "penalty", "stiffness_n_per_m": 500}, [])
    await ask("set", changes={"workspace.smooth_m": "2 mm"})
    assert "{width_m: 0.06, relief_m: 0.004, smooth_m: 2 mm}" in small.session.document.text
    assert small.tab.last("document")["values"]["workspace"]["smooth_m"] == 0.002
    await ask("set", removed=["workspace.smooth_m", "render.stiffness_n_per_m"])
    assert small.session.document.text == TEXT.replace(", stiffness_n_per_m: 400", "")
    await ask("set", changes={"depth.use": "cues"})
    assert "depth: {use: cues}  # bright is near" in small.session.document.text


async def test_change_takes_a_value_in_yaml(small: SmallSession, ask: Any):
    await ask("set", written={"materials.by": "{1: ice, 2: sand, 3: brick}"})
    assert small.tab.last("document")["values"]["materials"]["by"] == {"1": "ice", "2": "sand", "3": "brick"}
    before = small.session.document.text
    with pytest.raises(ConfigError) as refused:
        await ask("set", written={"materials.by": "{1: ice"})
    assert refused.value.complaints[0].location == ("materials", "by")
    assert small.session.document.text == before


async def test_complaint_names_its_field_and_leaves_the_text(small: SmallSession, ask: Any):
    await ask("set", changes={"render.stiffness_n_per_m": -5})
    said = small.tab.last("document")
    assert said["values"] is None
    (complaint,) = said["complaints"]
    assert (tuple(complaint["location"]), complaint["line"]) == (("render", "stiffness_n_per_m"), 7)
    assert said["said"]["render"]["stiffness_n_per_m"] == -5
    assert "-5}  # soft" in small.session.document.text
    await ask("edit", text="scene: [")
    said = small.tab.last("document")
    assert (said["said"], said["values"], len(said["complaints"])) == (None, None, 1)


async def test_document_tells_what_its_scene_is_and_what_its_relief_is_made_of(small: SmallSession, ask: Any):
    parts = "scene: {photo: p.png, segments: s.png}\nheights: {by: given}\nparts: {1: {name: wall, height_m: 0.001}}\n"
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


async def test_changes_at_the_same_time_are_all_kept(small: SmallSession, ask: Any):
    keys = {"render.stiffness_n_per_m": 700, "workspace.width_m": 0.07, "depth.smoothing_px": 2}
    await asyncio.gather(*(ask("set", changes={key: value}) for key, value in keys.items()))
    values = small.tab.last("document")["values"]
    assert values["render"]["stiffness_n_per_m"] == 700
    assert values["workspace"]["width_m"] == 0.07
    assert values["depth"]["smoothing_px"] == 2


async def test_edit_of_an_older_text_is_refused(small: SmallSession, ask: Any):
    old = small.tab.last("document")["digest"]
    await ask("set", changes={"render.stiffness_n_per_m": 500})
    with pytest.raises(ConfigError, match="changed elsewhere"):
        await ask("edit", text=TEXT + "# mine\n", of=old)
    assert "500" in small.session.document.text
    await ask("edit", text=small.session.document.text + "# mine\n", of=small.session.document.digest)
    assert small.session.document.text.endswith("# mine\n")


async def test_undo_and_redo_step_through_the_history(small: SmallSession, ask: Any):
    assert await ask("undo") is None
    for stiffness in (500, 501, 502, 502):  # the last one is no step
        await ask("set", changes={"render.stiffness_n_per_m": stiffness})
    await ask("undo")
    assert "501" in small.session.document.text
    await ask("redo")
    assert "502" in small.session.document.text
    assert await ask("redo") is None
    for _ in range(3):
        assert small.tab.last("document")["can_undo"]
        await ask("undo")
    assert small.session.document.text == TEXT and not small.tab.last("document")["can_undo"]
    await ask("set", changes={"render.stiffness_n_per_m": 300})
    assert small.tab.last("document")["can_redo"] is False


async def test_changes_of_the_command_line_are_in_the_text(small: SmallSession, ask: Any, tmp_path: Path):
    small.session.document.sets = ["render.stiffness_n_per_m=0.3 N/mm"]
    await ask("begin", files=[str(tmp_path / "mine.yaml")])
    await small.tab.until("touch")
    assert "stiffness_n_per_m: 0.3 N/mm}  # soft" in small.session.document.text
    await ask("set", changes={"render.stiffness_n_per_m": 350})
    assert small.tab.last("document")["values"]["render"]["stiffness_n_per_m"] == 350


async def test_file_that_is_not_opened_is_no_longer_shown(small: SmallSession, ask: Any, tmp_path: Path):
    with pytest.raises(PictureError):
        await ask("begin", files=[str(tmp_path / "gone.png")])
    shown = [(event["name"], event["picture"]) for event in small.tab.events if event["event"] == "opening"]
    assert shown[-2:] == [("gone.png", True), ("", False)]

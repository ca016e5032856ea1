"""Export, legibility, description: otherwise files of another document, or another verdict, are handed on."""

import asyncio
import threading
from pathlib import Path
from time import perf_counter
from typing import Any
from zipfile import ZipFile

import numpy as np
import pytest
from PIL import Image

from sessions import TEXT, SmallSession, striped_scene
from tangible_core.errors import ConfigError, TangibleError
from tangible_core.pipeline.output.result_folders import LISTED
from tangible_export.stl import Stl
from waiting import LONGEST_S

pytestmark = pytest.mark.anyio
STL = {"use": "stl", "longer_side_m": 0.06}


@pytest.fixture
async def small(small: SmallSession) -> SmallSession:
    """The scene is felt."""
    await small.ask("make")
    await small.tab.until("touch")
    return small


def folders(small: SmallSession) -> list[Path]:
    return sorted(small.session.folder.glob("export-*"))


class TestExport:
    async def test_export_writes_the_document_on_the_screen_and_tells_every_tab(
        self, small: SmallSession, ask: Any
    ) -> None:
        import trimesh

        await ask("edit", text=TEXT.replace("relief_m: 0.004", "relief_m: 0.001"))  # and it is not saved
        begun_s = perf_counter()
        found = await ask("export", exports=[STL])
        assert 0 <= small.tab.last("made")["seconds"] <= perf_counter() - begun_s
        told = small.tab.last("exported")
        assert {key: told[key] for key in found} == found
        assert (told["digest"], small.tab.last("made")["want"]) == (small.session.document.digest, "export")
        (only,) = found["exports"]
        assert (only["name"], only["outcome"]) == ("stl", "ran")
        assert only["legible"]["sentence"]
        (file,) = only["files"]
        path = small.session.folder / found["folder"] / file["name"]
        assert (path.name, path.stat().st_size) == ("mine.stl", file["bytes"])
        solid: Any = trimesh.load(path)
        assert solid.is_volume
        base_mm, braille_mm = 1.5, 0.5
        assert base_mm < solid.extents[2] < base_mm + 1.0 + braille_mm + 0.2, "the file's relief is 4 mm"

    async def test_export_takes_the_language_of_the_page(self, small: SmallSession, ask: Any) -> None:
        for line, words in (("", "Eine Fläche"), ("language: en\n", "A surface")):
            await ask("edit", text=TEXT + line)
            found = await ask("export", exports=["text"], language="de")
            assert words in (small.session.folder / found["folder"] / "mine.txt").read_text("utf-8")

    async def test_exporter_that_fails_leaves_the_others(self, ask: Any, monkeypatch) -> None:
        def fail(self: Stl, work: Any, stem: Path) -> Any:
            raise TangibleError("the relief has no height; raise workspace.relief_m")

        monkeypatch.setattr(Stl, "write", fail)
        found = await ask("export", exports=[STL, "3mf"])
        wrong, fine = found["exports"]
        assert (wrong["outcome"], wrong["files"]) == ("refused", [])
        assert wrong["why"] == "the relief has no height; raise workspace.relief_m"
        assert [each["name"] for each in fine["files"]] == ["mine.3mf"]

    async def test_invalid_export_is_refused_and_leaves_no_folder(self, small: SmallSession, ask: Any) -> None:
        for exports, says in (
            ([{"use": "stl", "base_m": -1}], "base_m"),
            ([{"use": "stone"}], "stone"),
            ([], "exporter"),
        ):
            with pytest.raises(ConfigError, match=says):
                await ask("export", exports=exports)
            assert (small.tab.last("made")["outcome"], folders(small)) == ("failed", [])

    async def test_stopped_export_returns_none_and_leaves_no_files(
        self, small: SmallSession, ask: Any, monkeypatch
    ) -> None:
        begun, go_on = threading.Event(), threading.Event()
        write = Stl.write

        def waits(self: Stl, work: Any, stem: Path) -> Any:
            begun.set()
            assert go_on.wait(LONGEST_S)
            return write(self, work, stem)

        monkeypatch.setattr(Stl, "write", waits)
        asked = asyncio.ensure_future(ask("export", exports=[STL]))
        await asyncio.to_thread(begun.wait, LONGEST_S)
        await ask("stop_making")
        assert await asked is None
        assert small.tab.last("made")["outcome"] == "stopped"
        assert "exported" not in small.tab.names()
        go_on.set()

    async def test_zip_contains_all_files(self, small: SmallSession, ask: Any) -> None:
        found = await ask("export", exports=[STL, "3mf"])
        name = await ask("export_zip", folder=found["folder"])
        assert name == await ask("export_zip", folder=found["folder"]), "it is there already"
        at = small.session.folder / found["folder"]
        assert name == "mine.zip"
        with ZipFile(at / name) as packed:
            assert packed.testzip() is None
            assert {each: packed.read(each) for each in packed.namelist()} == {
                each: (at / each).read_bytes() for each in ("mine.3mf", "mine.stl")
            }
        assert {path.name for path in at.iterdir()} == {"mine.3mf", "mine.stl", "mine.zip", LISTED}

    async def test_zip_of_another_folder_is_refused(self, ask: Any) -> None:
        for folder in ("", "..", "export-0000000000000000", "export-x/../../secret", "drawn"):
            with pytest.raises(ConfigError, match="export them again"):
                await ask("export_zip", folder=folder)


class TestPreviews:
    @pytest.fixture
    def scene(self, tmp_path: Path) -> Path:
        return striped_scene(tmp_path)

    async def test_preview_is_a_picture_of_what_will_be_written(self, small: SmallSession, ask: Any) -> None:
        for block, wide_m in (("swell", 0.237), ({"use": "stl", "longer_side_m": 0.1}, 0.1), ("pins", 0.133)):
            found = await ask("export_preview", block=block)
            assert found["width_m"] == pytest.approx(wide_m, abs=2e-3), block
            assert found["waits"] is False
            with Image.open(small.session.folder / found["file"]) as picture:
                assert picture.size == (found["columns"], found["rows"])
                assert np.asarray(picture).std() > 5
        assert not small.tab.names().count("exported")
        assert not list(small.session.folder.glob("export-*")), "nothing is written"

    async def test_preview_of_files_without_a_picture_and_of_what_cannot_be_written(self, ask: Any) -> None:
        none = {"file": "", "waits": False, "columns": 0, "rows": 0, "width_m": 0.0}
        assert await ask("export_preview", block="text") == none
        with pytest.raises(TangibleError, match="no room on a4"):
            await ask("export_preview", block={"use": "swell", "width_m": 0.5})

    async def test_preview_waits_for_what_is_slow_to_make(self, ask: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("tangible_ui.worker.jobs.export.plan_data", lambda *_: {"slow": ["disparity"]})
        found = await ask("export_preview", block="stl")
        assert (found["file"], found["waits"]) == ("", True)


class TestLegible:
    @pytest.fixture
    def scene(self, tmp_path: Path) -> Path:
        return striped_scene(tmp_path)

    async def test_legibility_verdicts_pass_after_their_cure(self, small: SmallSession, ask: Any) -> None:
        begun_s = perf_counter()
        drawn = await ask("legible", medium="swell", width_m=0.08)
        assert 0 <= small.tab.last("made")["seconds"] <= perf_counter() - begun_s
        assert (drawn["grade"], drawn["simplified"]) == ("ok", True), "paper gets simplified parts in any case"
        await ask("set", changes={"simplify": {"gap_m": 0.0, "part_m": 0.0}})
        before = small.session.document.text
        found = await ask("legible", medium="swell", width_m=0.08)
        assert small.tab.last("legible")["verdicts"] == found["verdicts"]
        assert (found["medium"], found["width_m"], found["grade"]) == ("swell", 0.08, "illegible")
        (gap,) = (each for each in found["verdicts"] if each["check"] == "gap")
        (place,) = gap["at"]
        assert place[0] == pytest.approx(41 / 80, abs=0.02)
        changes = [change for each in found["verdicts"] for change in each["changes"]]
        cures = {each["key"]: each["value"] for each in changes if each["key"].startswith("simplify")}
        assert "simplify.gap_m" in cures
        await ask("set", changes=cures)
        again = await ask("legible", medium="swell")
        assert (again["grade"], again["digest"]) == ("ok", small.session.document.digest)
        await ask("undo")
        assert small.session.document.text == before

    async def test_legibility_of_the_panel_is_judged_at_the_width_of_the_export(self, ask: Any) -> None:
        await ask("set", changes={"simplify": {}})
        await ask("set", changes={"export": [{"use": "swell", "width_m": 0.05}]})
        exported = await ask("export", exports=[{"use": "swell", "width_m": 0.05}])
        found = await ask("legible", medium="swell")
        assert found["width_m"] == pytest.approx(0.05, abs=1e-3)
        assert found["grade"] == exported["exports"][0]["legible"]["grade"]


class TestDescription:
    async def test_description_is_in_the_requested_language(self, small: SmallSession, ask: Any) -> None:
        said = {each: await ask("description", language=each) for each in ("en", "de", "fr")}
        assert len({each["text"] for each in said.values()}) == 3
        for language, each in said.items():
            assert each["digest"] == small.tab.last("scene")["digest"]
            assert each["parts"] and all(part["says"] for part in each["parts"])
            assert f'<html lang="{language}">' in each["html"]
            assert each["parts"][0]["label"] in each["text"]

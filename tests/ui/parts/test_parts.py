"""The parts editor's side of the server: otherwise parts that somebody drew are lost, or felt as others."""

import asyncio
import gzip
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from full_disk import files_up_to
from sessions import TEXT, SmallSession, small_scene
from tangible_authoring.first_parts import first_parts
from tangible_core import load_pipeline
from tangible_core.data import SegmentMap
from tangible_core.errors import ConfigError, TangibleError
from tangible_core.parts import find_parts
from tangible_core.pipeline.config.editing import read_values
from tangible_core.scene.formats.pictures import read_labels
from tangible_ui.state.session import LatestWins, Session
from tangible_ui.worker.jobs import JOBS, making
from tangible_ui.worker.parts import opening
from tangible_ui.worker.parts.opening import _places
from tangible_ui.worker.parts.saving import as_png, document_with_parts, is_ours, number_parts, unpack
from tangible_ui.worker.state import WorkerState
from waiting import happened

pytestmark = pytest.mark.anyio
SHAPE = (24, 32)


def drawn() -> np.ndarray:
    """Three parts of the small scene: ground, and two on it."""
    labels = np.zeros(SHAPE, np.uint16)
    labels[4:12, 4:14] = 7
    labels[10:22, 18:28] = 3
    return labels


def packed(labels: np.ndarray) -> bytes:
    return gzip.compress(labels.astype("<u2").tobytes())


class TestLabels:
    @pytest.mark.parametrize("count", [1, 256, 257])
    def test_label_file_holds_the_labels(self, tmp_path: Path, count: int) -> None:
        labels = (np.arange(1200, dtype=np.int32) % count).reshape(30, 40)
        path = tmp_path / "parts.png"
        path.write_bytes(as_png(labels, "mine.yaml"))
        with Image.open(path) as image:
            image.verify()
        read = find_parts(SegmentMap(read_labels(path)))
        np.testing.assert_array_equal(read.labels, find_parts(SegmentMap(labels)).labels)
        assert is_ours(path, "mine.yaml")
        assert not is_ours(path, "other.yaml")

    def test_label_file_that_was_painted_in_is_not_ours(self, tmp_path: Path) -> None:
        path = tmp_path / "parts.png"
        path.write_bytes(as_png(drawn().astype(np.int32), "mine.yaml"))
        with Image.open(path) as image:
            image.load()
            painted, said = image.copy(), PngInfo()
            for key, value in getattr(image, "text").items():  # noqa: B009
                said.add_text(key, value)
        painted.putpixel((0, 0), 5)
        painted.save(path, pnginfo=said)
        assert not is_ours(path, "mine.yaml")
        path.write_bytes(b"no picture")
        assert not is_ours(path, "mine.yaml")

    def test_label_upload_is_unpacked_unless_it_has_too_many(self, tmp_path: Path) -> None:
        with pytest.raises(ConfigError, match="5000 parts, and at most 4096"):
            as_png(np.arange(5000, dtype=np.int32).reshape(50, 100), "mine.yaml")
        path = tmp_path / "sent"
        noise = np.random.default_rng(0).integers(0, 2**16, (600, 800), np.uint16)
        for labels, level in ((drawn(), 9), (noise, 0)):
            path.write_bytes(gzip.compress(labels.tobytes(), level))
            np.testing.assert_array_equal(unpack(path, labels.shape), labels)

    def test_upload_of_anything_else_is_refused(self, tmp_path: Path) -> None:
        path = tmp_path / "sent"
        for sent in (
            b"",
            b"no gzip",
            packed(drawn())[:-9],
            packed(drawn()[1:]),
            packed(np.zeros((25, 32))),
            zlib.compress(drawn().tobytes()),
            drawn().tobytes(),
            gzip.compress(bytes(10_000_000)),
        ):
            path.write_bytes(sent)
            with pytest.raises(ConfigError, match="not a gzip of 32 x 24"):
                unpack(path, SHAPE)


class TestNumbers:
    def test_parts_are_numbered_by_their_first_pixels_and_largest_piece(self) -> None:
        numbers = np.array([[0, 0, 1], [0, 1, 1], [2, 2, 1]], np.int32)
        told = [{"label": 7, "name": "wall"}, {"label": 3, "height_m": 0.002, "name": ""}, {"label": 5, "name": None}]
        choices, found = number_parts(told, [7, 3, 5], numbers)
        assert choices == {0: {"name": "wall"}, 1: {"height_m": 0.002}, 2: {}}
        assert found == {"7": [0], "3": [1], "5": [2]}
        numbers = np.array([[0, 1, 2, 2, 1, 3]], np.int32)
        told = [{"label": 7, "name": "leaf", "material": "wood"}, {"label": 8, "name": " Leaf 2"}]
        choices, found = number_parts(told, [7, 8, 7, 7], numbers)
        assert choices[2] == {"name": "leaf", "material": "wood"}
        assert choices[0] == {"name": "leaf 3", "material": "wood"}
        assert choices[3] == {"name": "leaf 4", "material": "wood"}
        assert found == {"7": [0, 2, 3], "8": [1]}

    def test_part_entry_without_a_label_is_refused(self) -> None:
        for told, says in (
            ([{"label": 9, "name": "gone"}], "no pixel"),
            ([{"label": 7}, {"label": 7}], "has two entries"),
            ([{"name": "wall"}], "number of its label"),
            ([{"label": "7"}], "number of its label"),
        ):
            with pytest.raises(ConfigError, match=says):
                number_parts(told, [7], np.zeros((1, 1), np.int32))


class TestText:
    def said(self, text: str, path: Path, parts: dict[int, Any], **heights: Any) -> str:
        return document_with_parts(text, path, path.parent / "parts.png", parts, heights or None, {"title": None})

    def test_document_gets_a_line_for_each_part_and_keeps_comments(self, tmp_path: Path) -> None:
        parts = {0: {"name": "wall"}, 2: {"name": "hat", "height_m": 0.0042, "material": "glass"}, 3: {}}
        found = self.said(TEXT, tmp_path / "mine.yaml", parts, by="given")
        assert found == TEXT.replace("photo: mine.png", "photo: mine.png, segments: parts.png") + (
            "heights: {by: given}\nparts:\n  1: wall\n  3: {name: hat, height_m: 4.2 mm, material: glass}\n"
        )
        text = "scene: {photo: a.png}\nparts:\n  1: wall  # grey\n  2: hat\n  5: gone\n# the end\n"
        found = self.said(text, tmp_path / "mine.yaml", {0: {"name": "wall"}, 1: {"name": "cap"}, 2: {"name": "bag"}})
        assert "  1: wall  # grey\n  2: cap\n  3: bag\n# the end\n" in found

    def test_parts_and_built_in_scenes_survive_writing_and_reading(self, tmp_path: Path) -> None:
        path = tmp_path / "mine.yaml"
        for name in ("a: b", '"', "\\", "# no comment", "- x", "{}", "null", "007", "é ✂ 𝄞", "a\nb", "\x07", " a "):
            found = self.said(TEXT, path, {0: {"name": name}, 1: {"name": name + "x", "height_m": 0.001}})
            assert read_values(found, path)["parts"] == {"1": name, "2": {"name": name + "x", "height_m": "1 mm"}}
        scene = read_values(self.said("scene: builtin/motorcycle\n", path, {}), path)["scene"]
        assert Path(scene["left"]).is_file()
        assert (scene["focal_px"], scene["segments"]) == (994.978, "parts.png")
        with pytest.raises(ConfigError, match="builtin/nothing"):
            self.said("scene: builtin/nothing\n", path, {})


SAVED = [
    {"label": 0, "name": "wall"},
    {"label": 7, "name": "hat", "height_m": 0.001, "material": "glass"},
    {"label": 3, "name": "bag", "height_m": 0.0005},
]
GIVEN = {"by": "given", "bulge_m": 0.0005}


async def sent(small: SmallSession, ask: Any, data: bytes | None = None) -> str:
    """The batch in which labels wait."""

    async def body() -> Any:
        yield packed(drawn()) if data is None else data

    batch = await ask("batch")
    await small.session.uploads.put(batch, "labels.gz", body())
    return batch


async def saved(small: SmallSession, ask: Any, **told: Any) -> Any:
    return await ask("parts_save", **{"upload": await sent(small, ask), "parts": SAVED, "heights": GIVEN, **told})


class TestOpening:
    async def test_photo_without_segments_opens_as_one_part(self, small: SmallSession, ask: Any) -> None:
        found = await ask("parts_open")
        assert (found["rows"], found["columns"], found["widthM"]) == (24, 32, 0.06)
        assert found["heights"]["by"] == "given"
        assert found["top_m"] == pytest.approx(0.004 - 0.0018)
        (part,) = found["parts"]
        assert (part["number"], part["pixels"], part["height_m"], part["name"]) == (0, 24 * 32, None, "")
        at = small.session.folder
        assert not np.fromfile(at / found["labels"], "<u2").any()
        with Image.open(at / found["picture"]) as picture:
            assert picture.size == (32, 24)

    async def test_first_parts_are_those_of_the_terminal(self, small: SmallSession, ask: Any, tmp_path: Path) -> None:
        """A photo that nobody has divided: the same parts, in the same order of heights, as in `tangible parts`."""
        picture = np.full((90, 120, 3), 200, np.uint8)
        picture[60:] = [60, 90, 40]
        picture[20:50, 30:70] = [180, 30, 30]
        Image.fromarray(picture).save(tmp_path / "scene.png")
        await ask("begin", files=[str(tmp_path / "scene.png")], make_it=False)
        assert not (await ask("parts_open"))["divided"]
        found = await ask("parts_first")
        labels = np.fromfile(small.session.folder / found["labels"], "<u2").reshape(90, 120)
        wanted = first_parts([tmp_path / "scene.png"], tmp_path / "scene.yaml")
        np.testing.assert_array_equal(labels, wanted.parts.labels)
        assert wanted.parts.count >= 3
        heights = [each.height_m or 0.0 for each in wanted.listed]
        assert np.argsort(found["heights_m"]).tolist() == np.argsort(heights).tolist()
        assert 0 < max(found["heights_m"]) <= (await ask("parts_open"))["top_m"] + 1e-9
        assert not (await ask("parts_open"))["divided"], "nothing is saved by that"

    async def test_saved_parts_are_opened_again(self, small: SmallSession, ask: Any) -> None:
        kept = await saved(small, ask, title="A hat", language="de")
        found = await ask("parts_open")
        assert [each["name"] for each in found["parts"]] == ["wall", "hat", "bag"]
        assert [each["height_m"] for each in found["parts"]] == [None, 0.001, 0.0005]
        assert [each["material"] for each in found["parts"]] == [None, "glass", None]
        assert (found["title"], found["language"], found["heights"]["bulge_m"]) == ("A hat", "de", 0.0005)
        assert found["digest"] == kept["digest"]
        labels = np.fromfile(small.session.folder / found["labels"], "<u2").reshape(SHAPE)
        for number, part in enumerate(found["parts"]):
            assert labels[part["at"][1], part["at"][0]] == number
            assert part["pixels"] == (labels == number).sum()
        np.testing.assert_array_equal(labels, find_parts(SegmentMap(drawn().astype(np.int32) % 5)).labels)

    @pytest.mark.parametrize("scene", ["{height: hill.npy}", "{height: hill.npy, segments: drawn.png}"])
    def test_height_map_opens_as_a_picture(self, tmp_path: Path, scene: str) -> None:
        hill = np.add.outer(np.arange(24.0), np.arange(32.0))
        hill[0, 0] = np.nan
        np.save(tmp_path / "hill.npy", hill)
        Image.fromarray(drawn().astype(np.uint8)).save(tmp_path / "drawn.png")
        worker_state = WorkerState(tmp_path, lambda event, **told: None)
        found = JOBS["parts_open"].do(worker_state, text=f"scene: {scene}\n", path=tmp_path / "a.yaml", sets=[])
        assert len(found["parts"]) == (3 if "segments" in scene else 1)
        with Image.open(tmp_path / found["picture"]) as picture:
            grey = np.asarray(picture.convert("L"))
        assert grey[-1, -1] > 240
        assert grey[0, 1] < 30
        assert grey[0, 0] < 60  # unknown

    def test_place_of_a_part_between_the_sampled_pixels_is_its_first_pixel(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(opening, "MAX_LOOKED_AT", 100)
        labels = np.zeros((20, 20), np.int32)
        labels[:, 10:], labels[10:, :10], labels[10:, 10:] = 1, 2, 3
        labels[3, 7], labels[15, 3:7] = 4, 5
        found = find_parts(SegmentMap(labels))
        places = dict(zip(found.segments, _places(found), strict=True))
        assert places == {0: (4, 4), 1: (14, 4), 2: (4, 14), 3: (14, 14), 4: (7, 3), 5: (3, 15)}


class TestSaving:
    async def test_labels_are_saved_next_to_the_document(self, small: SmallSession, ask: Any, tmp_path: Path) -> None:
        found = await saved(small, ask)
        assert (found["path"], found["file"]) == (str(tmp_path / "parts.png"), str(tmp_path / "mine.yaml"))
        assert found["numbers"] == {"0": [0], "7": [1], "3": [2]}
        assert (tmp_path / "mine.yaml").read_text() == small.session.document.text
        assert small.session.document.text.startswith(
            "# a photograph of mine\nscene: {photo: mine.png, segments: parts.png}\n"
        )
        assert "# bright is near" in small.session.document.text
        await small.tab.until("touch")
        assert small.tab.last("scene")["parts"] == ["wall", "hat", "bag"]
        surface = load_pipeline(tmp_path / "mine.yaml").surface
        assert surface.names == ("wall", "hat", "bag")
        assert not list((tmp_path / "drawn" / "incoming").iterdir())

    @pytest.mark.parametrize("beside", [True, False])
    async def test_document_without_a_file_gets_one_and_no_file_is_replaced(
        self, small: SmallSession, ask: Any, tmp_path: Path, beside: bool
    ) -> None:
        """Next to the photograph if that was chosen, else in the program's folder; what is saved again replaces it."""
        for name in ("mine.yaml", "mine-2.yaml"):
            (tmp_path / name).write_text("# of somebody else\n")
        offered = await ask("parts_open")
        assert (offered["file"], offered["beside"]) == ("", str(tmp_path))
        place = tmp_path / "mine-3.yaml" if beside else tmp_path / "data/drawn/mine/mine.yaml"
        for _ in range(2):
            found = await saved(small, ask, beside=beside)
            assert (Path(found["file"]), Path(found["path"])) == (place, place.with_name("parts.png"))
        assert (tmp_path / "mine.yaml").read_text() == (tmp_path / "mine-2.yaml").read_text() == "# of somebody else\n"
        assert small.session.document.path == place and (await ask("parts_open"))["file"] == str(place)
        assert load_pipeline(place).surface.names == ("wall", "hat", "bag")
        await ask("undo")
        assert small.session.document.path.name == "mine.yaml", "undo leads back to the document that had no parts"

    async def test_uploaded_and_built_in_pictures_have_no_place_beside_them(
        self, small: SmallSession, ask: Any, tmp_path: Path
    ) -> None:
        uploaded = tmp_path / "data" / "opened" / "mine.png"
        uploaded.parent.mkdir(parents=True)
        (tmp_path / "mine.png").rename(uploaded)
        for file in (str(uploaded), "builtin/motorcycle"):
            await ask("begin", files=[file], make_it=False)
            assert (await ask("parts_open"))["beside"] == ""
        await ask("begin", files=[str(uploaded)], make_it=False)
        found = await saved(small, ask, beside=True)
        assert Path(found["file"]).parent.parent == tmp_path / "data" / "drawn"

    @pytest.mark.parametrize(
        ("said", "kept"),
        [("", "rules"), ("materials: {by: roughness}\n", "rules"), ("materials: {by: {1: ice}}\n", {1: "ice"})],
    )
    async def test_saved_parts_get_no_material_by_the_rank_of_their_roughness(
        self, small: SmallSession, ask: Any, tmp_path: Path, said: str, kept: Any
    ) -> None:
        (tmp_path / "mine.yaml").write_text(TEXT + said)
        await ask("begin", files=[str(tmp_path / "mine.yaml")], make_it=False)
        await saved(small, ask)
        pipeline = load_pipeline(tmp_path / "mine.yaml")
        assert pipeline.config.materials.by == kept
        if kept == "rules":
            chosen = pipeline.materials
            assert chosen is not None and [material.name for material in chosen.materials] == [
                "plain",
                "glass",
                "plain",
            ]

    @pytest.mark.parametrize(("key", "warned"), [("3", True), ("hat", False)])
    async def test_materials_by_a_number_that_moved_are_warned_of(
        self, small: SmallSession, ask: Any, caplog: pytest.LogCaptureFixture, key: str, warned: bool
    ) -> None:
        await saved(small, ask)
        await ask("set", written={"materials": f"{{rules: [{{part: {key}, material: ice}}]}}"})
        await saved(small, ask)
        assert "by the numbers" not in caplog.text  # as they were
        moved = drawn()
        moved[moved == 3] = 0
        moved[0, 1] = 3  # the third part is the second now
        await saved(small, ask, upload=await sent(small, ask, packed(moved)))
        assert ("by the numbers 3" in caplog.text) == warned

    async def test_labels_overwrite_no_foreign_file(self, small: SmallSession, ask: Any, tmp_path: Path) -> None:
        (tmp_path / "parts.png").write_bytes(b"of somebody else")
        assert Path((await saved(small, ask))["path"]).name == "parts-2.png"
        assert (tmp_path / "parts.png").read_bytes() == b"of somebody else"
        assert "segments: parts-2.png" in small.session.document.text
        other = drawn()
        other[0, 0] = 7
        found = await saved(small, ask, upload=await sent(small, ask, packed(other)))
        assert Path(found["path"]).name == "parts-2.png"
        assert read_labels(tmp_path / "parts-2.png")[0, 1] == 1

    async def test_labels_before_are_found_by_undo(self, small: SmallSession, ask: Any) -> None:
        await saved(small, ask)
        fewer = drawn()
        fewer[fewer == 3] = 0
        await saved(small, ask, upload=await sent(small, ask, packed(fewer)), parts=SAVED[:2])
        assert len((await ask("parts_open"))["parts"]) == 2
        await ask("undo")
        assert [each["name"] for each in (await ask("parts_open"))["parts"]] == ["wall", "hat", "bag"]

    async def test_invalid_entry_changes_nothing(self, small: SmallSession, ask: Any, tmp_path: Path) -> None:
        wrong: dict[str, dict[str, Any]] = {
            "no pixel": {"parts": [{"label": 9, "name": "gone"}]},
            "name of its own": {"parts": [{"label": 7, "name": "a"}, {"label": 3, "name": "A"}]},
            "the highest can be": {"parts": [{"label": 7, "height_m": 0.5}]},
            "unobtainium": {"parts": [{"label": 7, "material": "unobtainium"}]},
            "heights: {by: given}": {"heights": None},
            "tag of a language": {"language": "not a language"},
            "send them again": {"upload": "0" * 16},
            "changed elsewhere meanwhile": {"of": "of another tab"},
        }
        for says, told in wrong.items():
            with pytest.raises(TangibleError, match=says):
                await saved(small, ask, **told)
            assert small.session.document.text == (tmp_path / "mine.yaml").read_text() == TEXT
            assert not list(tmp_path.glob("parts*"))

    @pytest.mark.parametrize("size", [100, 3000])
    async def test_full_disk_changes_nothing(self, small: SmallSession, ask: Any, tmp_path: Path, size: int) -> None:
        """100: there is no room for the labels; 3000: for the document behind them."""
        (tmp_path / "mine.yaml").write_text(f"{TEXT}# {4000 * 'x'}\n")
        await ask("begin", files=[str(tmp_path / "mine.yaml")], make_it=False)
        await saved(small, ask)
        await small.tab.until("touch")
        text, labels = small.session.document.text, (tmp_path / "parts.png").read_bytes()
        other = drawn()
        other[0, 0] = 7
        upload = await sent(small, ask, packed(other))
        with files_up_to(size), pytest.raises(TangibleError, match="free some space"):
            await ask("parts_save", upload=upload, parts=[], heights=GIVEN)
        assert small.session.document.text == (tmp_path / "mine.yaml").read_text() == text
        assert (tmp_path / "parts.png").read_bytes() == labels
        assert not list(tmp_path.glob(".*"))

    def test_labels_of_a_cropped_and_rotated_scene_are_saved_in_its_frame(self, tmp_path: Path) -> None:
        path = small_scene(tmp_path)
        text = TEXT.replace("photo: mine.png", "photo: mine.png, crop: [3, 2, 20, 15], rotate: 270")
        path.write_text(text)
        worker_state = WorkerState(tmp_path, lambda event, **told: None)
        rows, columns = worker_state.make_pipeline(text, path, []).scene.shape
        labels = np.zeros((rows, columns), np.uint16)
        labels[2:9, 3:8] = 1
        labels[rows - 3 :, columns - 2 :] = 2
        (tmp_path / "sent").write_bytes(packed(labels))
        JOBS["parts_save"].do(
            worker_state, text=text, path=path, sets=[], sent=tmp_path / "sent", parts=[{"label": 1, "name": "a"}],
            heights=GIVEN, words={}, of="", opened=text, store=tmp_path, drawn=tmp_path,
        )  # fmt: skip
        scene = load_pipeline(path).scene
        assert scene.segments is not None
        np.testing.assert_array_equal(scene.segments.labels, labels)


async def test_scene_event_has_the_names_of_parts(small: SmallSession, ask: Any, tmp_path: Path) -> None:
    """Labels that are shown are those that materials are of, though two parts are of one segment."""
    labels = drawn() % 5
    labels[0:2, 0:2] = 2  # another piece of the hat's segment
    Image.fromarray(labels.astype(np.uint8)).save(tmp_path / "drawn.png")
    said = "parts: {1: corner, 2: wall, 3: {name: hat, material: ice}}\nheights: {by: given}\n"
    text = TEXT.replace("photo: mine.png", "photo: mine.png, segments: drawn.png") + said
    await ask("edit", text=text)
    await ask("make", want="materials")
    await ask("make", want="surface")
    shown = await small.tab.until("scene")
    told = (await small.tab.until("materials"))["segments"]
    assert shown["parts"] == ["corner", "wall", "hat", ""] == [each["name"] for each in told]
    assert told[2]["material"] == "ice"
    assert told[0]["share"] == pytest.approx(4 / labels.size)
    told = await small.tab.until("described")
    assert all("hat" in told["says"][language] for language in ("en", "de", "fr"))


def kept_parcels(monkeypatch: pytest.MonkeyPatch, *methods: str) -> list[bytes]:
    """What these methods of sessions are given for the loop from now on, byte by byte."""
    kept: list[bytes] = []

    async def feel(_: Any, made: dict[str, Any]) -> None:
        kept.append(Path(made["parcel"]).read_bytes())
        Path(made["parcel"]).unlink()

    for method in methods:
        monkeypatch.setattr(Session, method, feel)
    return kept


class TestHeights:
    async def test_changed_heights_feel_as_the_saved_document(
        self, small: SmallSession, ask: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        sent_to_the_loop = kept_parcels(monkeypatch, "feel", "feel_on")
        for render in ("{use: penalty}", "{use: proxy}"):
            await ask("set", written={"render": render})
            await saved(small, ask)
            await ask("parts_heights", heights_m=[0.0002, 0.0008, 0.0011], materials=[None, "sand", "ice"],
                      heights={"round_m": 0.004})  # fmt: skip
            felt = sent_to_the_loop[-1]
            parts = [{**SAVED[0], "height_m": 0.0002}, {**SAVED[1], "height_m": 0.0008, "material": "sand"},
                     {**SAVED[2], "height_m": 0.0011, "material": "ice"}]  # fmt: skip
            await saved(small, ask, parts=parts, heights={**GIVEN, "round_m": 0.004})
            pipeline = load_pipeline(tmp_path / "mine.yaml", small.session.felt_sets())
            made = making.make_loop_input(pipeline)
            assert Path(made["parcel"]).read_bytes() == felt
            Path(made["parcel"]).unlink()

    @pytest.mark.parametrize("by", ["guess", "depth", "given"])
    async def test_missing_heights_are_those_of_the_recipe(
        self, small: SmallSession, ask: Any, tmp_path: Path, by: str
    ) -> None:
        if by == "depth":
            await saved(small, ask, parts=SAVED[:1], heights={**GIVEN, "by": "depth"})
            with pytest.raises(ConfigError, match="not made yet"):
                await ask("parts_heights", heights_m=[None, 0.0007, None])
            await ask("make", want="disparity")
        parts = [{"label": 7, "height_m": 0.0007}]
        await saved(small, ask, parts=parts, heights={**GIVEN, "by": by})
        await ask("parts_heights", heights_m=[None, 0.0007, None])
        seen = await happened(lambda: small.worker.state.preview.view)
        wanted = load_pipeline(tmp_path / "mine.yaml").relief.height_m
        np.testing.assert_array_equal(seen.relief.height_m, wanted)

    async def test_changed_heights_feel_by_the_law_of_the_document(
        self, small: SmallSession, ask: Any, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        await saved(small, ask)
        await small.tab.until("touch")
        felt = kept_parcels(monkeypatch, "feel_on")
        for law in ("penalty", "penalty-gradient", "penalty"):
            await ask("set", written={"render": law})
            await ask("parts_heights", heights_m=[0.0, 0.002, 0.001])
        assert felt[0] == felt[2] != felt[1]

    async def test_invalid_heights_are_refused(self, small: SmallSession, ask: Any) -> None:
        with pytest.raises(ConfigError, match="save what was drawn"):
            await ask("parts_heights", heights_m=[0.001])
        await saved(small, ask)
        wrong: dict[str, dict[str, Any]] = {
            "3 parts and 2 heights": {"heights_m": [0.0, 0.001]},
            "the highest can be": {"heights_m": [0.0, 0.001, 0.5]},
            "height_m": {"heights_m": [0.0, 0.001, -1.0]},
            "unobtainium": {"heights_m": [0.0, 0.0, 0.0], "materials": ["unobtainium"]},
            "round_m": {"heights_m": [0.0, 0.0, 0.0], "heights": {"round_m": -1.0}},
        }
        for says, told in wrong.items():
            with pytest.raises(TangibleError, match=says):
                await ask("parts_heights", **told)

    async def test_heights_that_come_too_fast_are_skipped_and_those_of_a_large_surface_are_coarse(
        self, small: SmallSession, ask: Any, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        await saved(small, ask)
        await small.tab.until("touch")
        small.worker.asked.clear()
        text = small.session.document.text
        found = await asyncio.gather(*(ask("parts_heights", heights_m=[0.0, k / 1e4, 0.0]) for k in range(20)))
        assert found == [{}, *[None] * 18, {}]
        assert small.worker.asked.count("parts_heights") == 2
        await happened(lambda: small.tab.last("scene")["height_m"][1] >= 19 / 1e4)
        assert small.worker.state.preview.view.relief.height_m.max() > 19 / 1e4
        assert small.session.document.text == text, "nothing is written before it is saved"
        monkeypatch.setattr("tangible_core.pipeline.engine.preview.MAX_CELLS", 200)
        await ask("parts_heights", heights_m=[0.0, 0.002, 0.001])
        assert small.worker.state.preview.preview.grid.shape == (12, 16)
        await happened(lambda: small.tab.last("scene")["rows"] == 12)


async def test_latest_wins_queue_runs_the_newest_that_waits_and_pauses_between_calls():
    drawn, done = LatestWins(0.2), []

    async def draw(number: int) -> int:
        done.append((number, asyncio.get_running_loop().time()))
        return number

    found = await asyncio.gather(*(drawn.run(lambda k=k: draw(k)) for k in range(5)))
    assert found == [0, None, None, None, 4]
    assert (await drawn.run(lambda: draw(5)), await drawn.run(lambda: draw(6))) == (5, 6)
    assert [number for number, _ in done] == [0, 4, 5, 6]
    assert min(np.diff([at for _, at in done])) > 0.19

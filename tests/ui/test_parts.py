"""The parts editor's side of the server: parts are read, kept as files, and felt while they are changed."""

import asyncio
import gzip
import zlib
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from desks import TEXT, SmallDesk
from tangible_core.errors import ConfigError
from tangible_core.scene.picture_files import read_labels
from tangible_ui.desk.newest import Newest
from tangible_ui.maker import label_files
from tangible_ui.maker.label_files import as_png, is_ours, unpacked
from tangible_ui.maker.saved_parts import numbered, said_of_parts

SHAPE = (24, 32)
Check = Callable[[SmallDesk, Any], Coroutine[Any, Any, None]]


def drawn() -> np.ndarray:
    """Three parts of the small scene: ground, and two on it."""
    labels = np.zeros(SHAPE, np.uint16)
    labels[4:12, 4:14] = 7
    labels[10:22, 18:28] = 3
    return labels


def packed(labels: np.ndarray) -> bytes:
    return gzip.compress(labels.astype("<u2").tobytes())


class TestLabels:
    @pytest.mark.parametrize("count", [1, 2, 256, 257, 900])
    def test_a_file_says_what_was_drawn(self, tmp_path: Path, count: int) -> None:
        labels = (np.arange(1200, dtype=np.int32) % count).reshape(30, 40)
        path = tmp_path / "parts.png"
        path.write_bytes(as_png(labels, "mine.yaml"))
        np.testing.assert_array_equal(read_labels(path), labels)
        assert is_ours(path, "mine.yaml")
        assert not is_ours(path, "other.yaml")

    def test_a_file_that_somebody_painted_in_is_not_ours(self, tmp_path: Path) -> None:
        path = tmp_path / "parts.png"
        path.write_bytes(as_png(drawn().astype(np.int32), "mine.yaml"))
        with Image.open(path) as image:
            image.load()
            said, painted = dict(getattr(image, "text")), image.copy()  # noqa: B009
        painted.putpixel((0, 0), 5)
        from PIL.PngImagePlugin import PngInfo

        info = PngInfo()
        for key, value in said.items():
            info.add_text(key, value)
        painted.save(path, pnginfo=info)
        assert not is_ours(path, "mine.yaml")
        path.write_bytes(b"no picture")
        assert not is_ours(path, "mine.yaml")

    def test_first_colours_can_be_told_apart(self) -> None:
        colours = label_files._PALETTE.astype(int)[:24]
        apart = np.abs(colours[:, None] - colours[None]).sum(-1)
        assert apart[~np.eye(24, dtype=bool)].min() > 20

    def test_more_labels_than_a_file_may_hold_are_said(self) -> None:
        with pytest.raises(ConfigError, match="5000 parts, and at most 4096"):
            as_png(np.arange(5000, dtype=np.int32).reshape(50, 100), "mine.yaml")

    def test_what_is_sent_arrives(self, tmp_path: Path) -> None:
        path = tmp_path / "sent"
        path.write_bytes(packed(drawn()))
        np.testing.assert_array_equal(unpacked(path, SHAPE), drawn())

    @pytest.mark.parametrize(
        "sent",
        [
            b"",
            b"no gzip",
            packed(drawn())[:-9],
            packed(drawn()[1:]),
            packed(np.zeros((25, 32))),
            zlib.compress(drawn().tobytes()),
            drawn().tobytes(),
        ],
        ids=["nothing", "noise", "cut short", "too small", "too large", "another kind", "not packed"],
    )
    def test_anything_else_is_refused(self, tmp_path: Path, sent: bytes) -> None:
        path = tmp_path / "sent"
        path.write_bytes(sent)
        with pytest.raises(ConfigError, match="no gzip of 32 x 24"):
            unpacked(path, SHAPE)

    def test_a_bomb_is_not_unpacked(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        most: list[int] = []
        real = zlib.decompressobj

        class Watched:
            def __init__(self, bits: int) -> None:
                self._real = real(bits)

            def decompress(self, data: bytes, length: int) -> bytes:
                found = self._real.decompress(data, length)
                most.append(len(found))
                return found

            @property
            def eof(self) -> bool:
                return self._real.eof

        monkeypatch.setattr("tangible_ui.maker.label_files.zlib.decompressobj", Watched)
        path = tmp_path / "sent"
        path.write_bytes(gzip.compress(bytes(10_000_000)))
        with pytest.raises(ConfigError, match="send them again"):
            unpacked(path, SHAPE)
        assert max(most) <= 2 * SHAPE[0] * SHAPE[1] + 1


class TestNumbers:
    def test_parts_are_numbered_by_their_first_pixels(self) -> None:
        labels = np.array([[7, 7, 3], [7, 3, 3], [5, 5, 3]])
        numbers = np.array([[0, 0, 1], [0, 1, 1], [2, 2, 1]], np.int32)
        told = [{"label": 7, "name": "wall"}, {"label": 3, "height_m": 0.002, "name": ""}, {"label": 5, "name": None}]
        choices, found = numbered(told, [7, 3, 5], numbers)
        assert choices == {0: {"name": "wall"}, 1: {"height_m": 0.002}, 2: {}}
        assert found == {"7": [0], "3": [1], "5": [2]}
        assert labels.shape == numbers.shape

    def test_a_label_in_pieces_keeps_its_name_where_it_is_largest(self) -> None:
        numbers = np.array([[0, 1, 2, 2, 1, 3]], np.int32)
        told = [{"label": 7, "name": "leaf", "material": "wood"}, {"label": 8, "name": "leaf 2"}]
        choices, found = numbered(told, [7, 8, 7, 7], numbers)
        assert choices[2] == {"name": "leaf", "material": "wood"}
        assert choices[0] == {"name": "leaf 3", "material": "wood"}
        assert choices[3] == {"name": "leaf 4", "material": "wood"}
        assert found == {"7": [0, 2, 3], "8": [1]}

    @pytest.mark.parametrize(
        ("told", "says"),
        [
            ([{"label": 9, "name": "gone"}], "no pixel"),
            ([{"label": 7}, {"label": 7}], "told of twice"),
            ([{"name": "wall"}], "number of its label"),
            ([{"label": "7"}], "number of its label"),
        ],
    )
    def test_what_is_told_of_no_label_is_refused(self, told: list[dict[str, Any]], says: str) -> None:
        with pytest.raises(ConfigError, match=says):
            numbered(told, [7], np.zeros((1, 1), np.int32))


class TestText:
    def said(self, text: str, path: Path, parts: dict[int, Any], **heights: Any) -> str:
        return said_of_parts(text, path, path.parent / "parts.png", parts, heights or None, {"title": None})

    def test_parts_get_a_line_each_and_the_rest_stays(self, tmp_path: Path) -> None:
        parts = {0: {"name": "wall"}, 2: {"name": "hat", "height_m": 0.0042, "material": "glass"}, 3: {}}
        found = self.said(TEXT, tmp_path / "mine.yaml", parts, by="given")
        assert found == TEXT.replace("photo: mine.png", "photo: mine.png, segments: parts.png") + (
            "heights: {by: given}\nparts:\n  0: wall\n  2: {name: hat, height_m: 0.0042, material: glass}\n"
        )

    def test_comments_beside_parts_stay(self, tmp_path: Path) -> None:
        text = "scene: {photo: a.png}\nparts:\n  0: wall  # grey\n  1: hat\n  4: gone\n# the end\n"
        found = self.said(text, tmp_path / "mine.yaml", {0: {"name": "wall"}, 1: {"name": "cap"}, 2: {"name": "bag"}})
        assert "  0: wall  # grey\n  1: cap\n  2: bag\n# the end\n" in found

    def test_no_parts_leave_no_block(self, tmp_path: Path) -> None:
        text = "scene: {photo: a.png}\nparts:\n  0: wall\nwant: touch\n"
        assert self.said(text, tmp_path / "mine.yaml", {0: {}}) == (
            "scene: {photo: a.png, segments: parts.png}\nwant: touch\n"
        )

    def test_a_document_on_one_line_stays_one(self, tmp_path: Path) -> None:
        found = self.said("{scene: {photo: a.png}}", tmp_path / "mine.yaml", {0: {"name": "wall"}})
        assert found == "{scene: {photo: a.png, segments: parts.png}, parts: {0: wall}}"

    @pytest.mark.parametrize(
        "name", ["a: b", '"', "\\", "# no comment", "- x", "{}", "null", "007", "é ✂ 𝄞", "a\nb", "\x07", " a ", "&a *b"]
    )
    def test_every_name_comes_back(self, tmp_path: Path, name: str) -> None:
        from tangible_core.pipeline.editing import said

        path = tmp_path / "mine.yaml"
        found = self.said(TEXT, path, {0: {"name": name}, 1: {"name": name + "x", "height_m": 0.001}})
        assert said(found, path)["parts"] == {"0": name, "1": {"name": name + "x", "height_m": 0.001}}

    def test_a_great_many_parts_take_no_great_time(self, tmp_path: Path) -> None:
        path, many = tmp_path / "mine.yaml", {number: {"name": f"part {number}"} for number in range(600)}
        first = self.said(TEXT, path, many)
        assert first.count("\n  ") == 600
        renamed = {number: {"name": f"piece {number}"} for number in many}
        assert "  599: piece 599\n" in self.said(first, path, renamed)

    def test_a_built_in_scene_becomes_its_files(self, tmp_path: Path) -> None:
        from tangible_core.pipeline.editing import said

        path = tmp_path / "mine.yaml"
        scene = said(self.said("scene: builtin/motorcycle\n", path, {}), path)["scene"]
        assert Path(scene["left"]).is_file()
        assert (scene["focal_px"], scene["segments"]) == (994.978, "parts.png")
        with pytest.raises(ConfigError, match="builtin/nothing"):
            self.said("scene: builtin/nothing\n", path, {})


def test_of_asks_that_wait_the_newest_alone_is_done() -> None:
    async def check() -> None:
        newest, go, done = Newest(), asyncio.Event(), list[int]()

        async def work(number: int) -> int:
            await go.wait()
            done.append(number)
            return number

        asked = [asyncio.create_task(newest.do(lambda number=number: work(number))) for number in range(5)]
        await asyncio.sleep(0)
        go.set()
        assert await asyncio.gather(*asked) == [0, None, None, None, 4]
        assert done == [0, 4]

    asyncio.run(check())

"""If one of these fails, a file with more than one picture in it loses a view, a depth or its marks for no data."""

import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from phone_photos import PHOTO, RAMP, dynamic, gdepth, iphone, jpeg, segment, write_mpo
from tangible_core import Scene
from tangible_core.data.pictures import to_grey
from tangible_core.errors import PictureError, Stopped
from tangible_core.scene.formats.pictures import read_picture

RNG = np.random.default_rng(0)
LEFT = np.repeat(RNG.integers(0, 255, (6, 8, 1), dtype=np.uint8), 3, axis=2)
RIGHT = np.ascontiguousarray(LEFT[:, ::-1])


class TestSeveralPictures:
    @pytest.mark.parametrize("kind", ["TIFF", "GIF", "PNG", "WEBP"])
    def test_file_of_several_pictures_gives_the_first_with_a_note(self, tmp_path: Path, kind: str):
        path = tmp_path / f"several.{kind.lower()}"
        options = {"lossless": True} if kind == "WEBP" else {}
        first, *others = (Image.fromarray(each) for each in (LEFT, RIGHT, RIGHT // 2))
        first.save(path, format=kind, save_all=True, append_images=others, **options)
        scene = Scene.photo(path)
        np.testing.assert_array_equal(scene.views.left, LEFT)
        assert scene.notes == (f"several.{kind.lower()} holds 3 pictures, of which the first is taken",)

    @pytest.mark.parametrize(("kind", "pages"), [(1, 1), (4, 1), (5, 1), (2, 2)])
    def test_smaller_copies_and_masks_of_a_page_are_not_counted(self, tmp_path: Path, kind: int, pages: int):
        """Bits of TIFF 6.0, NewSubfileType: 1 a smaller copy, 4 a mask; 2 is a page of several."""
        page, other = (Image.fromarray(each) for each in (LEFT, LEFT[::2, ::2]))
        tags = TiffImagePlugin.ImageFileDirectory_v2()
        tags[254] = kind
        other.encoderinfo = {"tiffinfo": tags}
        page.save(tmp_path / "two.tif", save_all=True, append_images=[other])
        assert len(Scene.photo(tmp_path / "two.tif").notes) == pages - 1

    def test_stop_while_a_picture_is_read_is_no_damage(self, tmp_path: Path):
        def stop(_: str) -> None:
            raise Stopped

        Image.fromarray(LEFT).save(tmp_path / "two.gif", save_all=True, append_images=[Image.fromarray(RIGHT)])
        with pytest.raises(Stopped):
            read_picture(tmp_path / "two.gif", notify=stop)


class TestPairs:
    @pytest.mark.parametrize(
        ("layout", "whole"),
        [
            (None, np.hstack([LEFT, RIGHT])),
            ("side-by-side", np.hstack([LEFT, LEFT[:, :1], RIGHT])),
            ("cross-eyed", np.hstack([RIGHT, LEFT])),
            ("top-bottom", np.vstack([LEFT, RIGHT])),
            ("bottom-top", np.vstack([RIGHT, LEFT[:1], LEFT])),
        ],
    )
    def test_halves_of_a_picture_are_the_views(self, tmp_path: Path, layout, whole):
        Image.fromarray(whole).save(tmp_path / "both.png")
        for given in (whole, tmp_path / "both.png"):
            views = Scene.pair(given, layout=layout).views
            np.testing.assert_array_equal(views.left, LEFT)
            np.testing.assert_array_equal(views.right, RIGHT)

    @pytest.mark.parametrize(
        ("layout", "flags", "order", "stack"),
        [
            (0, 0, [RIGHT, LEFT], np.hstack),
            (2, 0, [RIGHT, LEFT], np.hstack),
            (2, 4, [LEFT, RIGHT], np.hstack),
            (3, 0, [RIGHT, LEFT], np.vstack),
            (3, 4, [LEFT, RIGHT], np.vstack),
            (3, 5, [LEFT, RIGHT], np.vstack),
        ],
    )
    def test_descriptor_states_where_the_left_view_lies(self, tmp_path: Path, layout: int, flags: int, order, stack):
        """VRex's descriptor: a separation, flags (4: left field first), the layout (3: over-under), 1 for stereo."""
        data = jpeg(stack([np.kron(view, np.ones((16, 16, 1), np.uint8)) for view in order]))
        state = b"_JPSJPS_\0\4" + bytes([0, flags, layout, 1]) + b"\0\0"
        stated = segment(state, 0xE3) if layout else b""
        (tmp_path / "pair.jps").write_bytes(data[:2] + stated + data[2:])
        scene = Scene.pair(tmp_path / "pair.jps")
        assert np.abs(scene.views.left[8::16, 8::16].astype(int) - LEFT).max() < 12
        assert np.abs(scene.views.right[8::16, 8::16].astype(int) - RIGHT).max() < 12
        assert [note for note in scene.notes if "squeezed" in note] == (
            ["pair.jps states that its views were squeezed to half their size, which they keep"] if flags & 3 else []
        )

    @pytest.mark.parametrize(
        ("layout", "kind", "message"),
        [(1, 1, "interleaved"), (4, 1, "an anaglyph"), (0, 0, "one view"), (2, 0, "one view")],
    )
    def test_file_without_two_halves_is_refused_unless_the_layout_is_given(
        self, tmp_path: Path, layout: int, kind: int, message: str
    ):
        data = jpeg(np.kron(LEFT, np.ones((16, 16, 1), np.uint8)))
        state = b"_JPSJPS_\0\4" + bytes([0, 4, layout, kind]) + b"\0\0"
        (tmp_path / "pair.jps").write_bytes(data[:2] + segment(state, 0xE3) + data[2:])
        with pytest.raises(PictureError, match=message):
            Scene.pair(tmp_path / "pair.jps")
        assert Scene.pair(tmp_path / "pair.jps", layout="side-by-side").views.shape == (96, 64)

    @pytest.mark.parametrize("kind", [0x020002, 0x000000, 0x010001, 0x030000])
    def test_mpo_file_gives_two_views_or_one_photo(self, tmp_path: Path, kind: int):
        """A pair, undefined, a large thumbnail, a primary picture: an editor that knows no pairs writes any of them."""
        shades = [np.full((32, 48, 3), each, np.uint8) for each in (40, 200)]
        write_mpo(tmp_path / "pair.mpo", shades, kind)
        views = Scene.pair(tmp_path / "pair.mpo").views
        assert (views.left[0, 0, 0], views.right[0, 0, 0]) == (40, 200)
        photo = Scene.photo(tmp_path / "pair.mpo")
        assert photo.views.left[0, 0, 0] == 40
        assert "`stereo:`" in photo.notes[0]

    @pytest.mark.parametrize("kind", [0x000000, 0x010001])
    def test_thumbnail_is_neither_view_nor_note(self, tmp_path: Path, kind: int):
        pictures = [np.full((32, 48, 3), 40, np.uint8), np.full((16, 24, 3), 200, np.uint8)]
        for name in ("phone.jpg", "phone.mpo"):
            write_mpo(tmp_path / name, pictures, kind)
            assert Scene.photo(tmp_path / name).notes == ()
        assert Scene.pair(tmp_path / "phone.jpg").views.shape == (32, 24)
        with pytest.raises(PictureError, match=r"phone\.mpo: holds one view, not a pair; write `photo:`"):
            Scene.pair(tmp_path / "phone.mpo")
        assert Scene.pair(tmp_path / "phone.mpo", layout="top-bottom").views.shape == (16, 48)


class TestOneForBoth:
    """What one view states about its camera or its numbers holds for both."""

    @pytest.mark.parametrize("orientation", [2, 3, 4, 6, 8])
    @pytest.mark.parametrize("stating", ["left", "right"])
    def test_view_without_orientation_is_turned_as_the_other_one_is(
        self, tmp_path: Path, orientation: int, stating: str
    ):
        """Turn pictures as TIFF 6.0 defines the orientations: the row and column of the stored ones, upright."""
        turned = {
            2: lambda view: view[:, ::-1],
            3: lambda view: view[::-1, ::-1],
            4: lambda view: view[::-1],
            6: lambda view: np.rot90(view, -1),
            8: lambda view: np.rot90(view, 1),
        }[orientation]
        exif = Image.Exif()
        exif[0x0112] = orientation
        for name, view in (("left", LEFT), ("right", RIGHT)):
            options = {"exif": exif} if name == stating else {}
            Image.fromarray(view).save(tmp_path / f"{name}.png", **options)
        scene = Scene.pair(tmp_path / "left.png", tmp_path / "right.png")
        np.testing.assert_array_equal(scene.views.left, turned(LEFT))
        np.testing.assert_array_equal(scene.views.right, turned(RIGHT))
        [other] = {"left", "right"} - {stating}
        assert scene.notes == (f"{other}.png is turned by the orientation that {stating}.png states",)

    @pytest.mark.parametrize("number", [float, np.int64])
    def test_white_of_the_lighter_view_is_that_of_the_darker_one(self, tmp_path: Path, number: type):
        """The left view reaches 200, the right one 3 in floats, 30,000 and 3 in whole numbers: not stretched."""
        lightest = 200 if number is float else 30_000
        left, right = np.array([[0, lightest]], number), np.array([[3, 0]], number)
        white = 255 if number is float else 65535
        np.save(tmp_path / "left.npy", left)
        np.save(tmp_path / "right.npy", right)
        for pair in ((left, right), (tmp_path / "left.npy", tmp_path / "right.npy")):
            views = Scene.pair(*pair).views
            assert to_grey(views.left) == pytest.approx(left / white)
            assert to_grey(views.right) == pytest.approx(right / white)


class TestPhoneDepth:
    @pytest.mark.parametrize("write", [gdepth, dynamic, iphone])
    def test_phone_depth_becomes_the_disparity_of_the_scene(self, tmp_path: Path, write):
        (tmp_path / "portrait.jpg").write_bytes(write(jpeg(RAMP)))
        scene = Scene.photo(tmp_path / "portrait.jpg")
        assert scene.disparity is not None and scene.disparity.unit == "relative"
        near = scene.disparity.disparity_px
        assert near.shape == (24, 32)
        np.testing.assert_allclose(near[12], np.clip(1 - (np.arange(32) + 0.5 - 1) / 30, 0, 1), atol=0.03)
        [note] = scene.notes
        assert note.startswith("portrait.jpg holds a depth map of 16 x 12 (")
        assert note.endswith("which is used; `photo_depth: false` leaves it out")

    @pytest.mark.parametrize("pads", [(0, 0), (5, 0), (0, 7), (3, 4)])
    def test_padding_behind_the_items_of_a_container_is_no_part_of_the_depth(self, tmp_path: Path, pads):
        """Pad the depth and what follows it; with the wrong place the depth is no picture."""
        (tmp_path / "portrait.jpg").write_bytes(dynamic(jpeg(RAMP), *pads))
        scene = Scene.photo(tmp_path / "portrait.jpg")
        assert scene.disparity is not None
        assert scene.notes[0].startswith("portrait.jpg holds a depth map of 16 x 12 (Dynamic Depth)")

    @pytest.mark.parametrize(
        "broken", [gdepth(b"no picture"), gdepth(jpeg(RAMP)).replace(b"A" * 32 + b"\0\0", b"A" * 32 + b"\xff\0")]
    )
    def test_damaged_phone_depth_gives_a_note_and_the_photo(self, tmp_path: Path, broken: bytes):
        (tmp_path / "portrait.jpg").write_bytes(broken)
        scene = Scene.photo(tmp_path / "portrait.jpg")
        assert scene.disparity is None
        np.testing.assert_array_equal(scene.views.left, PHOTO)
        assert scene.notes[0].startswith("the depth map in portrait.jpg is damaged and left out: ")

    @pytest.mark.parametrize("text", [b"<Container:Item ", b'GDepth:Data="', b"GDepth:Data=" + 99 * b" "])
    def test_hostile_metadata_is_searched_in_bounded_time(self, tmp_path: Path, text: bytes):
        """Read ten megabytes of unfinished beginnings, from each of which a naive pattern would search to the end."""
        content = text * (10_000_000 // len(text))
        parts = [(at, content[at : at + 65_000]) for at in range(0, len(content), 65_000)]
        head = b"http://ns.adobe.com/xmp/extension/\0" + b"A" * 32
        xmp = [segment(head + struct.pack(">II", len(content), at) + part) for at, part in parts]
        data = jpeg(PHOTO)
        (tmp_path / "portrait.jpg").write_bytes(data[:2] + b"".join(xmp) + data[2:])
        assert Scene.photo(tmp_path / "portrait.jpg").disparity is None

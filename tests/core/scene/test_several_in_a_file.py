"""Files with more in them than one picture: pages, both views of a pair, a phone's depth, a value for no data."""

import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from phone_photos import PHOTO, RAMP, dynamic, gdepth, iphone, jpeg, segment, write_mpo
from tangible_core import Scene
from tangible_core.data import Views
from tangible_core.data.pictures import to_grey
from tangible_core.errors import PictureError, Stopped
from tangible_core.scene.formats import decoding
from tangible_core.scene.formats.pictures import read_map, read_picture
from tangible_core.scene.formats.tiff import tiff_picture
from tangible_depth.search.pairs import grey_pair

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

    def test_file_of_one_picture_gives_no_note(self, tmp_path: Path):
        Image.fromarray(LEFT).save(tmp_path / "one.png")
        assert Scene.photo(tmp_path / "one.png").notes == ()


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
        ("state", "order"),
        [
            (b"", [RIGHT, LEFT]),
            (b"_JPSJPS_\0\4\0\0\2\1\0\0", [RIGHT, LEFT]),
            (b"_JPSJPS_\0\4\0\4\2\1\0\0", [LEFT, RIGHT]),
        ],
        ids=["nothing", "right first", "left first"],
    )
    def test_jps_file_states_the_order_of_its_halves(self, tmp_path: Path, state: bytes, order):
        data = jpeg(np.hstack([np.kron(each, np.ones((16, 16, 1), np.uint8)) for each in order]))
        (tmp_path / "pair.jps").write_bytes(data[:2] + (segment(state, 0xE3) if state else b"") + data[2:])
        views = Scene.pair(tmp_path / "pair.jps").views
        assert np.abs(views.left[8::16, 8::16].astype(int) - LEFT).max() < 12
        assert np.abs(views.right[8::16, 8::16].astype(int) - RIGHT).max() < 12

    @pytest.mark.parametrize(
        ("layout", "flags", "order", "stack"),
        [
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
        (tmp_path / "pair.jps").write_bytes(data[:2] + segment(state, 0xE3) + data[2:])
        scene = Scene.pair(tmp_path / "pair.jps")
        assert np.abs(scene.views.left[8::16, 8::16].astype(int) - LEFT).max() < 12
        assert np.abs(scene.views.right[8::16, 8::16].astype(int) - RIGHT).max() < 12
        assert [note for note in scene.notes if "squeezed" in note] == (
            ["pair.jps states that its views were squeezed to half their size, which they keep"] if flags & 3 else []
        )

    @pytest.mark.parametrize(
        ("layout", "kind", "message"),
        [
            (1, 1, "interleaved"),
            (4, 1, "an anaglyph"),
            (0, 0, "holds one view, not a pair; write `photo:`"),
            (2, 0, "holds one view, not a pair; write `photo:`"),
        ],
        ids=["interleaved", "anaglyph", "mono for both eyes", "mono for the right eye"],
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

    def test_mpo_file_gives_two_views_or_one_photo(self, tmp_path: Path):
        shades = [np.full((32, 48, 3), each, np.uint8) for each in (40, 200)]
        write_mpo(tmp_path / "pair.mpo", shades, 0x020002)
        views = Scene.pair(tmp_path / "pair.mpo").views
        assert (views.left[0, 0, 0], views.right[0, 0, 0]) == (40, 200)
        photo = Scene.photo(tmp_path / "pair.mpo")
        assert photo.views.left[0, 0, 0] == 40
        assert photo.notes == (
            "pair.mpo holds 2 pictures, of which the first is taken; for both views write `stereo:`",
        )

    @pytest.mark.parametrize("kind", [0x000000, 0x010001, 0x030000])
    def test_pictures_of_one_size_are_a_pair_whatever_their_type(self, tmp_path: Path, kind: int):
        """Undefined, a large thumbnail, a primary picture: an editor that knows no pairs writes any of them."""
        shades = [np.full((32, 48, 3), shade, np.uint8) for shade in (40, 200)]
        write_mpo(tmp_path / "pair.mpo", shades, kind)
        views = Scene.pair(tmp_path / "pair.mpo").views
        assert views.shape == views.right.shape[:2] == (32, 48)
        assert (views.left[20, 10, 0], views.right[20, 10, 0]) == (40, 200)
        assert Scene.photo(tmp_path / "pair.mpo").views.left[0, 0, 0] == 40

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

    def test_gain_map_as_large_as_the_photo_is_no_view(self, tmp_path: Path):
        write_mpo(tmp_path / "plain.jpg", [np.full((32, 48, 3), shade, np.uint8) for shade in (40, 200)], 0)
        data = (tmp_path / "plain.jpg").read_bytes()
        start = data.rindex(b"\xff\xd8\xff")
        xmp = segment(b'http://ns.adobe.com/xap/1.0/\0<x xmlns:hdrgm="http://ns.adobe.com/hdr-gain-map/1.0/"/>')
        (tmp_path / "phone.jpg").write_bytes(data[: start + 2] + xmp + data[start + 2 :])
        assert Scene.photo(tmp_path / "phone.jpg").notes == ()
        assert len(Scene.photo(tmp_path / "plain.jpg").notes) == 1

    def test_both_views_are_cropped_alike(self):
        views = Scene.pair(np.hstack([LEFT, RIGHT]), crop=[1, 2, 3, 4]).views
        np.testing.assert_array_equal(views.left, LEFT[2:6, 1:4])
        np.testing.assert_array_equal(views.right, RIGHT[2:6, 1:4])

    def test_column_without_halves_is_refused(self):
        with pytest.raises(PictureError, match="1 x 6 pixels have no two halves; give left and right"):
            Scene.pair(LEFT[:, :1])


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

    def test_view_that_states_to_be_upright_or_is_so_by_its_size_is_left_alone(self, tmp_path: Path):
        for stored, stated in ((LEFT, 1), (np.rot90(LEFT), None)):
            for name, view, orientation in (("left", LEFT, 3 if stated else 6), ("right", stored, stated)):
                exif = Image.Exif()
                if orientation:
                    exif[0x0112] = orientation
                Image.fromarray(view).save(tmp_path / f"{name}.png", exif=exif)
            scene = Scene.pair(tmp_path / "left.png", tmp_path / "right.png")
            np.testing.assert_array_equal(scene.views.right, stored)
            assert scene.notes == ()

    def test_second_view_of_an_mpo_file_is_turned_as_the_first_one_is(self, tmp_path: Path):
        exif = Image.Exif()
        exif[0x0112] = 6
        shades = [np.full((32, 48, 3), shade, np.uint8) for shade in (40, 200)]
        first, other = map(Image.fromarray, shades)
        first.save(tmp_path / "pair.mpo", format="MPO", save_all=True, append_images=[other], exif=exif)
        views = Scene.pair(tmp_path / "pair.mpo").views
        assert views.shape == views.right.shape[:2] == (48, 32)

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

    def test_views_of_one_white_keep_their_numbers(self):
        left, right = np.array([[0, 0.25]]), np.array([[0.5, 1]])
        views = Scene.pair(left, right).views
        assert (views.left.tolist(), views.right.tolist()) == (left.tolist(), right.tolist())

    @pytest.mark.parametrize("other", ["uint16", "grey", "transparent"])
    def test_views_of_other_depth_or_channels_give_the_same_grey_values(self, tmp_path: Path, other: str):
        grey = np.ascontiguousarray(RIGHT[..., 0])
        stored = {
            "uint16": grey.astype(np.uint16) * 257,
            "grey": grey,
            "transparent": np.dstack([RIGHT, np.full_like(grey, 255)]),
        }[other]
        Image.fromarray(LEFT).save(tmp_path / "left.png")
        Image.fromarray(stored).save(tmp_path / "right.png")
        found = grey_pair(Scene.pair(tmp_path / "left.png", tmp_path / "right.png").views, "test")
        same = grey_pair(Scene.pair(LEFT, RIGHT).views, "test")
        assert np.array_equal(found.left, same.left)
        assert np.array_equal(found.right, same.right)

    def test_twelve_bits_beside_eight_keep_their_levels(self):
        """A sixteenth of white in 16 bits is all that a camera of 12 bits writes; beside 8 bits it stays fine."""
        grey = np.arange(256, dtype=np.uint8).reshape(16, 16)
        found = grey_pair(Views(grey.astype(np.uint16) * 16, grey), "test")
        assert np.abs(found.left - grey.astype(int)).max() <= 1 and np.unique(found.left).size > 250
        assert np.array_equal(found.right, grey)


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

    @pytest.mark.parametrize("write", [gdepth, dynamic, iphone])
    def test_phone_depth_is_found_in_a_photo_that_is_reduced(self, tmp_path: Path, monkeypatch, write):
        """Read a photo of 768 pixels where 500 are the most, for this program and for Pillow, which fails at twice."""
        (tmp_path / "portrait.jpg").write_bytes(write(jpeg(RAMP)))
        monkeypatch.setattr(decoding, "MOST_PIXELS", 500)
        monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 300)
        scene = Scene.photo(tmp_path / "portrait.jpg")
        assert scene.disparity is not None
        near = scene.disparity.disparity_px
        assert near.shape == (12, 16)
        np.testing.assert_allclose(near[6], np.linspace(1, 0, 16), atol=0.03)
        assert [note.split(" ")[1] for note in scene.notes] == ["has", "holds"]

    def test_phone_depth_can_be_left_out_or_replaced(self, tmp_path: Path):
        (tmp_path / "portrait.jpg").write_bytes(gdepth(jpeg(RAMP)))
        assert Scene.photo(tmp_path / "portrait.jpg", photo_depth=False).disparity is None
        given = Scene.photo(tmp_path / "portrait.jpg", disparity=np.ones((24, 32))).disparity
        assert given.unit == "px"

    def test_phone_depth_is_rotated_with_the_photo(self, tmp_path: Path):
        exif = Image.Exif()
        exif[0x0112] = 6
        data = gdepth(jpeg(RAMP))
        upright = jpeg(PHOTO, exif=exif)
        (tmp_path / "portrait.jpg").write_bytes(upright[:2] + data[2 : data.index(b"\xff\xe0")] + upright[2:])
        scene = Scene.photo(tmp_path / "portrait.jpg", rotate=180)
        near = scene.disparity.disparity_px
        assert near.shape == scene.views.shape == (32, 24)
        assert near[0].max() < 0.1 and near[-1].min() > 0.9

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


class TestNoData:
    @pytest.mark.parametrize("mode", ["float32", "int16"])
    def test_geotiff_nodata_becomes_unknown_with_a_note(self, tmp_path: Path, mode: str):
        heights = np.arange(12, dtype=mode).reshape(3, 4)
        heights[1, 2] = -9999
        tags = TiffImagePlugin.ImageFileDirectory_v2()
        tags[42113] = "-9999"
        Image.fromarray(heights).save(tmp_path / "dem.tif", tiffinfo=tags)
        scene = Scene.heights(tmp_path / "dem.tif")
        assert np.argwhere(np.isnan(scene.height)).tolist() == [[1, 2]]
        assert scene.notes == ("8.3 % of dem.tif is -9999, its value for no data",)
        assert scene.brings(0.08, 0.02)["relief"].height_m.max() == np.float32(0.02)

    @pytest.mark.parametrize(("text", "number"), [("-3.4028234663852886e+38", -3.4028234663852886e38), ("n/a", None)])
    def test_geotiff_nodata_is_read_from_a_text(self, tmp_path: Path, text: str, number: float | None):
        tags = TiffImagePlugin.ImageFileDirectory_v2()
        tags[42113] = text
        Image.fromarray(np.zeros((2, 2), np.float32)).save(tmp_path / "dem.tif", tiffinfo=tags)
        data = (tmp_path / "dem.tif").read_bytes()
        with tiff_picture(data) as picture:
            assert picture is not None and picture.nodata == number

    def test_geotiff_nodata_that_no_height_has_gives_no_note(self, tmp_path: Path):
        tags = TiffImagePlugin.ImageFileDirectory_v2()
        tags[42113] = "nan"
        Image.fromarray(np.ones((2, 2), np.float32)).save(tmp_path / "dem.tif", tiffinfo=tags)
        notes = []
        assert read_map(tmp_path / "dem.tif", notes.append).min() == 1
        assert notes == []

"""If one of these fails, a second picture or a depth map in a file is missed or taken for something else."""

import struct
from base64 import b64encode
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

from phone_photos import PHOTO, RAMP, dynamic, gdepth, iphone, jpeg, segment, write_mpo
from tangible_core import Pipeline, Scene, Workspace
from tangible_core.data import Calibration
from tangible_core.data.pictures import to_grey
from tangible_core.errors import ConfigError, PictureError, Stopped
from tangible_core.scene.formats.pictures import read_picture
from tangible_core.scene.workspace import kind_of

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


GREY = np.full((3, 4), 90, np.uint8)
MILLIMETRES = np.array([[0, 500, 1000, 2000], [4000, 8000, 65535, 1], [800, 900, 1600, 3200]], np.uint16)
NAN = np.nan


def stored(folder: Path, values: np.ndarray) -> Path:
    Image.fromarray(values).save(folder / "map.png")
    return folder / "map.png"


class TestDisparity:
    @pytest.mark.parametrize("in_file", [True, False])
    def test_scale_and_zero_are_those_of_kitti(self, tmp_path: Path, in_file: bool):
        values = np.array([[0, 256, 128, 640], [1, 2560, 25600, 65535], [0, 0, 512, 768]], np.uint16)
        scene = Scene.photo(GREY, disparity=stored(tmp_path, values) if in_file else values, disparity_scale=256)
        expected = [[NAN, 1, 0.5, 2.5], [1 / 256, 10, 100, 65535 / 256], [NAN, NAN, 2, 3]]
        np.testing.assert_array_equal(scene.disparity.disparity_px, np.float32(expected))

    def test_scale_of_one_and_a_number_for_no_data_make_values_unknown(self, tmp_path: Path):
        values = np.array([[0.0, -1, 2.5, np.inf]] * 3)
        known = Scene.photo(GREY, disparity=values, disparity_scale=1).disparity.disparity_px
        np.testing.assert_array_equal(known[0], np.float32([NAN, NAN, 2.5, NAN]))
        plain = Scene.photo(GREY, disparity=values).disparity.disparity_px
        np.testing.assert_array_equal(plain[0], np.float32([0, -1, 2.5, NAN]))
        values = np.array([[0, 256, 65535, 512]] * 3, np.uint16)
        for nodata, row in ((65535, [NAN, 1, NAN, 2]), ([65535, 256], [NAN, NAN, NAN, 2])):
            scene = Scene.photo(GREY, disparity=stored(tmp_path, values), disparity_scale=256, nodata=nodata)
            np.testing.assert_array_equal(scene.disparity.disparity_px[0], np.float32(row))


class TestDepth:
    @pytest.mark.parametrize("in_file", [True, False])
    def test_millimetres_are_nearer_where_they_are_fewer(self, tmp_path: Path, in_file: bool):
        scene = Scene.photo(GREY, depth=stored(tmp_path, MILLIMETRES) if in_file else MILLIMETRES, nodata=65535)
        depth_m = np.where(np.isin(MILLIMETRES, (0, 65535)), NAN, MILLIMETRES / 1000)
        np.testing.assert_allclose(scene.disparity.disparity_px, 1 / depth_m, rtol=1e-6)
        assert kind_of(scene) == "depth"

    def test_depth_is_bounded_linear_and_gives_the_disparity_of_a_pair(self):
        depth_mm = np.tile(np.linspace(500, 1500, 101), (40, 1))
        scene = Scene.photo(np.zeros((40, 101), np.uint8), depth=depth_mm)
        workspace = Workspace(relief_m=0.01, smooth_m=0)
        relief = {"by": "depth", "slope": 0, "grain_m": 0}
        heights = Pipeline(scene, workspace=workspace, relief=relief, cached=False).relief.height_m[20]
        np.testing.assert_allclose(heights[5:-5], (1500 - depth_mm[0, 5:-5]) / 1e5, atol=1e-4)
        depth_m = np.array([[1.0, 2, 4, 5]] * 3)
        camera = Calibration(1000, 0.1, 3)
        scene = Scene.pair(GREY, GREY, depth=depth_m, depth_unit_m=1, calibration=camera)
        np.testing.assert_allclose(scene.disparity.disparity_px[0], [97, 47, 22, 17], rtol=1e-6)
        scene = Scene.photo(GREY, depth=MILLIMETRES, near_m=0.6, far_m=2)
        near = 1 / scene.disparity.disparity_px
        np.testing.assert_allclose(near[0], [NAN, 0.6, 1, 2], rtol=1e-6)
        np.testing.assert_allclose(near[1], [2, 2, 2, 0.6], rtol=1e-6)
        for bound, column, distance_m in (({"near_m": 0.6}, 1, 0.6), ({"far_m": 1.5}, 3, 1.5)):
            alone = Scene.photo(GREY, depth=MILLIMETRES, **bound).disparity.disparity_px
            assert alone[0, column] == pytest.approx(1 / distance_m)

    @pytest.mark.parametrize(
        ("options", "sentence"),
        [
            ({"depth": MILLIMETRES, "disparity": MILLIMETRES}, "depth and disparity are two forms of one map"),
            ({"depth": MILLIMETRES, "near_m": 2, "far_m": 1}, "near_m is less than far_m"),
            ({"depth": MILLIMETRES, "far_m": np.inf}, "far_m: Input should be a finite number"),
            ({"near_m": 2}, "near_m needs depth"),
            ({"depth_unit_m": 2}, "depth_unit_m needs depth"),
            ({"disparity_scale": 2}, "disparity_scale needs disparity"),
            ({"nodata": 2}, "nodata needs height or depth or disparity"),
        ],
    )
    def test_options_that_do_not_fit_are_refused(self, options: dict[str, Any], sentence: str):
        with pytest.raises(ConfigError, match=sentence):
            Scene.photo(GREY, **options)


class TestPhones:
    RAMP = np.tile(np.linspace(0, 255, 16).astype(np.uint8), (12, 1))

    def photo(self, folder: Path, turn: int, depth_turn: int) -> Scene:
        """Return a photo of 24 x 32 with a depth map, near at the sensor's left; each with its EXIF orientation."""
        exif, own = Image.Exif(), Image.Exif()
        exif[0x0112], own[0x0112] = turn, depth_turn
        data, head = gdepth(jpeg(self.RAMP, exif=own)), jpeg(PHOTO, exif=exif)
        (folder / "portrait.jpg").write_bytes(head[:2] + data[2 : data.index(b"\xff\xe0")] + head[2:])
        return Scene.photo(folder / "portrait.jpg")

    @pytest.mark.parametrize("depth_turn", [1, 6])
    def test_depth_is_turned_once_whether_it_states_an_orientation_or_not(self, tmp_path: Path, depth_turn: int):
        near = self.photo(tmp_path, 6, depth_turn).disparity.disparity_px
        assert near.shape == (32, 24)
        assert near[0].min() > 0.9 and near[-1].max() < 0.1  # the sensor's left edge is the upper one

    def test_depths_that_are_stored_linearly_become_nearness(self, tmp_path: Path):
        """From 1 to 9 m; half of the way, 5 m, is (1/5 - 1/9) / (1 - 1/9) = 1/10 near, and not 1/2."""
        text = b'<x GDepth:Format="RangeLinear" GDepth:Near="1" GDepth:Far="9" GDepth:Data="'
        photo = jpeg(PHOTO, text + b64encode(jpeg(np.full((12, 16), 127, np.uint8))) + b'"/>')
        (tmp_path / "portrait.jpg").write_bytes(photo)
        near = Scene.photo(tmp_path / "portrait.jpg").disparity.disparity_px
        np.testing.assert_allclose(near, 0.1, atol=0.005)

"""Videos as scenes: files and folders, in order and by time, and their faults."""

import struct
import wave
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
import tifffile
from PIL import Image
from pydantic import ValidationError

from pictures import write_png
from tangible_core import Pipeline, Scene
from tangible_core.errors import ConfigError, PictureError
from tangible_core.files import reading
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.rig import Camera, StereoRig
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.video import readers as video_readers
from tangible_core.scene.workspace import kind_of
from tangible_depth.semi_global import SemiGlobal
from videos import Played, grey, greys, jpegs, shown, write_video


@pytest.fixture
def film(tmp_path: Path) -> Path:
    """A file of ten frames, 25 a second."""
    return greys(tmp_path / "film.avi", 10)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of twelve pictures whose names do not sort as their numbers, and two other files."""
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    for number in range(12):
        write_png(pictures / f"f{number}.png", grey(number))
    (pictures / "notes.txt").write_text("none")
    (pictures / "._f0.png").write_bytes(b"none")
    return pictures


def play(monkeypatch: pytest.MonkeyPatch, *captures: Played, repeat: bool = False, **options) -> Scene:
    """Return the scene of a file that opens as these captures, in turn; the first is for the scene."""
    opened = iter(captures)
    monkeypatch.setattr(video_readers, "open_file", lambda path: next(opened))
    return Scene.video("film.avi", repeat=repeat, **options)


class TestScene:
    def test_scene_of_a_video_shows_its_first_frame(self, tmp_path: Path):
        colours = np.zeros((24, 32, 3), np.uint8)
        colours[:] = 20, 60, 200  # blue, green, red
        path = write_video(tmp_path / "film.avi", [colours, *map(grey, range(4))])
        scene = Scene.video(path, segments=np.zeros((24, 32), np.int32))
        np.testing.assert_allclose(scene.views.left[5, 5], (200, 60, 20), atol=8)
        assert scene.views.left.dtype == np.uint8 and scene.views.right is None and scene.segments is not None
        assert scene.notes == ("film.avi is a video, of which this is the first of 5 frames; `tangible feel` plays it",)
        video = scene.frames
        assert (video.source, video.layout, video.fps, video.count) == (path, "mono", 25, 5)
        with video.open() as frames:
            np.testing.assert_array_equal(frames.next().views.left, scene.views.left)

    @pytest.mark.parametrize(
        ("layout", "whole"),
        [
            ("side-by-side", [1, 0, 9]),
            ("cross-eyed", [9, 0, 1]),
            ("top-bottom", [[1], [0], [9]]),
            ("bottom-top", [[9], [0], [1]]),
        ],
    )
    def test_frames_of_a_stereo_video_are_pairs(self, tmp_path: Path, layout: str, whole: list):
        halves = np.kron(np.array(whole), np.ones((15, 15))).astype(np.uint8)  # an odd number: the middle is left out
        for number, lighter in enumerate((1, 2)):
            write_png(tmp_path / f"{number}.png", 20 * halves * np.uint8(lighter))
        options = {"focal_px": 100.0, "baseline_m": 0.06}
        files = SceneFiles.model_validate({"video": tmp_path, "layout": layout, "crop": (2, 1, 10, 9), **options})
        scene = Scene.read(files, Path())
        assert kind_of(scene) == kind_of(files) == "depth"
        with scene.frames.open() as frames:
            first, second = frames.next().views, frames.next().views
        np.testing.assert_array_equal(first.left, scene.views.left)
        np.testing.assert_array_equal(first.right, scene.views.right)
        assert first.left.shape == (9, 10, 3) and first.calibration.focal_px == 100
        assert (first.left.max(), first.right.max()) == (20, 180) and second.left.max() == 40

    def test_frames_are_cropped_rotated_and_inverted_like_the_first(self, folder: Path):
        for each in folder.glob("f*.png"):
            write_png(each, np.arange(48, dtype=np.uint8).reshape(6, 8))
        scene = Scene.read(SceneFiles(video=folder, crop=(1, 2, 5, 3), rotate=90, invert=True), Path())
        with scene.frames.open() as frames:
            last = [frames.next() for _ in range(5)][-1]
        assert last.views.left.shape == (5, 3, 3)
        np.testing.assert_array_equal(last.views.left, scene.views.left)

    def test_rig_rectifies_every_frame_like_the_first(self, tmp_path: Path):
        lens = Camera(np.array([[100.0, 0, 40], [0, 100, 30], [0, 0, 1]]), np.array([-0.2, 0.05, 0, 0]))
        rig = StereoRig(lens, lens, np.eye(3), np.array([-0.1, 0.01, 0.0]))
        rng = np.random.default_rng(0)
        for number in range(2):
            write_png(tmp_path / f"{number}.png", rng.integers(0, 255, (60, 160, 3), np.uint8))
        scene = Scene.video(tmp_path, layout="side-by-side", rig=rig)
        with scene.frames.open() as frames:
            first, second = frames.next().views, frames.next().views
        np.testing.assert_array_equal(first.left, scene.views.left)
        np.testing.assert_array_equal(first.right, scene.views.right)
        assert first.calibration.focal_px == scene.views.calibration.focal_px and first.calibration.baseline_m > 0
        assert second.left.shape == first.left.shape
        assert np.any(second.left != first.left)

    def test_vertical_rig_turns_every_frame_upright(self, tmp_path: Path):
        lens = Camera(np.array([[100.0, 0, 40], [0, 100, 30], [0, 0, 1]]), np.zeros(0))
        rig = StereoRig(lens, lens, np.eye(3), np.array([0, -0.1, 0]))
        whole = np.random.default_rng(0).integers(0, 255, (60, 160, 3), np.uint8)
        write_png(tmp_path / "0.png", whole)
        scene = Scene.video(tmp_path, layout="side-by-side", rig=rig)
        with scene.frames.open() as frames:
            views = frames.next().views
        assert views.calibration.vertical and scene.views.calibration.vertical
        np.testing.assert_array_equal(views.left, whole[:, :80])
        np.testing.assert_array_equal(views.right, whole[:, 80:])

    def test_frames_of_other_depth_and_channels_show_the_same(self, tmp_path: Path):
        shades = np.arange(48, dtype=np.uint8).reshape(6, 8) * 5
        colours = np.dstack([shades] * 3)
        Image.fromarray(colours).save(tmp_path / "0.png")
        Image.fromarray(shades).save(tmp_path / "1.png")
        Image.fromarray(shades.astype(np.uint16) * 257).save(tmp_path / "2.png")
        write_png(tmp_path / "3.png", colours.astype(np.uint16) * 257)
        Image.fromarray(np.dstack([colours, np.full_like(shades, 255)])).save(tmp_path / "4.png")
        Image.fromarray(shades).convert("P").save(tmp_path / "5.png")
        with Scene.video(tmp_path, repeat=False).frames.open() as frames:
            shown = [frames.next().views.left for _ in range(6)]
        for left in shown:
            np.testing.assert_array_equal(left, colours)

    def test_first_frame_decides_white_and_orientation(self, tmp_path: Path):
        """Floats up to 200 and up to 2 in one film have one white, 255; only the first frame says how it was held."""
        bright, dark = np.full((4, 6), 200, np.float32), np.full((4, 6), 2, np.float32)
        exif = Image.Exif()
        exif[0x0112] = 6
        Image.fromarray(bright).save(tmp_path / "0.tif", exif=exif)
        Image.fromarray(dark).save(tmp_path / "1.tif")
        with Scene.video(tmp_path, repeat=False).frames.open() as frames:
            first, second = (frames.next().views.left for _ in range(2))
        assert first.shape == second.shape == (6, 4, 3)
        assert (first.max(), second.max()) == (200, 2)

    def test_whole_numbers_of_32_bits_have_one_white_in_a_film(self, tmp_path: Path):
        """Of 16 bits by the first frame; alone, the second one would pass for eight bits."""
        for number, value in enumerate((40_000, 200)):
            tifffile.imwrite(tmp_path / f"{number}.tif", np.full((4, 6), value, np.int32))
        with Scene.video(tmp_path, repeat=False).frames.open() as frames:
            first, second = (frames.next().views.left for _ in range(2))
        assert (first.max(), second.max()) == (round(40_000 / 257), round(200 / 257))


class TestFiles:
    def test_repeating_file_gives_frames_in_order_and_again(self, film: Path):
        with Scene.video(film).frames.open() as frames:
            read = [frames.next() for _ in range(23)]
        assert [each.number for each in read] == list(range(23))
        assert [shown(each.views) for each in read] == [number % 10 for number in range(23)]
        np.testing.assert_allclose([each.time_s for each in read], np.arange(23) / 25, atol=1e-9)

    def test_file_without_repeat_ends(self, film: Path):
        with Scene.video(film, repeat=False).frames.open() as frames:
            assert frames.at(60).number == 9, "the last frame is due for ever, and is not lost"
            assert frames.at_end is False or frames.at(61) is None
            assert frames.next() is None and frames.at(62) is None and frames.at_end

    def test_latest_due_frame_is_returned_once(self, film: Path):
        with Scene.video(film).frames.open() as frames:
            assert frames.at(0).number == 0
            assert frames.at(0.03) is None
            latest = frames.at(0.17)
            assert (latest.number, shown(latest.views), frames.skipped) == (4, 4, 3)
            assert frames.next().number == 5, "nothing beyond it was read"
            assert shown(frames.at(0.53).views) == 3, "the fourth of the second round"

    def test_requested_rate_replaces_the_time_stamps(self, film: Path):
        video = Scene.video(film, fps=5).frames
        with video.open() as frames:
            assert video.fps == frames.fps == 5
            assert frames.at(1.01).number == 5 and frames.next().time_s == pytest.approx(1.2)

    def test_uneven_frames_follow_their_time_stamps(self, monkeypatch: pytest.MonkeyPatch):
        """Play a recorded screen, in which a frame stands for seconds and must not be skipped."""
        times_s = [0.0, 0.033, 0.066, 2.0, 5.0, 5.033]
        pictures = [grey(number) for number in range(6)]
        with play(monkeypatch, *(Played(pictures, times_s) for _ in range(2))).frames.open() as frames:
            assert [shown(frames.at(time_s).views) for time_s in (1, 4, 5.01, 9)] == [2, 3, 4, 5]
            assert frames.skipped == 2

    @pytest.mark.parametrize("times_s", [[0] * 4, [0, -1, 1e9, float("nan")]], ids=["none", "nonsense"])
    def test_implausible_time_stamps_are_replaced_by_an_even_rate(self, monkeypatch: pytest.MonkeyPatch, times_s: list):
        captures = [Played([grey(number) for number in range(4)], times_s, fps=1e5) for _ in range(2)]
        with play(monkeypatch, *captures).frames.open() as frames:
            assert frames.fps == 30, "nor such a rate"
            np.testing.assert_allclose([frames.next().time_s for _ in range(4)], np.arange(4) / 30, atol=1e-9)

    def test_skipped_frames_are_not_converted(self, monkeypatch: pytest.MonkeyPatch):
        """Skip where the next frame is certainly due: by a requested rate, or after an even round."""
        pictures, times_s = [grey(number) for number in range(30)], [number / 30 for number in range(30)]
        captures = [Played(pictures, times_s) for _ in range(4)]
        with play(monkeypatch, captures[0], captures[1], fps=30).frames.open() as frames:
            assert frames.at(0.9).number == 27
        assert captures[1].retrieved[-1] == 27 and len(captures[1].retrieved) <= 2
        assert captures[1].released.is_set()
        with play(monkeypatch, *captures[:1], *captures[2:], repeat=True).frames.open() as frames:
            assert (frames.at(0.9).number, frames.at(1.9).number) == (27, 57)
        assert len(captures[2].retrieved) > 27 and len(captures[3].retrieved) <= 2

    def test_file_that_decodes_too_slowly_plays_more_slowly(self, monkeypatch: pytest.MonkeyPatch):
        """Skip for a tenth of a second only: catching up on everything would take longer at each call."""
        clock = iter(np.arange(0, 1e4, 0.04))
        monkeypatch.setattr(video_readers, "monotonic", lambda: float(next(clock)))
        captures = [
            Played([grey(number) for number in range(31)], [number / 30 for number in range(31)]) for _ in range(2)
        ]
        with play(monkeypatch, *captures).frames.open() as frames:
            first = frames.at(0.8)
            assert first.number < 5
            assert frames.at(0.8) is None
            assert frames.at(0.8 + 1.01 / 30).number == first.number + 1

    def test_phone_video_is_upright(self, tmp_path: Path):
        """Play a file that has the sensor's picture and the orientation of the phone."""
        lit = np.zeros((32, 64, 3), np.uint8)
        lit[:, 32:] = 255
        path = write_video(tmp_path / "phone.mp4", [lit] * 3, codec="mp4v")
        data = bytearray(path.read_bytes())
        upright, turned = ((1, 0, 0, 0, 1, 0, 0, 0, 0x4000), (0, 1, 0, -1, 0, 0, 0, 0, 0x4000))
        old, new = (struct.pack(">9i", *(each << 16 for each in matrix)) for matrix in (upright, turned))
        at = data.index(old, data.index(b"tkhd"))
        data[at : at + 36] = new
        path.write_bytes(data)
        left = Scene.video(path).views.left
        assert left.shape == (64, 32, 3)
        assert left[:24].max() < 60 and left[40:].min() > 190

    def test_frame_of_another_size_raises_once(self, monkeypatch: pytest.MonkeyPatch):
        captures = [Played([grey(0), grey(1), grey(2, (48, 32)), grey(3)]) for _ in range(2)]
        with play(monkeypatch, *captures).frames.open() as frames:
            frames.next(), frames.next()
            with pytest.raises(PictureError, match=r"film.avi: is 32 x 48 and the first frame 32 x 24; .* one size$"):
                frames.next()
            assert shown(frames.next().views) == 3, "the next call goes on behind it"

    def test_stream_that_changes_its_size_keeps_the_first_size(self, tmp_path: Path):
        """Play a stream whose other frames FFmpeg scales."""
        shapes = [(24, 32), (48, 64), (24, 32)]
        path = jpegs(tmp_path / "film.mjpeg", (grey(number, shape) for number, shape in enumerate(shapes)))
        with Scene.video(path).frames.open() as frames:
            read = [frames.next().views for _ in shapes]
        assert [shown(each) for each in read] == [0, 1, 2] and {each.shape for each in read} == {(24, 32)}

    def test_damaged_frame_raises_once_and_is_left_out(self, monkeypatch: pytest.MonkeyPatch):
        captures = [Played([grey(0), None, None, grey(3)]) for _ in range(2)]
        with play(monkeypatch, *captures).frames.open() as frames:
            assert frames.next().number == 0
            with pytest.raises(PictureError, match=r"film.avi: frame 1 is damaged and left out; copy"):
                frames.next()
            assert frames.next().number == 3 and frames.skipped == 2

    def test_file_of_only_damaged_frames_raises_at_every_call(self, monkeypatch: pytest.MonkeyPatch):
        captures = [Played([grey(0)]), *(Played([None, None]) for _ in range(3))]
        with play(monkeypatch, *captures, repeat=True).frames.open() as frames:
            for message in (
                "frame 0 is damaged",
                "none of its frames can be played",
                "none of its frames can be played",
            ):
                with pytest.raises(PictureError, match=message):
                    frames.next()

    def test_file_cut_short_raises_once_and_starts_again(self, tmp_path: Path, capfd: pytest.CaptureFixture[str]):
        path = write_video(tmp_path / "film.mkv", (grey(number) for number in range(30)), codec="mp4v")
        video = Scene.video(path).frames
        data = path.read_bytes()
        path.write_bytes(data[: len(data) // 2])
        with video.open() as frames:
            with pytest.raises(PictureError, match=r"film.mkv: is damaged or cut short after \d+ of 30 frames; copy"):
                for _ in range(30):
                    held = frames.next().number
            assert 3 < held < 29
            again = [shown(frames.next().views) for _ in range(2 * held + 2)]
        assert again[0] == 0 and again[held + 1] == 0, "and does not raise again"
        assert capfd.readouterr().err == "", "OpenCV and FFmpeg say nothing themselves"

    def test_file_that_disappears_is_read_again_when_it_is_back(self, film: Path):
        with Scene.video(film).frames.open() as frames:
            for _ in range(10):
                frames.next()
            film.rename(film.with_name("elsewhere.avi"))
            with pytest.raises(PictureError, match="there is no such file"):
                frames.next()
            film.with_name("elsewhere.avi").rename(film)
            assert (frames.next().number, shown(frames.next().views)) == (10, 1)


class TestFolders:
    def test_folder_gives_pictures_in_the_order_of_their_numbers(self, folder: Path):
        scene = Scene.video(folder, fps=10)
        assert scene.notes[0].startswith("pictures is a video, of which this is the first of 12 frames;")
        with scene.frames.open() as frames:
            assert [shown(frames.next().views) for _ in range(14)] == [*range(12), 0, 1]
            assert frames.fps == 10 and Scene.video(folder).frames.fps == 30

    def test_folder_reads_due_pictures_only(self, folder: Path, monkeypatch: pytest.MonkeyPatch):
        video = Scene.video(folder, repeat=False).frames
        read: list[str] = []
        whole = video_readers.read_stored
        monkeypatch.setattr(video_readers, "read_stored", lambda path: read.append(path.name) or whole(path))
        with video.open() as frames:
            assert [frames.at(number / 30).number for number in (0, 5)] == [0, 5]
            assert frames.at(0.19) is None and frames.skipped == 4
            assert frames.at(60).number == 11 and frames.at_end and frames.at(61) is None
        assert read == ["f0.png", "f5.png", "f11.png"]

    def test_folder_converts_every_picture_to_rgb_of_eight_bits(self, tmp_path: Path):
        deep = np.full((4, 6), 0x8080, np.uint16)
        cut_out = np.full((4, 6, 4), 90, np.uint8)
        cut_out[:, 3:] = 7, 7, 7, 0
        cut_out[:, :3, 3] = 255
        for number, values in enumerate((cut_out, deep, np.full((4, 6, 3), 9, np.uint8))):
            cv2.imwrite(str(tmp_path / f"{number}.png"), values)
        scene = Scene.video(tmp_path)
        with scene.frames.open() as frames:
            read = [frames.next().views.left for _ in range(3)]
        assert all(each.shape == (4, 6, 3) and each.dtype == np.uint8 for each in read)
        assert [int(each.min()) for each in read] == [90, 128, 9], "what is hidden looks like what is"
        np.testing.assert_array_equal(read[0], scene.views.left)
        np.testing.assert_array_equal(scene.shown, np.repeat([[True, False]], 4, 0).repeat(3, 1))

    def test_folder_reports_pictures_of_another_size_and_damaged_ones(self, folder: Path):
        write_png(folder / "f2.png", grey(2, (48, 32)))
        for number in (4, 5):
            (folder / f"f{number}.png").write_bytes((folder / "f0.png").read_bytes()[:45])
        with Scene.video(folder).frames.open() as frames:
            frames.next(), frames.next()
            with pytest.raises(PictureError, match=r"f2.png: is 32 x 48 and the first frame 32 x 24"):
                frames.next()
            assert frames.next().number == 3
            with pytest.raises(PictureError, match=r"f4.png: the picture is damaged or cut short"):
                frames.next()
            assert frames.next().number == 6, "a second damaged one does not raise"

    def test_folder_that_lost_its_pictures_raises_at_every_call(self, folder: Path):
        with Scene.video(folder).frames.open() as frames:
            for each in folder.glob("f*.png"):
                each.unlink()
            for message in ("f0.png: there is no such file", "none of its 12 pictures can be read", "none of its 12"):
                with pytest.raises(PictureError, match=message):
                    frames.next()


def silence(path: Path) -> None:
    with wave.open(str(path), "wb") as sound:
        sound.setnchannels(1), sound.setsampwidth(2), sound.setframerate(8000)
        sound.writeframes(bytes(16000))


BAD = {
    "no file": ("film.avi", lambda path: greys(path.with_name("film2.avi"), 2), "there is no such file or folder .did"),
    "no folder": ("gone/film.avi", lambda path: None, "there is no folder .*gone; check the path"),
    "text": ("film.avi", lambda path: path.write_text("no video\n" * 99), "is not a video that this program can play"),
    "empty": ("film.avi", lambda path: path.write_bytes(b""), "the file is empty; copy"),
    "sound": ("film.avi", silence, "is not a video that this program can play, or has no frames; convert it"),
    "a header": ("film.avi", lambda path: path.write_bytes(greys(path, 3).read_bytes()[:300]), "is not a video"),
    "a picture": ("film.png", lambda path: write_png(path, grey(1)), "is a picture, not a video; write `photo:`"),
    "empty folder": ("film", lambda path: path.mkdir(), "holds no picture; name a folder of pictures"),
    "a playlist": (
        "film.m3u8",
        lambda path: path.write_text("#EXTM3U\n#EXTINF:9,\nhttp://localhost:1/x.ts\n"),
        "is not a",
    ),
}


@pytest.mark.parametrize(("name", "make", "message"), BAD.values(), ids=BAD)
def test_unplayable_file_raises_one_line(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, make, message: str
):
    make(tmp_path / name)
    with pytest.raises(PictureError, match=message) as error:
        Scene.video(tmp_path / name)
    assert "\n" not in str(error.value) and str(error.value).startswith(str(tmp_path))
    assert capfd.readouterr().err == "", "OpenCV and FFmpeg say nothing themselves"


def test_device_as_video_file_is_refused(tmp_path: Path):
    if not Path("/dev/zero").is_char_device():
        return  # no such thing on this system
    with pytest.raises(PictureError, match="is a device or a pipe, not a video file"):
        Scene.video("/dev/zero")


def test_huge_frame_is_refused_before_it_is_decoded(film: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(reading, "MOST_PIXELS", 24 * 32 - 1)
    monkeypatch.setattr(video_readers, "grab", None)
    with pytest.raises(PictureError, match=r"film.avi: a frame is larger than .*; make the video smaller first"):
        Scene.video(film)


def test_video_of_one_pixel_is_not_a_pair(tmp_path: Path):
    write_png(tmp_path / "0.png", grey(3, (1, 1)))
    assert Scene.video(tmp_path).shape == (1, 1)
    with pytest.raises(PictureError, match=r"1 x 1 pixels have no two halves"):
        Scene.video(tmp_path, layout="side-by-side")


def test_video_given_as_photo_names_the_right_key(tmp_path: Path):
    with pytest.raises(PictureError, match="write `video:` for a video"):
        Scene.photo(write_video(tmp_path / "film.mp4", [grey(1)], codec="mp4v"))


class TestPipelineFile:
    def test_video_paths_start_at_the_file_and_numbers_are_cameras(self, film: Path, folder: Path):
        read = partial(parse_config, "scene: {video: film.avi}", film.parent / "p.yaml", default_registry())
        for sets, video in (
            ([], film),
            (["scene.video=pictures"], folder),
            (["scene.video=3"], 3),
            (["scene.video='3'"], film.with_name("3")),
        ):
            config = read(sets)
            again = parse_config(config.as_yaml(), Path("/elsewhere/p.yaml"), default_registry())
            assert config.scene.video == again.scene.video == video

    @pytest.mark.parametrize(
        "value", ["video=-1", "video=[1]", "fps=0", "fps=.nan", "layout=diagonal", "video=http://a/b.ts"]
    )
    def test_wrong_video_option_is_one_line_with_its_place(self, film: Path, value: str):
        with pytest.raises(ConfigError) as message:
            parse_config("scene: {video: film.avi}", film.parent / "p.yaml", default_registry(), [f"scene.{value}"])
        assert len(message.value.args) == 1 and str(message.value).startswith(f"--set scene.{value}: scene.")

    def test_cache_key_depends_on_the_first_frame_only(self, tmp_path: Path):
        text = "scene: {video: film.avi}\nwant: relief\ndepth: luminance\n"
        keys: list[str] = []
        for first, second in ((1, 2), (1, 3), (2, 3)):
            write_video(tmp_path / "film.avi", [grey(first), grey(second), grey(second)])
            config = parse_config(text, tmp_path / "p.yaml", default_registry())
            keys.append(Pipeline.from_config(config, default_registry(), None).engine.key("disparity"))
        assert keys[0] == keys[1] != keys[2]

    def test_pair_method_on_a_mono_video_suggests_a_layout(self, film: Path):
        pipeline = Pipeline(Scene.video(film), depth=SemiGlobal())
        with pytest.raises(PictureError, match="say how they lie in it, such as `layout: side-by-side`, or name"):
            pipeline.make("disparity")


class TestOptions:
    @pytest.mark.parametrize("fps", [0, -1, float("nan"), float("inf"), 1001, "fast"])
    def test_rate_that_is_not_positive_and_finite_is_refused(self, fps: object):
        with pytest.raises(ValidationError) as error:
            SceneFiles.model_validate({"video": "film.avi", "fps": fps})
        assert error.value.error_count() == 1

    @pytest.mark.parametrize("video", [-1, 100, True, "", 1.5, ["a.avi"], "rtsp://camera/1"])
    def test_wrong_video_source_is_one_complaint(self, video: object):
        with pytest.raises(ValidationError, match=r"number of a camera, from 0|addresses are not opened") as error:
            SceneFiles.model_validate({"video": video})
        assert error.value.error_count() == 1

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"photo": "a.png"}, "leave out photo"),
            ({"left": "a.png", "right": "b.png"}, "leave out left, right"),
            ({"disparity": "a.npy"}, "leave out disparity"),
            ({"truth": "a.npy"}, "leave out truth"),
            ({"clip": [1, 99]}, "leave out clip"),
            ({"nodata": [1, 2]}, "nodata needs height"),
            ({"relief_m": 0.01}, "relief_m needs height"),
            ({"non_finite": "mask"}, "leave out non_finite"),
            ({"focal_px": 100, "baseline_m": 0.1}, "give their layout, such as layout: side-by-side"),
            ({"focal_px": 100, "layout": "side-by-side"}, "focal_px needs baseline_m"),
            ({"rig": "rig.yaml"}, "give their layout, such as layout: side-by-side"),
            ({"rotate": 90, "layout": "side-by-side"}, "rotate is for one view"),
            ({"rig": "r.yaml", "layout": "top-bottom", "crop": [0, 0, 1, 1]}, "rectifies the pictures; leave out crop"),
        ],
    )
    def test_options_that_do_not_fit_a_video_are_refused(self, options: dict, message: str):
        with pytest.raises(ValidationError, match=message):
            SceneFiles.model_validate({"video": "film.avi", **options})

    def test_video_options_without_a_video_are_refused(self):
        for options, message in (
            ({"fps": 30}, "fps needs video"),
            ({"repeat": False}, "repeat needs video"),
            ({"layout": "mono"}, "mono is for a video"),
            ({"layout": "top-bottom"}, "layout needs stereo"),
        ):
            with pytest.raises(ValidationError, match=message):
                SceneFiles.model_validate({"photo": "a.png", **options})
        with pytest.raises(ValidationError, match="mono is for a video"):
            SceneFiles.model_validate({"stereo": "a.png", "layout": "mono"})

    def test_address_is_refused_in_python_too(self):
        with pytest.raises(ConfigError, match=r"scene.video: addresses are not opened"):
            Scene.video("rtsp://camera/1")

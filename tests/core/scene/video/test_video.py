"""If one of these fails, a video is felt with wrong, late or missing frames, or a fault of it ends the program."""

import wave
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pydantic import ValidationError

from pictures import write_png
from tangible_core import Pipeline, Scene
from tangible_core.errors import PictureError
from tangible_core.files import reading
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.rig import Camera, StereoRig
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.video import readers as video_readers
from tangible_core.scene.workspace import kind_of
from videos import Played, grey, greys, shown, write_video


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

    def test_frames_of_a_film_are_rectified_like_the_first_in_any_depth(self, tmp_path: Path):
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


class TestFiles:
    def test_file_gives_frames_in_order_and_repeats_where_asked(self, film: Path):
        with Scene.video(film).frames.open() as frames:
            read = [frames.next() for _ in range(23)]
        assert [each.number for each in read] == list(range(23))
        assert [shown(each.views) for each in read] == [number % 10 for number in range(23)]
        np.testing.assert_allclose([each.time_s for each in read], np.arange(23) / 25, atol=1e-9)
        with Scene.video(film, repeat=False).frames.open() as frames:
            assert frames.at(60).number == 9, "the last frame is due for ever, and is not lost"
            assert frames.at_end is False or frames.at(61) is None
            assert frames.next() is None and frames.at(62) is None and frames.at_end

    def test_frames_follow_time_stamps_unless_a_rate_is_requested(self, film: Path):
        with Scene.video(film).frames.open() as frames:
            assert frames.at(0).number == 0
            assert frames.at(0.03) is None
            latest = frames.at(0.17)
            assert (latest.number, shown(latest.views), frames.skipped) == (4, 4, 3)
            assert frames.next().number == 5, "nothing beyond it was read"
            assert shown(frames.at(0.53).views) == 3, "the fourth of the second round"
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

    def test_frames_that_cannot_be_shown_raise_once(self, monkeypatch: pytest.MonkeyPatch):
        captures = [Played([grey(0), grey(1), grey(2, (48, 32)), grey(3)]) for _ in range(2)]
        with play(monkeypatch, *captures).frames.open() as frames:
            frames.next(), frames.next()
            with pytest.raises(PictureError, match="is 32 x 48 and the first frame 32 x 24"):
                frames.next()
            assert shown(frames.next().views) == 3, "the next call goes on behind it"
        captures = [Played([grey(0), None, None, grey(3)]) for _ in range(2)]
        with play(monkeypatch, *captures).frames.open() as frames:
            assert frames.next().number == 0
            with pytest.raises(PictureError, match=r"film.avi: frame 1 is damaged and left out; copy"):
                frames.next()
            assert frames.next().number == 3 and frames.skipped == 2

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


class TestFolders:
    def test_folder_gives_pictures_in_the_order_of_their_numbers(self, folder: Path):
        scene = Scene.video(folder, fps=10)
        assert scene.notes[0].startswith("pictures is a video, of which this is the first of 12 frames;")
        with scene.frames.open() as frames:
            assert [shown(frames.next().views) for _ in range(14)] == [*range(12), 0, 1]
            assert frames.fps == 10 and Scene.video(folder).frames.fps == 30


def silence(path: Path) -> None:
    with wave.open(str(path), "wb") as sound:
        sound.setnchannels(1), sound.setsampwidth(2), sound.setframerate(8000)
        sound.writeframes(bytes(16000))


BAD = {
    "no file": ("film.avi", lambda path: greys(path.with_name("film2.avi"), 2), "did you mean"),
    "no folder": ("gone/film.avi", lambda path: None, "no folder"),
    "text": ("film.avi", lambda path: path.write_text("no video\n" * 99), "not a video"),
    "empty": ("film.avi", lambda path: path.write_bytes(b""), "empty"),
    "sound": ("film.avi", silence, "no frames"),
    "a header": ("film.avi", lambda path: path.write_bytes(greys(path, 3).read_bytes()[:300]), "not a video"),
    "a picture": ("film.png", lambda path: write_png(path, grey(1)), "`photo:`"),
    "empty folder": ("film", lambda path: path.mkdir(), "no picture"),
    "a playlist": (
        "film.m3u8",
        lambda path: path.write_text("#EXTM3U\n#EXTINF:9,\nhttp://localhost:1/x.ts\n"),
        "not a",
    ),
}


@pytest.mark.parametrize(("name", "make", "word"), BAD.values(), ids=BAD)
def test_unplayable_file_raises_one_line(tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, make, word: str):
    make(tmp_path / name)
    with pytest.raises(PictureError, match=word) as error:
        Scene.video(tmp_path / name)
    assert "\n" not in str(error.value) and str(error.value).startswith(str(tmp_path))
    assert capfd.readouterr().err == "", "OpenCV and FFmpeg say nothing themselves"


def test_huge_frame_is_refused_before_it_is_decoded(film: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(reading, "MAX_PIXELS", 24 * 32 - 1)
    monkeypatch.setattr(video_readers, "grab", None)
    with pytest.raises(PictureError, match=r"film.avi: a frame is larger than .*; make the video smaller first"):
        Scene.video(film)


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

    def test_cache_key_depends_on_the_first_frame_only(self, tmp_path: Path):
        text = "scene: {video: film.avi}\nwant: relief\ndepth: luminance\n"
        keys: list[str] = []
        for first, second in ((1, 2), (1, 3), (2, 3)):
            write_video(tmp_path / "film.avi", [grey(first), grey(second), grey(second)])
            config = parse_config(text, tmp_path / "p.yaml", default_registry())
            keys.append(Pipeline.from_config(config, default_registry(), None).engine.key("disparity"))
        assert keys[0] == keys[1] != keys[2]


class TestOptions:
    @pytest.mark.parametrize(
        ("name", "value"),
        [
            *(("fps", fps) for fps in (0, -1, float("nan"), float("inf"), 1001, "fast")),
            *(("video", video) for video in (-1, 100, True, "", 1.5, ["a.avi"], "rtsp://camera/1")),
        ],
    )
    def test_wrong_value_is_one_complaint(self, name: str, value: object):
        with pytest.raises(ValidationError) as error:
            SceneFiles.model_validate({"video": "film.avi", name: value})
        assert error.value.error_count() == 1

    @pytest.mark.parametrize(
        ("options", "word"),
        [
            ({"photo": "a.png"}, "leave out photo"),
            ({"left": "a.png", "right": "b.png"}, "leave out left, right"),
            *(({name: "a.npy"}, f"leave out {name}") for name in ("disparity", "truth")),
            ({"clip": [1, 99]}, "leave out clip"),
            ({"nodata": [1, 2]}, "needs height"),
            ({"non_finite": "mask"}, "leave out non_finite"),
            ({"focal_px": 100, "baseline_m": 0.1}, "layout"),
            ({"focal_px": 100, "layout": "side-by-side"}, "needs baseline_m"),
            ({"rig": "rig.yaml"}, "layout"),
            ({"rotate": 90, "layout": "side-by-side"}, "for one view"),
            ({"rig": "r.yaml", "layout": "top-bottom", "crop": [0, 0, 1, 1]}, "leave out crop"),
            ({"video": None, "photo": "a.png", "fps": 30}, "needs video"),
            ({"video": None, "photo": "a.png", "repeat": False}, "needs video"),
            ({"video": None, "photo": "a.png", "layout": "mono"}, "for a video"),
            ({"video": None, "photo": "a.png", "layout": "top-bottom"}, "needs stereo"),
            ({"video": None, "stereo": "a.png", "layout": "mono"}, "for a video"),
        ],
    )
    def test_options_that_do_not_fit_are_refused(self, options: dict, word: str):
        with pytest.raises(ValidationError, match=word):
            SceneFiles.model_validate({"video": "film.avi", **options})

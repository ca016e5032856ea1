"""`tangible feel` in an exhibition. Otherwise it would stop, lose its recording, or not stop at a signal."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

import cv2
import numpy as np
import pytest

from command_line import tangible
from ctrl_c import HEARING
from films import layered
from tangible_core.data import TickFlag
from tangible_core.session import INTERRUPTED, Recording

FILE = """
scene: {{height: {height}.npy, relief_m: 0.004}}
want: touch
render: {{use: proxy}}
device: {{use: {device}}}
"""
TANGIBLE = str(Path(sys.executable).with_name("tangible"))


@contextmanager
def recording(folder: Path, *words: str) -> Iterator["subprocess.Popen[str]"]:
    """Start the program in a group of its own, and wait until its recording `hand.nc` has grown."""
    pipe = subprocess.PIPE
    command = [*HEARING, TANGIBLE, *words]
    program = subprocess.Popen(command, cwd=folder, stdout=pipe, stderr=pipe, text=True, start_new_session=True)
    grown, end = folder / "hand.nc", time.monotonic() + 60
    try:
        while not grown.exists() or grown.stat().st_size < 60_000:
            assert program.poll() is None and time.monotonic() < end
            time.sleep(0.05)
        yield program
    finally:
        program.kill()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in "ab":
        np.save(tmp_path / f"{name}.npy", np.tile(np.arange(16.0), (16, 1)))
        (tmp_path / f"{name}.yaml").write_text(FILE.format(height=name, device="mock"))
    (tmp_path / "c.yaml").write_text(FILE.format(height="b", device="pointer"))
    return tmp_path


def test_feel_in_turn_streams_its_recording_to_disk(folder: Path):
    words = ("a.yaml", "b.yaml", "--each", 1, "--record", "hand.nc", "--json")
    with patch.object(Recording, "load", pytest.fail):
        done = tangible("feel", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    recording = Recording.load(folder / "hand.nc")
    assert len(recording.rows) == json.loads(done.stdout)["figures"]["ticks"] == 2000
    swapped = np.flatnonzero(recording.flags & TickFlag.SWAPPED)
    assert len(swapped) and (np.diff(recording.time_s[swapped], prepend=0) >= 1).all()
    one, two = recording.about.configuration.split("---\n")
    assert ("a.npy" in one, "b.npy" in two) == (True, True)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("a.yaml", "c.yaml", "--seconds", 0.5), "c.yaml: has another `device:` or `mapping:` than a.yaml"),
        (("a.yaml", "b.yaml", "--set", "scene.height=none.npy"), "none.npy"),
        (("a.yaml", "--each", 0), "--each: is 0"),
        (("a.yaml", "--seconds", "inf", "--record", "hand.npz"), "recorded as .nc"),
    ],
)
def test_feel_in_turn_of_unsuitable_files_is_refused(folder: Path, words: tuple[object, ...], message: str):
    done = tangible("feel", *words, cwd=folder)
    assert (done.returncode, done.stdout) == (2, "")
    assert message in done.stderr
    assert not list(folder.glob("hand*"))


@pytest.mark.usefixtures("loop_in_thread")
def test_feel_with_an_unmoved_pointer_warns_once(folder: Path):
    done = tangible("feel", "c.yaml", "--seconds", 2, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("start `tangible pointer` in another terminal") == 1


@pytest.mark.parametrize(
    ("number", "group"),
    [
        (signal.SIGTERM, False),
        pytest.param(signal.SIGHUP, True, marks=pytest.mark.whole),
        pytest.param(signal.SIGQUIT, True, marks=pytest.mark.whole),
    ],
)
def test_endless_feel_stops_at_a_signal_with_a_complete_recording(folder: Path, number: signal.Signals, group: bool):
    """The signal goes to the program alone, as by `kill`, or to its loop as well, as by systemd or a terminal."""
    words = ["feel", "a.yaml", "b.yaml", "--each", "0.2", "--seconds", "inf", "--wait", "--record", "hand.nc"]
    with recording(folder, *words) as program:
        (os.killpg if group else os.kill)(program.pid, number)
        out, errors = program.communicate(timeout=60)
    assert program.returncode == 128 + number, errors
    assert "Traceback" not in errors
    assert "was felt for" in out
    kept = Recording.load(folder / "hand.nc")
    assert kept.stopped in (INTERRUPTED, "the process received a signal to end")
    assert (len(kept.rows) > 500, (np.diff(kept.time_s) > 0).all()) == (True, True)


@pytest.mark.whole
def test_loop_ended_alone_is_a_failure_and_not_an_interruption(folder: Path):
    with recording(folder, "feel", "a.yaml", "--seconds", "inf", "--record", "hand.nc") as program:
        [loop] = subprocess.check_output(["pgrep", "-g", str(program.pid), "-f", "servo.child"], text=True).split()
        os.kill(int(loop), signal.SIGTERM)
        _, errors = program.communicate(timeout=60)
    assert program.returncode == 2, errors
    assert "the process received a signal to end" in errors
    assert "interrupted" not in errors


@pytest.mark.usefixtures("loop_in_thread")
def test_feel_of_a_video_plays_it_and_reports_its_frames(tmp_path: Path):
    for number in range(6):
        views = layered(number, 1.0, np.random.default_rng(number))
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.hstack([views.left, views.right]))
    (tmp_path / "walk.yaml").write_text(
        "scene: {video: ., layout: side-by-side, fps: 10}\nwant: touch\nrender: {use: proxy}\n"
        "depth: {use: semi-global, resolution: half}\ndevice: {use: mock, path: circle}\n"
        "texture: {use: histogram, segments: 2}\n"
    )
    for seconds in (1.5, 30):  # a busy machine begins to play later
        done = tangible("feel", "walk.yaml", "--seconds", seconds, "--record", "hand.csv", "--json", cwd=tmp_path)
        assert "parts and materials stay where they are in the first frame" in done.stderr
        figures = json.loads(done.stdout)["figures"]
        if figures["frames_shown"] > 1:
            break
    assert figures["frames_shown"] > 1 and figures["frames_damaged"] == 0
    assert np.nanmax(Recording.load(tmp_path / "hand.csv").frame) > 0

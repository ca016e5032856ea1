"""The frames of a video file, and of a folder of pictures."""

import re
from collections.abc import Iterator
from math import floor
from pathlib import Path
from time import monotonic
from typing import final

import numpy as np
from jaxtyping import UInt8

from ...data.pictures import UsedRange, full_scale, opaque, to_rgb8, used_range
from ...errors import PictureError
from ..formats.kinds import PICTURES
from ..formats.pairs import Stored, read_stored, same_type, turn_alike
from ..formats.pictures import to_picture
from .capture import (
    USUAL_FPS,
    Capture,
    VideoFrame,
    VideoFrames,
    ViewsOf,
    grab,
    open_file,
    position_s,
    retrieve,
    stated_count,
    stated_fps,
)

# Longest time between two frames of a file, seconds; a larger step of the time stamps is taken for an error.
LONGEST_S = 60.0
EARLY_S = 1e-6
# Largest error of a time stamp at an even rate, as a share of the frame time: stamps are whole milliseconds.
UNEVEN = 0.25
# Longest time to skip frames in one call, seconds. A file that decodes too slowly then plays more slowly.
CATCH_UP_S = 0.1
# Share of frames that may be missing before a file counts as cut short: the stated count is often an estimate.
SHORT = 0.1


@final
class FileFrames(VideoFrames):
    """The frames of a video file."""

    def __init__(self, path: Path, fps: float | None, repeat: bool, views_of: ViewsOf) -> None:
        """fps: frames a second, instead of the file's time stamps. Raises: PictureError if it is not a video."""
        self._capture: Capture | None = open_file(path)
        super().__init__(fps or stated_fps(self._capture) or USUAL_FPS, views_of)
        self.count: int | None = stated_count(self._capture)
        self._path, self._repeat, self._uses_stamps = path, repeat, fps is None
        self._frame_count = self._in_round = self._damage_count = 0
        self._waiting = False
        self._due_s = self._stamp_s = self._late_s = 0.0
        self._even, self._known_even = True, fps is not None
        self._is_over = False

    @property
    def at_end(self) -> bool:
        """True if the last frame was read and the video does not start again."""
        return self._is_over

    def next(self) -> VideoFrame | None:
        """Return the next whole frame. Raises: PictureError, once, for a damaged one, or a file that is cut short."""
        while self._waiting or self._advance():
            if (frame := self._take()) is not None:
                return frame
        return None

    def at(self, time_s: float) -> VideoFrame | None:
        """Return the latest frame due, or an earlier one if there are too many to skip. Raises: as `next`."""
        latest: VideoFrame | None = None
        began_s = monotonic()
        while self._waiting or self._advance():
            due_s = self._due_s + self._late_s
            if due_s > time_s + EARLY_S:
                break
            too_slow = monotonic() - began_s > CATCH_UP_S
            if not too_slow and self._another_by(time_s):
                self._waiting = False
                self.skipped += 1
                continue
            if (frame := self._take()) is not None:
                self.skipped += latest is not None
                latest = frame
            if too_slow:
                self._late_s += time_s - due_s
                break
        return latest

    def close(self) -> None:
        """Close the file."""
        self._is_over, self._waiting = True, False
        self._release()

    def _another_by(self, time_s: float) -> bool:
        """Tell whether the frame after the grabbed one is due at this time, too."""
        # A skipped frame is decoded, as later ones depend on it, but not converted to colours, which takes as long.
        # That needs certainty that the next frame is due as well: by a requested rate, or by stamps that were even over
        # the whole file before. A frame that stands for seconds is never missed.
        last = self.count is not None and self._in_round >= self.count and not self._repeat
        return self._known_even and not last and self._due_s + self._late_s + (1 + UNEVEN) / self.fps <= time_s

    def _advance(self) -> bool:
        while not self._is_over:
            if self._capture is None:
                self._capture = open_file(self._path)
            if grab(self._capture):
                self._time(self._capture)
                self._waiting = True
                return True
            self._end_round()
        return False

    def _time(self, capture: Capture) -> None:
        stamp_s, usual_s = position_s(capture), 1 / self.fps
        step_s = stamp_s - self._stamp_s if self._in_round and self._uses_stamps else usual_s
        if not 0 < step_s <= LONGEST_S:
            step_s = usual_s
        self._even &= abs(step_s - usual_s) < UNEVEN * usual_s
        self._due_s += step_s if self._frame_count else 0
        self._stamp_s = stamp_s
        self._frame_count += 1
        self._in_round += 1

    def _take(self) -> VideoFrame | None:
        self._waiting = False
        picture = None if self._capture is None else retrieve(self._capture, self._path)
        if picture is None:
            self.skipped += 1
            self._damage_count += 1
            fault = f"{self._path}: frame {self._in_round - 1} is damaged and left out; copy or download the file again"
            self._raise_once("damaged", PictureError(fault))
            return None
        return self._frame(self._frame_count - 1, self._due_s, picture, self._path)

    def _end_round(self) -> None:
        """Handle the end of the file. Raises: PictureError if it had no frame; once, if frames are missing."""
        count, damage_count = self._in_round, self._damage_count
        self._known_even = self._even
        self._in_round = self._damage_count = 0
        self._release()
        self._is_over = not self._repeat
        if count == damage_count:
            raise PictureError(f"{self._path}: none of its frames can be played; convert it to an .mp4 with H.264")
        if self.count is not None and count + 2 < self.count * (1 - SHORT):
            fault = f"{self._path}: is damaged or cut short after {count} of {self.count} frames; copy it again"
            self._raise_once("short", PictureError(fault))

    def _release(self) -> None:
        if self._capture is not None:
            self._capture.release()
            self._capture = None


@final
class FolderFrames(VideoFrames):
    """The pictures of a folder, in the order of the numbers in their names; skipped ones are not read."""

    def __init__(self, folder: Path, fps: float | None, repeat: bool, views_of: ViewsOf) -> None:
        """fps: 30 a second by default. Raises: PictureError if the folder has no picture."""
        super().__init__(fps or USUAL_FPS, views_of)
        self._pictures = list_pictures(folder)
        self.count: int | None = len(self._pictures)
        self._folder, self._repeat = folder, repeat
        self._number = 0
        self._first: Stored | None = None
        self.used: UsedRange | None = None
        """The range that the first picture uses, if it is small; all are stretched alike."""

    @property
    def at_end(self) -> bool:
        """True if the last picture was read and the video does not start again."""
        return self._number >= len(self._pictures) and not self._repeat

    def next(self) -> VideoFrame | None:
        """Return the next whole picture. Raises: PictureError, once, for a damaged one; if none is whole."""
        for _ in self._pictures:
            if self.at_end:
                return None
            if (frame := self._read()) is not None:
                return frame
        raise PictureError(f"{self._folder}: none of its {len(self._pictures)} pictures can be read; copy them again")

    def at(self, time_s: float) -> VideoFrame | None:
        """Return the latest picture that is due; None if it is damaged. Raises: PictureError as `next`."""
        due = floor((time_s + EARLY_S) * self.fps)
        due = due if self._repeat else min(due, len(self._pictures) - 1)
        if due < self._number:
            return None
        self.skipped += due - self._number
        self._number = due
        return self._read()

    def close(self) -> None:
        """Stop; no file is open."""
        self._number, self._repeat = len(self._pictures), False

    def _read(self) -> VideoFrame | None:
        """Read the next picture; None for a damaged one. Raises: PictureError, once, for a damaged one."""
        number = self._number
        self._number += 1
        path = self._pictures[number % len(self._pictures)]
        try:
            is_first, picture = self._first is None, self._like_first(read_stored(path))
            if is_first:
                self.used = used_range(picture)
            picture = as_frame(self.used.stretch(picture) if self.used else picture)
        except PictureError as error:
            self.skipped += 1
            self._raise_once("damaged", error)
            return None
        return self._frame(number, number / self.fps, picture, path)

    def _like_first(self, source: Stored) -> np.ndarray:
        """Return a picture with the orientation and white of the first one. Raises: PictureError as `to_picture`."""
        # It decides the white of floats and wide integers, and the orientation of pictures that state none.
        first = self._first or source
        picture = to_picture(same_type(first, turn_alike(source, first))[1], source.name)
        self._first = first
        if picture.dtype.kind == first.values.dtype.kind == "f":
            return np.clip(picture / full_scale(first.values), 0, 1)
        return picture


def list_pictures(folder: Path) -> list[Path]:
    """List the pictures in a folder, in the order of the numbers in their names. Raises: PictureError without one."""
    try:
        pictures = [
            path for path in folder.iterdir() if path.suffix.lower() in PICTURES and not path.name.startswith(".")
        ]
    except OSError as error:
        raise PictureError(f"{folder}: cannot be read: {error.strerror or error}; check its permissions") from error
    if not pictures:
        raise PictureError(f"{folder}: holds no picture; name a folder of pictures (.png, .jpg, .tif), or a video file")
    return sorted(pictures, key=lambda path: list(_natural(path.name)))


def _natural(name: str) -> Iterator[tuple[int, str]]:
    """Yield the sort key of a name: numbers as numbers, so that 10 comes after 9; last, the name itself."""
    for part in re.findall(r"[0-9]+|[^0-9]+", name):
        yield (int(part), "") if part.isdecimal() and len(part) < 1000 else (-1, part.lower())
    yield (-1, name)


def as_frame(picture: np.ndarray) -> UInt8[np.ndarray, "h w c"]:
    """Convert a picture to eight bits: RGB, and a fourth channel of 0 or 255 if it has one."""
    if picture.shape[2:] != (4,):
        return to_rgb8(picture)
    opacity = opaque(picture)[..., None] * np.uint8(255)
    return np.concatenate([to_rgb8(np.ascontiguousarray(picture[..., :3])), opacity], axis=2)

"""A video as a scene names it: a file, a folder of pictures, or a camera."""

import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, cast, final

import numpy as np

from ...data import Views
from ...data.pictures import fill_from_nearest, opaque
from ...errors import PictureError
from ..formats.decoding import FORMATS
from ..formats.multi_picture import Say, unsaid
from ..formats.pairs import halves
from ..framing import framed
from ..rig import StereoRig, Turning
from ..scene_files import SceneFiles, VideoLayout
from .camera import CameraFrames
from .frames import VideoFrame as VideoFrame
from .frames import VideoFrames as VideoFrames
from .frames import ViewsOf
from .readers import FileFrames, FolderFrames


@dataclass(frozen=True, eq=False)
class Video:
    """Pictures that follow one another, each of which is a photo or a pair. Made by `Scene.of` and `Scene.read`."""

    source: Path | int
    """A file, a folder of pictures, or the number of a camera."""
    layout: VideoLayout
    """How the two views of a pair lie in each frame; `mono` for one view."""
    fps: float
    """Frames a second: what was said, or what the source says."""
    name: str
    repeat: bool = True
    """Whether a file or a folder begins again at its end."""
    timed: bool = True
    """Whether frames of a file come when it says that they are due, and not at an even rate that was said."""
    count: int | None = None
    """How many frames there are, as the file says; None where nobody knows."""
    size: tuple[int, int] | None = None
    """(h, w) of each frame as it is stored; None for that of the first one."""
    files: SceneFiles = field(default_factory=lambda: SceneFiles(video=0))
    """How each frame is cropped and turned, and what is known of the cameras."""
    rig: StereoRig | None = None

    def open(self) -> VideoFrames:
        """Its frames, from the first one. Raises: PictureError if it cannot be played."""
        frames = _opened(self.source, None if self.timed else self.fps, self.repeat, FrameViews(self))
        frames.size = self.size
        return frames


@final
class FrameViews:
    """What becomes of each frame of a video: its view, or the two, as a scene would read them from files."""

    def __init__(self, video: Video) -> None:
        self._video, self._files = video, still(video.files)
        self._turning: Turning | None = None

    def __call__(self, picture: np.ndarray) -> Views:
        """picture: as it is stored. Raises: PictureError if nothing of it is to be seen."""
        video, files = self._video, self._files
        held = framed(parts_of(picture, video.files, video.name), files)
        held = {part: _solid(values, video.name) for part, values in held.items()}
        views = Views(held[files.main], held.get("right"), files.calibration)
        if video.rig is None:
            return views
        self._turning = self._turning or Turning(video.rig, views.shape)
        return self._turning.of(views).views


class FirstFrame(NamedTuple):
    """A video, and its first picture as it is stored."""

    video: Video
    picture: np.ndarray


def read_video(source: Path | int, files: SceneFiles, rig: StereoRig | None, say: Say = unsaid) -> FirstFrame:
    """A video file, a folder of pictures or a camera, and what its first frame shows.

    say: hears that it is a video.
    Raises: PictureError if it is none, or cannot be played.
    """
    name = _name(source)
    with _opened(source, files.fps, False, cast(ViewsOf, _as_stored)) as frames:
        first = frames.next()
        if first is None or (isinstance(frames, FileFrames) and _is_picture(source, frames)):
            raise PictureError(f"{source}: is one picture and no video; write `photo:` instead of `video:`")
        fps, count = frames.fps, frames.count
    picture: np.ndarray = cast(Any, first.views)
    video = Video(
        source, files.layout or "mono", fps, name, files.repeat, files.fps is None, count, picture.shape[:2], files, rig
    )
    say(f"{_short(source)} is a video, of which this is {_which(source, count)}; `tangible feel` plays it")
    return FirstFrame(video, picture)


def still(files: SceneFiles) -> SceneFiles:
    """The files of a scene that one frame of a video is: a photo, or a pair."""
    name = Path(_name(cast("Path | int", files.video)))
    nothing: dict[str, Any] = {"video": None, "fps": None, "repeat": True, "layout": None}
    parts = {"photo": name} if (files.layout or "mono") == "mono" else {"left": name, "right": name}
    return files.model_copy(update=nothing | parts)


def parts_of(picture: np.ndarray, files: SceneFiles, name: str) -> dict[str, np.ndarray]:
    """The parts of a scene that one frame of a video holds: a photo, or left and right."""
    if files.layout in (None, "mono"):
        return {"photo": picture}
    return halves(picture, files.layout, name)._asdict()


def _opened(
    source: Path | int, fps: float | None, repeat: bool, views_of: ViewsOf
) -> "FileFrames | FolderFrames | CameraFrames":
    if isinstance(source, int):
        return CameraFrames(source, fps, views_of)
    return (FolderFrames if source.is_dir() else FileFrames)(source, fps, repeat, views_of)


def _as_stored(picture: np.ndarray) -> np.ndarray:
    return picture


def _name(source: Path | int) -> str:
    return f"camera {source}" if isinstance(source, int) else str(source)


def _short(source: Path | int) -> str:
    return _name(source) if isinstance(source, int) else source.name or str(source)


def _which(source: Path | int, count: int | None) -> str:
    if isinstance(source, int):
        return "one picture"
    return "the first frame" if count is None else f"the first of {count} frames"


def _is_picture(source: Path | int, frames: FileFrames) -> bool:
    """Whether a file is a picture that can be played as a video of one frame."""
    from PIL import Image, UnidentifiedImageError

    with warnings.catch_warnings(action="ignore"):
        try:
            if frames.next() is not None:
                return False
            with Image.open(cast(Path, source), formats=FORMATS):
                return True
        except (PictureError, UnidentifiedImageError, OSError, ValueError, Image.DecompressionBombError):
            return False


def _solid(picture: np.ndarray, name: str) -> np.ndarray:
    """A view without its fourth channel, what that hides filled. Raises: PictureError if that is all of it."""
    if picture.shape[2] == 3:
        return picture
    shown = opaque(picture)
    if not shown.any():
        raise PictureError(f"{name}: all of the picture is transparent; there is nothing to feel")
    solid = np.ascontiguousarray(picture[..., :3])
    return solid if shown.all() else fill_from_nearest(solid, shown)

"""The video of a scene: a file, a folder of pictures, or a camera."""

import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, cast, final

import numpy as np

from ...data import Views
from ...errors import PictureError
from ..formats.decoding import FORMATS
from ..formats.multi_picture import Notify, ignore
from ..formats.pairs import halves
from ..framing import apply_framing, cut_out
from ..rig import Rectifier, StereoRig
from ..scene_files import SceneFiles, VideoLayout
from .camera import CameraFrames
from .capture import VideoFrame as VideoFrame
from .capture import VideoFrames as VideoFrames
from .capture import ViewsOf
from .readers import FileFrames, FolderFrames


@dataclass(frozen=True, eq=False)
class Video:
    """A sequence of pictures, each a photo or a pair. `Scene.video` and `Scene.read` make it."""

    source: Path | int  # a file, a folder of pictures, or the number of a camera
    layout: VideoLayout
    fps: float
    name: str
    repeat: bool = True
    timed: bool = True  # show the frames of a file by its time stamps, not at a requested even rate
    count: int | None = None  # number of frames that the file states; None if unknown
    size: tuple[int, int] | None = None  # shape (h, w) of each stored frame; None for that of the first one
    # Options that crop and rotate each frame, and the calibration of the cameras.
    files: SceneFiles = field(default_factory=lambda: SceneFiles(video=0))
    rig: StereoRig | None = None

    def open(self) -> VideoFrames:
        """Open the video at its first frame. Raises: PictureError if it cannot be played."""
        frames = _open(self.source, None if self.timed else self.fps, self.repeat, FrameViews(self))
        frames.size = self.size
        return frames


@final
class FrameViews:
    """A converter from a stored frame to its view or two views, as a scene reads them from files."""

    def __init__(self, video: Video) -> None:
        self._video, self._files = video, still(video.files)
        self._rectifier: Rectifier | None = None

    def __call__(self, picture: np.ndarray) -> Views:
        """Convert a stored picture. Raises: PictureError if all of it is transparent."""
        video, files = self._video, self._files
        parts = apply_framing(frame_parts(picture, video.files, video.name), files)
        parts = {
            part: values if values.shape[2] == 3 else cut_out(values, video.name)[0] for part, values in parts.items()
        }
        views = Views(parts[files.main], parts.get("right"), files.calibration)
        if video.rig is None:
            return views
        self._rectifier = self._rectifier or Rectifier(video.rig, views.shape)
        return self._rectifier.rectify(views).views


class FirstFrame(NamedTuple):
    """A video, and its first stored picture."""

    video: Video
    picture: np.ndarray


def read_video(source: Path | int, files: SceneFiles, rig: StereoRig | None, notify: Notify = ignore) -> FirstFrame:
    """Open a video, a folder of pictures or a camera, and read its first frame. Raises: PictureError."""
    name = _name(source)
    with _open(source, files.fps, False, cast(ViewsOf, np.asarray)) as frames:
        first = frames.next()
        if first is None or (isinstance(frames, FileFrames) and _is_picture(source, frames)):
            raise PictureError(f"{source}: is a picture, not a video; write `photo:` instead of `video:`")
        fps, count = frames.fps, frames.count
        if isinstance(frames, FolderFrames) and frames.used:
            notify(frames.used.sentence(_short(source)))
    picture: np.ndarray = cast(Any, first.views)
    video = Video(
        source, files.layout or "mono", fps, name, files.repeat, files.fps is None, count, picture.shape[:2], files, rig
    )
    notify(f"{_short(source)} is a video, of which this is {_which(source, count)}; `tangible feel` plays it")
    return FirstFrame(video, picture)


def still(files: SceneFiles) -> SceneFiles:
    """Return the files of the scene that one frame of a video is: a photo, or a pair."""
    name = Path(_name(cast("Path | int", files.video)))
    defaults: dict[str, Any] = {"video": None, "fps": None, "repeat": True, "layout": None}
    parts = {"photo": name} if (files.layout or "mono") == "mono" else {"left": name, "right": name}
    return files.model_copy(update=defaults | parts)


def frame_parts(picture: np.ndarray, files: SceneFiles, name: str) -> dict[str, np.ndarray]:
    """Return the parts of a scene in one frame of a video: a photo, or left and right."""
    if files.layout in (None, "mono"):
        return {"photo": picture}
    return halves(picture, files.layout, name)._asdict()


def _open(
    source: Path | int, fps: float | None, repeat: bool, views_of: ViewsOf
) -> "FileFrames | FolderFrames | CameraFrames":
    if isinstance(source, int):
        return CameraFrames(source, fps, views_of)
    return (FolderFrames if source.is_dir() else FileFrames)(source, fps, repeat, views_of)


def _name(source: Path | int) -> str:
    return f"camera {source}" if isinstance(source, int) else str(source)


def _short(source: Path | int) -> str:
    return _name(source) if isinstance(source, int) else source.name or str(source)


def _which(source: Path | int, count: int | None) -> str:
    if isinstance(source, int):
        return "one picture"
    return "the first frame" if count is None else f"the first of {count} frames"


def _is_picture(source: Path | int, frames: FileFrames) -> bool:
    """Tell whether a file is a picture, which can be played as a video of one frame."""
    from PIL import Image, UnidentifiedImageError

    with warnings.catch_warnings(action="ignore"):
        try:
            if frames.next() is not None:
                return False
            with Image.open(cast(Path, source), formats=FORMATS):
                return True
        except (PictureError, UnidentifiedImageError, OSError, ValueError, Image.DecompressionBombError):
            return False

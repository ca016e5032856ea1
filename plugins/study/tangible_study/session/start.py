"""The start of a session: from a study file and a name to a participant who can begin."""

from collections.abc import Callable
from pathlib import Path

from tangible_core.errors import ConfigError, quoted

from ..desks.desk import Desk
from ..presenting.presenter import Presenter
from ..presenting.stimuli import Stimuli
from ..study_file import StudyFile
from . import folder
from .running import Session

CHOOSES_DEVICE = ("device.", "mapping.")
"""Keys of a pipeline that may be set for a session: they belong to the place and not to the design."""


def device_changes(device: str | None, sets: list[str]) -> tuple[str, ...]:
    """Return the changes of each pipeline that choose the device. Raises: ConfigError for other keys."""
    for each in sets:
        if not each.startswith(CHOOSES_DEVICE):
            raise ConfigError(
                f"--set {quoted(each)}: what varies stands in the study file; only keys of the device are set here, "
                "such as device.path=circle"
            )
    return (*([] if device is None else [f"device.use={device}"]), *sets)


def begin(
    file: StudyFile,
    stimuli: Stimuli,
    name: str,
    root: Path,
    desk: Desk,
    *,
    resume: bool = False,
    in_real_time: bool = True,
    progress: Callable[[int], None] = lambda _: None,
) -> Session | None:
    """Make all stimuli, check them on the device, and enrol the participant; None if the participant does not agree.

    Raises: ConfigError for a stimulus that the device cannot render, or a name that is taken; OutputError; Left.
    """
    stimuli.make(progress)
    stimuli.check()
    place = folder.Place(root, name, file.study.study)
    if root.exists():
        folder.check_name(root, name, resume)
    session = Session(stimuli, place, 0, desk, Presenter(stimuli, desk, in_real_time))
    if not session.ask_consent():
        return None
    folder.prepare(root, file)
    session.number = folder.enrol(root, name, file.study, resume)
    session.save_consent()
    return session

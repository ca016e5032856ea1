from pathlib import Path

from tangible_core.data import NO_FORCE
from tangible_core.plugins.touch import PlainTouch, Touch
from tangible_core.servo import parcel


class Packed(Touch):
    def __init__(self, path, stiffness):
        self.path_, self.stiffness_n_per_m = path, stiffness

    def __reduce__(self):
        return parcel.unpack, (Path(self.path_),)

    def force(self, state):
        raise NotImplementedError

    def path(self, positions_m, period_s=0.001):
        raise NotImplementedError


class Still(PlainTouch):
    stiffness_n_per_m = 0.0

    def force(self, state):
        return NO_FORCE


def still():
    return Still()

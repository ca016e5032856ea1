from matplotlib import pyplot
from tangible import Force, HapticState, Mock, Pipeline, Scene
from tangible_core.plugins import ForceRenderer, PlainTouch


class Magnet(ForceRenderer):
    """A pull towards the surface within `reach_m` of it, and a spring below."""

    reach_m: float = 0.002

    def touch(self, surface):
        return MagnetTouch(surface, self.reach_m)


class MagnetTouch(PlainTouch):
    stiffness_n_per_m = 800.0

    def __init__(self, surface, reach_m):
        self.surface, self.reach_m = surface, reach_m

    def force(self, state: HapticState) -> Force:
        x, y, z = state.position_m
        depth_m = self.surface.height_at(x, y) - z  # negative above the surface, NaN beyond it
        pull_n = -0.5 if -self.reach_m < depth_m < 0 else 0.0
        return Force(0.0, 0.0, self.stiffness_n_per_m * depth_m if depth_m > 0 else pull_n)


recording = Pipeline(Scene.builtin("coins"), depth="luminance", render=Magnet()).feel(
    Mock(path="circle"), seconds=2, in_real_time=False
)
pyplot.plot(recording.time_s, recording.force_n[:, 2])
pyplot.gca().set(xlabel="time, s", ylabel="force upwards, N")
pyplot.savefig("magnet.png")
# look at: magnet.png

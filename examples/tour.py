# pyright: reportUnusedExpression=false
# (the last line of a cell is what a notebook shows)

# %% [markdown]
# # A tour of Tangible Images in Python
#
# A pair of pictures becomes a surface that can be felt. Everything here works in a script as well: this page is made of
# `tour.py` by `python examples/notebook.py`.

# %% [markdown]
# ## A scene and a pipeline
#
# A scene is made of arrays, of files, or is built in. A pipeline names the methods; nothing runs yet.

# %%
import tempfile
from pathlib import Path

import numpy as np

from tangible_core import DisparityMap, Feeling, HapticState, Pipeline, Scene, Views, Workspace, show
from tangible_core.plugins import DepthEstimator
from tangible_depth import SemiGlobal
from tangible_devices import Mock
from tangible_render import GreyLevel, Proxy
from tangible_texture import Gradient

scene = Scene.builtin("motorcycle")  # or Scene.pair(left=..., right=..., calibration=...): arrays or paths
pipeline = Pipeline(
    scene,
    depth=SemiGlobal(),
    texture=Gradient(),
    workspace=Workspace(width_m=0.08, relief_m=0.005, smooth_m=0.001),
    render=Proxy(),
    device=Mock(path="circle"),
)
pipeline.plan()

# %% [markdown]
# ## Products
#
# A product is made when it is first asked for, from what it needs and no more.

# %%
disparity = pipeline.disparity
assert disparity is not None  # it would be None for a scene that needs none; pipeline.outcomes would say why
disparity

# %%
surface = pipeline.surface
print(f"{1e3 * surface.extent_m[0]:.0f} mm wide, {1e3 * float(surface.height_m.max()):.1f} mm high")
surface

# %%
pipeline.outcomes

# %% [markdown]
# `show` draws what the panel of a report draws, into axes of your own if you like.

# %%
if pipeline.segments is not None:
    show(pipeline.segments, views=pipeline.scene.views, materials=pipeline.materials)

# %% [markdown]
# ## Forces
#
# A touch is the law on this surface: it turns the position of a hand into newtons.

# %%
touch = pipeline.touch
touch.force(HapticState(position_m=(0.0, 0.0, 0.002)))

# %% [markdown]
# ## What is safe, and what is felt
#
# `preflight` says so before any motor moves. `feel` runs the force loop in a process of its own, a thousand times a
# second; here the device is a mock that draws a circle.

# %%
verdicts = pipeline.preflight()
{grade: sum(each.verdict == grade for each in verdicts) for grade in ("ok", "warn", "unsafe")}

# %%
recording = pipeline.feel(seconds=1.0)
recording

# %% [markdown]
# The same hand, felt through another law:

# %%
grey = Pipeline(scene, depth=SemiGlobal(), workspace=pipeline.config.workspace, render=GreyLevel())
again = Feeling(grey).replay(recording)
print(f"proxy: {recording.peak_force_n:.2f} N at most, grey level: {again.peak_force_n:.2f} N")

# %% [markdown]
# ## A method of your own
#
# A method is its options and one verb. A class that is written here works as any installed one does; a plugin gets an
# entry point, so that files can name it (see docs/how-to/write-a-plugin.md).


# %%
class Ramp(DepthEstimator):
    """A ramp that comes nearer from top to bottom, for any picture."""

    most_px: float = 40.0
    """Disparity of the lowest row."""

    def estimate(self, views: Views) -> DisparityMap:
        """Return the ramp, in pixels."""
        height, width = views.shape
        column = np.linspace(0, self.most_px, height, dtype=np.float32)
        return DisparityMap(np.repeat(column[:, None], width, axis=1))


Pipeline(scene, depth=Ramp(most_px=20.0)).disparity

# %% [markdown]
# ## Files
#
# A run writes products, figures and a sheet into a folder. A pipeline can be written as a file, and read again.

# %%
out = Path(tempfile.mkdtemp())
run = pipeline.run(out / "mine", seconds=0.5)
pipeline.to_yaml(out / "mine.yaml")
assert Pipeline.from_yaml(out / "mine.yaml").config.as_data() == pipeline.config.as_data()
run

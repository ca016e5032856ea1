"""Touch: every promise about the force laws with its bound, and what stands behind the figures."""

from . import render_beacon, render_guard, render_ticks, render_waves
from .figures import judged
from .render_waves import AMPLITUDE_M, DEPTH_M


def section() -> str:
    """Return the section as Markdown."""
    return "\n".join(
        [
            f"Waves of {2000 * AMPLITUDE_M:g} mm every 20 mm on 80 mm, a hand {1000 * DEPTH_M:g} mm under them, 1 kHz. "
            "ns a tick are those of `path`, compiled, with the velocity of each step, in processor time, in turns.",
            "",
            *judged(
                [*render_waves.figures(), *render_ticks.figures(), *render_guard.figures(), *render_beacon.figures()]
            ),
        ]
    )

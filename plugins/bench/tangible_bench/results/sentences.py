"""The result of a comparison in a plain sentence, above the tables, which say the same in the field's words."""

from math import isfinite, nan

from .table import Results


def compared(results: Results) -> str:
    """Which method is the most exact and which the fastest."""
    known = [line for line in results.means() if isfinite(line.seconds)]
    if not known:
        return _compared_untimed(results)
    best, fastest = known[0], min(known, key=lambda line: line.seconds)
    measure, clock = results.task.measures[results.judged], results.task.clock
    scenes = _scenes(results)
    fast = f"{fastest.method} is the fastest ({clock.per_second * fastest.seconds:.3g} {clock.unit})"
    value = best.measures.get(results.judged, nan)
    if not isfinite(value):
        return f"On {scenes}, {fast}."
    exact = f"{results.heading(results.judged)} {value:.{measure.digits}f}"
    return f"On {scenes}, {best.method} is the most exact ({exact}), and {fast}."


def _compared_untimed(results: Results) -> str:
    known = [line for line in results.means() if isfinite(line.measures.get(results.judged, nan))]
    if not known:
        return "No method has a result on every scene."
    measure, best = results.task.measures[results.judged], known[0]
    value = f"{measure.title} {best.measures[results.judged]:.{measure.digits}f}"
    return f"On {_scenes(results)}, {best.method} is the most exact ({value}); times were not measured."


def _scenes(results: Results) -> str:
    return f"{len(results.scenes)} scenes" if len(results.scenes) > 1 else results.scenes[0]

"""What a recorder does to the force loop, and how late it is without real-time rights."""

import os
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from statistics import median

from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.servo import Safety, Servo
from tangible_core.session import Recording, Writer, live

from .figures import Figure, judged, part, table
from .rights import give_up
from .servo_loops import LOOPS, compiled_c, in_c, ours, touch
from .servo_rounds import (
    BY_CHANCE,
    HEADINGS,
    LATE_US,
    POINTS,
    TIMES,
    Round,
    late_percent,
    no_later,
    no_more_overruns,
    rows,
    together,
)
from .tests_path import Circling

ROUNDS = 8
RECORDED_S, PLAIN_S = 3.5, 3.0  # each kind's share of a round
SHARE = f"<= {TIMES:g} x {{}}, or {POINTS:g} points more"
RECORDED, UNRECORDED = "with a recorder", "without one"
IN_C = "a loop in C"
Rounds = dict[str, list[Round]]


def section() -> str:
    """Return the section as Markdown."""
    recorded, of_recorder = part("recorder", _recorder)
    plain, of_rights = part("without real-time rights", _without_rights)
    head = (
        "`python -m benchmarks servo_late` measures this section alone. Loops of 1 kHz take "
        f"turns for {ROUNDS} rounds, of {RECORDED_S:g} s each with and without a recorder, of {PLAIN_S:g} s each "
        "without real-time rights. Share of late ticks: the median of the rounds. Periods without a tick: all rounds "
        "together; more of them are no difference where the two of a round, exchanged at random, differ as much in "
        f"over {100 * BY_CHANCE:g} % of all cases."
    )
    tables = [*table(("loop", *HEADINGS), [*rows(recorded), *rows(plain)])]
    return "\n".join([head, "", *judged([*of_recorder, *of_rights]), "", *tables])


def _in_turn(kinds: dict[str, Callable[[], Round]]) -> Rounds:
    found: Rounds = {name: [] for name in kinds}
    for number in range(ROUNDS):
        for name in list(kinds)[:: 1 if number % 2 else -1]:
            found[name].append(part(f"{number + 1}: {name}", kinds[name]))
    return found


def _recorder() -> tuple[Rounds, list[Figure]]:
    lost, used_s = list[int](), {RECORDED: list[float](), UNRECORDED: list[float]()}

    def with_it() -> Round:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "hand.nc"
            with Writer(path) as writer:
                found = _watched(writer.append, used_s[RECORDED])
            lost.append(int(found.late.sum()) - len(Recording.load(path).rows))
        return found

    found = _in_turn({RECORDED: with_it, UNRECORDED: lambda: _watched(live.ignore, used_s[UNRECORDED])})
    return found, list(_of_recorder(found, lost, used_s))


def _watched(keep: Callable, used_s: list[float]) -> Round:
    """Return a session, and how many seconds of a processor this process had meanwhile, from the first tick on."""
    servos, begun_s = list[Servo](), list[float]()

    def started(servo: Servo) -> None:
        servos.append(servo)
        begun_s.append(time.process_time())

    live.run_in_real_time(touch(), Circling(), RECORDED_S, Safety(), keep=keep, on_start=started)
    used_s.append(time.process_time() - begun_s[0])
    return Round.of(servos[0].ring)


def _of_recorder(found: Rounds, lost: list[int], used_s: dict[str, list[float]]) -> Iterator[Figure]:
    mine, alone = found[RECORDED], found[UNRECORDED]
    every, without = together(mine), together(alone)
    yield Figure("recorder: ticks not recorded", "0", f"{sum(lost)} of {every.late.sum()}", not any(lost))
    told = f"{every.overruns} with it, {without.overruns} without"
    bound = "no more with it than without"
    yield Figure("recorder: periods without a tick", bound, told, no_more_overruns(mine, alone))
    shares = [f"{100 * median(each) / RECORDED_S:.2f} %" for each in used_s.values()]
    told = f"{shares[0]} of a processor, {shares[1]} without a recorder"
    yield Figure("recorder: the process that watches the loop", "", told, True)


def _without_rights() -> tuple[Rounds, list[Figure]]:
    with tempfile.TemporaryDirectory() as folder, _rightless() as ask:
        program = compiled_c(Path(folder))
        kinds: dict[str, Callable[[], Round]] = {_ours(name): partial(ask, ours, LOOPS[name]) for name in LOOPS}
        if program is not None:
            kinds = {IN_C: partial(ask, in_c, program), **kinds}
        found = _in_turn(kinds)
    return found, [_beside_c(name, found) for name in map(_ours, LOOPS)]


def _ours(name: str) -> str:
    return f"no rights: {name}"


def _beside_c(name: str, found: Rounds) -> Figure:
    if IN_C in found:
        return _share(name, "a loop in C without them", found[name], found[IN_C])
    share = late_percent(found[name])
    told = f"{share:.3f} %; no C compiler (`cc`) was found, so there is nothing to compare with"
    return Figure(f"{name} later than {LATE_US} us", SHARE.format("a loop in C without them"), told, False)


def _share(what: str, other: str, mine: list[Round], theirs: list[Round]) -> Figure:
    shares = [late_percent(mine), late_percent(theirs)]
    told = f"{shares[0]:.3f} %, {other} {shares[1]:.3f} %"
    return Figure(f"{what} later than {LATE_US} us", SHARE.format(other), told, no_later(mine, theirs))


@contextmanager
def _rightless() -> Iterator[Callable[..., Round]]:
    """Asks a process without real-time rights for a round: what it starts has none either."""
    with ProcessPoolExecutor(1, get_context("spawn"), give_up) as pool:

        def ask(loop: Callable[[HapticDevice | Path, float], tuple[Round, bool]], on: HapticDevice | Path) -> Round:
            found, real_time = pool.submit(loop, on, PLAIN_S).result()
            if real_time:
                raise RuntimeError(f"real-time rights could not be given up by user {os.getuid()}")
            return found

        yield ask

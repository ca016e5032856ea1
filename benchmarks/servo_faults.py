"""What goes wrong around a force loop: how soon the force is gone, and what many scenes leave behind."""

import os
import signal
import statistics
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from tangible_core.servo import Safety, Servo

from .figures import Figure, judged
from .servo_loops import touch
from .tests_path import Circling, Failing, FaultyTouch

RUNS, SWAPS = 10, 5000
LIMITS = Safety(ramp_s=0, max_step_n=10)


def section() -> str:
    """Return the section as Markdown."""
    return "\n".join(["A Python law that pushes with 1 N at once; force as the device has it.", "", *judged(figures())])


def figures() -> Iterator[Figure]:
    """Each fault several times, the worst of them; then 5,000 scenes in one session."""
    with tempfile.TemporaryDirectory() as folder:
        record = Path(folder) / "force"
        worst_s = max(_interrupted(record, run / RUNS) for run in range(1, RUNS + 1))
        yield _figure("Ctrl-C while the loop starts, or within a second after", 0.05, worst_s)
        worst_s = max(_gone_s(record, FaultyTouch(), _sigterm) for _ in range(RUNS))
        yield _figure("SIGTERM to the loop's process", 0.05, worst_s)
        worst_s = max(_gone_s(record, FaultyTouch(), _sigstop) for _ in range(RUNS))
        yield _figure("SIGSTOP to the loop's process: it is killed, and the device let go", 0.35, worst_s)
        worst_s = max(_gone_s(record, FaultyTouch("blocks"), _nothing) for _ in range(RUNS))
        yield _figure("a law that blocks in its 100th tick", 0.35, worst_s)
    yield from _swaps()


def _figure(what: str, bound_s: float, worst_s: float) -> Figure:
    bound = f"no force after {1e3 * bound_s:g} ms"
    return Figure(what, bound, f"{1e3 * worst_s:.0f} ms, worst of {RUNS}", worst_s <= bound_s)


def _interrupted(record: Path, share: float) -> float:
    """Seconds from Ctrl-C, at this share of two seconds after the start was begun, to no force."""
    record.unlink(missing_ok=True)
    sent_s: list[float] = []

    def interrupt() -> None:
        sent_s.append(time.monotonic())
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)  # wakes it, asleep as it may be

    timer = threading.Timer(2 * share, interrupt)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        timer.start()
        with Servo(FaultyTouch(), Failing(fault="none", record=str(record)), LIMITS):
            time.sleep(60)
    except KeyboardInterrupt:
        pass
    timer.join()
    return max(0.0, _written_s(record) - sent_s[0])


def _gone_s(record: Path, law: FaultyTouch, fault: Callable[[Servo], None]) -> float:
    record.unlink(missing_ok=True)
    device = Failing(fault="none", record=str(record), simulated=False)
    with Servo(law, device, LIMITS) as servo:
        while servo.report().ticks < 99:
            time.sleep(0.001)
        at_s = time.monotonic()
        fault(servo)
        while servo.running:
            time.sleep(0.001)
        return _written_s(record) - at_s


def _written_s(record: Path) -> float:
    """When the device was last given another force, which is none, on the monotonic clock."""
    if not record.exists():
        return 0.0
    assert float(record.read_text()) == 0
    return record.stat().st_mtime + time.monotonic() - time.time()


def _sigterm(servo: Servo) -> None:
    os.kill(servo.process_id, signal.SIGTERM)


def _sigstop(servo: Servo) -> None:
    os.kill(servo.process_id, signal.SIGSTOP)


def _nothing(servo: Servo) -> None:
    pass


def _swaps() -> Iterator[Figure]:
    for name, device in {"all compiled": Circling(), "a device that Python asks": Circling(exchanges=True)}.items():
        scenes, seconds = [touch(), touch()], []
        with Servo(scenes[0], device, LIMITS) as servo:
            for i in range(SWAPS + 100):
                if i == 100:
                    before = _usage(servo.process_id)
                begun_s = time.monotonic()
                servo.swap(scenes[i % 2])
                seconds.append(time.monotonic() - begun_s)
            descriptors, megabytes = (b - a for a, b in zip(before, _usage(servo.process_id), strict=True))
        yield Figure(
            f"{SWAPS} scenes of 1024 x 1024, one after the other, {name}",
            "descriptors +-2, memory +-10 MB",
            f"{descriptors:+d}, {megabytes:+.1f} MB; {1e3 * statistics.median(seconds):.1f} ms each",
            abs(descriptors) <= 2 and abs(megabytes) <= 10,
        )


def _usage(process: int) -> tuple[int, float]:
    of = Path(f"/proc/{process}")
    kibibytes = of.joinpath("status").read_text().partition("RssAnon:")[2].split()[0]
    return len(list(of.joinpath("fd").iterdir())), int(kibibytes) / 1000

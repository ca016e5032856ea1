"""The worker as a process: stopping it leaves the loop as it is; one that does not start is not started for ever."""

import asyncio
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from sessions import Heard
from tangible_core.runtime.child_process import command
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.prestart import _prestarted, prestart_worker, take_worker_process
from tangible_ui.requests import REQUESTS
from tangible_ui.state.session import Session
from tangible_ui.worker import Worker
from tangible_ui.worker.handle import WorkerAbsent, WorkerKilled
from waiting import LONGEST_S, happened

SLOW = """\
scene: builtin/motorcycle
depth: {use: luminance}
render: {use: penalty}
"""


def test_stopped_job_ends_at_once_and_the_loop_goes_on(tmp_path: Path):
    async def check() -> None:
        session, tab = Session(tmp_path, Feeling("worker-process"), []), Heard()
        session.enter(tab)

        async def ask(name: str, **told: Any) -> Any:
            return await REQUESTS[name](session, tab, **told)

        try:
            await asyncio.to_thread(session.feeling.start)
            await ask("edit", text=SLOW)
            await ask("make")
            felt, servo = session.feeling.felt, session.feeling.servo
            assert felt is not None
            assert servo is not None
            await ask("set", changes={"depth.use": "ssd", "depth.window_px": 19})
            making = asyncio.ensure_future(ask("make"))
            await happened(lambda: any(each["event"] == "stage" and each["method"] == "ssd" for each in tab.events))
            assert not making.done()
            ticks, swapped = servo.ring.count, tab.names().count("touch")
            await ask("stop_making")
            await making
            assert tab.last("made")["outcome"] == "stopped"
            said = await ask("set", changes={"render.stiffness_n_per_m": 300})  # quick work waits for the new one
            assert said["complaints"] == []
            assert session.feeling.felt is felt
            assert session.feeling.running
            await happened(lambda: servo.ring.count - ticks > 100)
            assert tab.names().count("touch") == swapped
            await ask("undo")
            await ask("undo")
            await ask("make")
            assert tab.last("made")["outcome"] == "made"
            assert session.feeling.felt is not felt
        finally:
            await session.close()

    asyncio.run(check())


def test_worker_that_does_not_start_is_tried_three_times(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    async def check() -> None:
        started: list[str] = []

        def broken(module: str) -> list[str]:
            started.append(module)
            return [sys.executable, "-c", "raise SystemExit('no such library')"]

        monkeypatch.setattr("tangible_ui.prestart.command", broken)
        heard: list[Any] = []
        worker = Worker(tmp_path, heard.append)
        try:
            with pytest.raises(WorkerAbsent, match="no such library"):
                while True:
                    try:
                        await worker.ask("schema")
                    except WorkerKilled:
                        continue
            assert len(started) == 3
            assert [event.event for event in heard] == ["maker_gone"]
            with pytest.raises(WorkerAbsent):
                await worker.quick("schema")
            monkeypatch.setattr("tangible_ui.prestart.command", command)
            worker.try_again()
            assert "properties" in await worker.ask("schema")
            assert heard[-1].event != "maker_gone"
        finally:
            worker.close()

    asyncio.run(check())


def test_prestarted_worker_is_taken_once_or_killed():
    with prestart_worker():
        first = take_worker_process()
        second = take_worker_process()
        assert first.pid != second.pid
    assert first.poll() is None  # whoever took it ends it
    with prestart_worker():
        unused = _prestarted[0]
    assert unused.poll() is not None
    for each in (first, second):
        with each:
            each.kill()


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="only Linux has a niceness for each thread")
def test_long_jobs_alone_have_a_low_priority():
    code = (
        "import os, queue, threading; from tangible_ui.worker import process, messages\n"
        "process.answer = lambda worker_state, ask: ask\n"
        "class Sender:\n    def say(self, said): heard.put(said)\n"
        "heard, lanes = queue.Queue(), {True: queue.SimpleQueue(), False: queue.SimpleQueue()}\n"
        "work = [threading.Thread(target=process._work, args=(None, lane, Sender(), quick), daemon=True)"
        " for quick, lane in lanes.items()]\n"
        "[each.start() for each in work]\n"
        "for _ in range(3):\n    lanes[True].put(1); heard.get(); lanes[False].put(2); heard.get()\n"
        "import time\n"
        "nice = lambda each: os.getpriority(os.PRIO_PROCESS, each.native_id)\n"
        "end = time.monotonic() + 100\n"
        "while nice(work[1]) < process.NICENESS and time.monotonic() < end: time.sleep(0.01)\n"
        "print(nice(work[0]), nice(work[1]), os.getpriority(os.PRIO_PROCESS, 0))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=LONGEST_S, check=False)
    quick, long, main = map(int, done.stdout.split() or [0, 0, 0])
    assert (long, main) == (10, 10), done.stderr
    assert quick < 10

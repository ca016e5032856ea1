"""Workers that die, a batch that is killed, other machines: no result is lost, and no process is left."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import psutil
import pytest

import dask_imported  # noqa: F401
import farm_work
from command_line import tangible
from ctrl_c import HEARING
from farm_here import Here
from pictures import write_png
from tangible_batch import batch, farm
from tangible_batch import running as running_batch
from tangible_batch.farm import Farm
from tangible_core import Pipeline
from tangible_core.errors import BatchError
from waiting import until

CONFIG = "scene: builtin/brick\nwant: relief\ndepth: luminance\nworkspace: {width_m: 0.04}\n"


@pytest.fixture(autouse=True)
def importable(monkeypatch: pytest.MonkeyPatch):
    helpers = str(Path(__file__).parents[2] / "helpers")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [helpers, os.environ.get("PYTHONPATH")])))


def archive(folder: Path, count: int) -> Path:
    folder.joinpath("archive").mkdir()
    for number in range(count):
        pixels = np.random.default_rng(number).integers(0, 256, (24, 32), np.uint8)
        write_png(folder / f"archive/p{number}.png", pixels)
    folder.joinpath("mine.yaml").write_text(CONFIG)
    return folder / "archive"


def command(*words: str) -> list[str]:
    program = [sys.executable, "-c", "from tangible_core.cli import main; main()"]
    return [*HEARING, *program, "batch", "mine.yaml", "--over", "archive", "--workers", "2", *words]


def rows_in(out: Path) -> list[dict]:
    return [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()]


def test_farm_with_a_dying_worker_loses_no_other_job():
    with Farm(2) as two:
        assert {port.laddr.ip for each in family() for port in each.net_connections() if port.status == "LISTEN"} == {
            "127.0.0.1"
        }
        done = list(two.map(farm_work.square, range(24), chunk=4))
        assert sorted(each.job for each in done) == list(range(24))
        assert [each.job for each in done if each.death] == [7]
        assert "its worker died of it, twice" in next(each.death for each in done if each.death)
        assert all(each.result == each.job**2 for each in done if not each.death)

        assert [each.result for each in two.map(farm_work.square, [3] * 6)] == [9] * 6, "equal jobs are not one"
        [raised] = two.map(farm_work.square, ["seven"])  # its worker lives: the words are those of the error
        assert raised.death.startswith("TypeError: ")


@pytest.mark.whole
def test_farm_whose_workers_are_killed_grow_old_or_hang_loses_no_job(monkeypatch: pytest.MonkeyPatch):
    with Farm(2) as two:
        workers = set[int]()

        def both_workers_are_back() -> bool:  # one of them may be slow to start
            workers.update(each.result for each in two.map(farm_work.slow, range(12)))
            return len(workers) == 2

        until(both_workers_are_back)
        flow = two.map(farm_work.slow, range(40))
        seen = [next(flow) for _ in range(3)]
        for worker in workers:  # every worker at once
            os.kill(worker, signal.SIGKILL)
        seen += flow
        assert sorted(each.job for each in seen) == list(range(40))
        assert not any(each.death for each in seen)

        with monkeypatch.context() as soon:
            soon.setattr(farm, "FRESH_AFTER", 10)
            anew = list(two.map(farm_work.slow, range(40)))
        assert sorted(each.job for each in anew) == list(range(40))
        assert len({each.result for each in anew}) == 4

        held = {each.job: each.death for each in two.map(farm_work.stuck, range(6), chunk=2, timeout_s=1.5)}
        assert held == {0: "", 1: "", 2: "took longer than 1.5 s, twice, and was ended", 3: "", 4: "", 5: ""}


def test_farm_without_a_scheduler_at_the_address_is_refused(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(farm, "CONNECT_S", 1)
    with pytest.raises(BatchError, match=r"--scheduler tcp://127\.0\.0\.1:9: nothing answers there"):
        Farm(1, scheduler="tcp://127.0.0.1:9")


@pytest.mark.whole
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT])
def test_ended_batch_leaves_no_worker_and_continues(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, end: signal.Signals
):
    """The program that hands out the scenes is killed, and its workers end by themselves; or Ctrl-C, which all hear."""
    archive(tmp_path, 60)
    rows = tmp_path / "out/mine-batch/rows.jsonl"
    with (tmp_path / "noise").open("w") as noise:
        first = subprocess.Popen(command(), cwd=tmp_path, stdout=noise, stderr=noise, start_new_session=True)
    until(lambda: rows.exists() and rows.read_text().count("\n") >= 3)
    family = [child.pid for child in psutil.Process(first.pid).children(recursive=True)]
    assert len(family) >= 2
    if end == signal.SIGKILL:
        first.kill()
    else:
        os.killpg(first.pid, end)
    code = first.wait(60)
    until(lambda: not any(map(is_alive, family)))
    if end == signal.SIGINT:
        said = (tmp_path / "noise").read_text()
        assert code == 130, said
        assert "the same command continues from there" in " ".join(said.split())
        assert "Traceback" not in said
    kept = rows.read_text().count("\n")
    assert 3 <= kept < 60
    with rows.open("a") as file:
        file.write('{"id": "torn')
    monkeypatch.setattr(running_batch, "Farm", Here)  # the same whoever makes the rest
    second = tangible("batch", "mine.yaml", "--over", "archive", "--json", cwd=tmp_path)
    assert second.returncode == 0, second.stderr
    found = rows_in(rows.parent)
    assert len(found) == len({row["id"] for row in found}) == 60
    assert json.loads(second.stdout)["made"] == 60 - kept


@pytest.mark.whole
def test_scheduler_workers_make_the_scenes_and_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    folder = archive(tmp_path, 6)
    pipeline = Pipeline.from_yaml(tmp_path / "mine.yaml")
    rows = [{"id": path.stem, "scene.photo": str(path)} for path in sorted(folder.iterdir())]
    with running("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", tmp_path / "at.json"):
        until(lambda: (tmp_path / "at.json").exists() and (tmp_path / "at.json").read_text().endswith("}"))
        address = json.loads((tmp_path / "at.json").read_text())["address"]
        with pytest.raises(BatchError, match="has no workers; start some: dask worker tcp://"):
            list(batch(pipeline, rows, tmp_path / "out", scheduler=address))
        worker = ("worker", address, "--no-dashboard", "--local-directory", tmp_path, "--nthreads")
        with running(*worker, "1") as own:
            monkeypatch.setattr(farm, "installed_version", lambda: "0.0.1")
            until(lambda: not without_workers(address))
            with pytest.raises(BatchError, match=r"has tangible-images .*, and this is 0\.0\.1; install the same"):
                Farm(1, scheduler=address)
            monkeypatch.undo()
            made = list(batch(pipeline, rows, tmp_path / "out", scheduler=address))
            assert sorted(row["id"] for row in made if row["outcome"] == "ok") == [f"p{number}" for number in range(6)]
            assert own.poll() is None
            with running(*worker, "2"):
                until(lambda: "works on 2 scenes at once" in complaint(address))


def family() -> list[psutil.Process]:
    return [psutil.Process(), *psutil.Process().children(recursive=True)]


def without_workers(address: str) -> bool:
    return "has no workers" in complaint(address)


def complaint(address: str) -> str:
    try:
        Farm(1, scheduler=address).close()
    except BatchError as error:
        return str(error)
    return ""


@contextmanager
def running(what: str, *words: object) -> Iterator[subprocess.Popen[bytes]]:
    program = [sys.executable, "-m", f"distributed.cli.dask_{what}", *map(str, words)]
    process = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        for each in (*psutil.Process(process.pid).children(recursive=True), process):
            with suppress(psutil.NoSuchProcess):
                each.kill()
        process.wait()


def is_alive(process: int) -> bool:
    """Return False for zombies too."""
    with suppress(psutil.NoSuchProcess):
        return psutil.Process(process).status() != psutil.STATUS_ZOMBIE
    return False

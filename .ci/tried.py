"""Use the installed program as people do, in this folder, and write what came out as `tried.json`.

Run it with the Python into which the wheel was installed, in an empty folder: `python tried.py CONFIGS [STEP...]`.
Every command has a limit of time: one that hangs is written down, and the next one begins.
"""

import hashlib
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

LIMIT_S = float(os.environ.get("TRIED_LIMIT_S", "900"))
CONFIGS = Path(sys.argv[1])
TESTS = os.environ.get("TRIED_TESTS", "")
"""A folder with pyproject.toml and tests/, and without the program: it is the installed one that is tested."""
ROOMS = ("compiled", "data", "mapping", "materials", "metrics", "relief")
"""The rooms of the core that calculate."""
CLEANING_S = 20
"""Time for what the workers of killed programs remove, s."""
COMMAND = [sys.executable, "-c", "from tangible_core.cli import main; main()"]


def tangible(*words: str) -> str:
    """Run a command of the program; return what it printed. Raises: AssertionError with the last line if it failed."""
    done = subprocess.run(
        [*COMMAND, *words], capture_output=True, timeout=LIMIT_S, stdin=subprocess.DEVNULL, check=False
    )
    said = done.stdout.decode("utf-8", "replace")
    lines = done.stderr.decode("utf-8", "replace").strip().splitlines() or ["it printed nothing"]
    assert done.returncode == 0, f"exit code {done.returncode}: {lines[-1]}"
    return said


def demo() -> str:
    """Make the built-in example, with digests of its products for a comparison with other systems."""
    tangible("demo", "--out", "demo", "--seconds", "2")
    return "to the end"


def run() -> str:
    """Run the file that the demo wrote."""
    tangible("run", "demo/config.yaml", "--out", "run")
    return "to the end"


def feel() -> str:
    """Feel on the mock device; the rate of ticks is by the loop's own clock."""
    words = "feel", "demo/config.yaml", "--seconds", "4", "--record", "felt.nc", "--json"
    figures = json.loads(tangible(*words))["figures"]
    rate_hz = (figures["ticks"] - 1) / figures["seconds"]
    assert abs(rate_hz - 1000) < 20, f"{rate_hz:.1f} ticks a second"
    return f"{rate_hz:.1f} ticks a second"


def ui() -> str:
    """Serve the page and fetch it."""
    with subprocess.Popen([*COMMAND, "ui", "--no-browser"], stdout=subprocess.PIPE, stdin=subprocess.DEVNULL) as server:
        ended = threading.Timer(LIMIT_S, server.kill)
        ended.start()
        try:
            assert server.stdout is not None
            words = next(each for each in iter(server.stdout.readline, b"") if b"http://" in each).decode().split()
            page = urllib.request.urlopen(next(each for each in words if each.startswith("http://"))).read().decode()
            assert "app.js" in page, "the page has no program"
        finally:
            server.kill()
            ended.cancel()
    return "page served"


def compare() -> str:
    """Compare two methods on one scene."""
    Path("compare.yaml").write_text("compare: depth\nmethods: [ssd, opencv-sgbm]\nscenes: [synthetic/steps]\n", "utf-8")
    tangible("compare", "compare.yaml", "--quick", "--out", "compared")
    return "to the end"


def export() -> str:
    """Write what a printer and a reader take."""
    tangible("export", "demo/config.yaml", "--to", "stl,heights,text", "--out", "exported")
    return "to the end"


def batch() -> str:
    """Run two pictures through one file."""
    import cv2
    import numpy as np

    y, x = np.mgrid[:120, :160]
    for number in range(2):
        cv2.imwrite(f"picture{number}.png", np.uint8(127 + 120 * np.sin(x / (9 + number)) * np.cos(y / 11)))
    tangible("batch", str(CONFIGS / "relief.yaml"), "--over", "picture*.png", "--out", "batched", "--workers", "1")
    return "to the end"


def video() -> str:
    """Read a film that OpenCV writes, and feel it."""
    import cv2
    import numpy as np

    writer = cv2.VideoWriter("film.avi", cv2.VideoWriter.fourcc(*"MJPG"), 10, (160, 120))
    for frame in range(20):
        picture = np.zeros((120, 160, 3), np.uint8)
        cv2.circle(picture, (40 + 4 * frame, 60), 30, (255, 255, 255), -1)
        writer.write(picture)
    writer.release()
    words = "scene: {video: film.avi}\ndepth: luminance\nwant: touch\nrender: {use: proxy}\ndevice: {use: mock}\n"
    Path("film.yaml").write_text(words, "utf-8")
    tangible("feel", "film.yaml", "--seconds", "2")
    return "to the end"


def interrupted() -> str:
    """Feel, and press Ctrl-C, or Ctrl-Break on Windows, in the stroke: what was felt is kept."""
    for seconds in (3, 30):  # a busy machine begins to feel later
        recording = _broken_off(seconds)
        if recording.peak_force_n > 0:
            break
    assert recording.peak_force_n > 0, "nothing was felt"
    assert recording.stopped.startswith("interrupted"), f"it was stopped by: {recording.stopped}"
    return f"the stroke of {recording.time_s[-1]:.1f} s is kept"


def _broken_off(after_s: float) -> Any:
    """Return the recording of a stroke that a key breaks off so long after its file is there."""
    path = Path("broken_off.nc")
    path.unlink(missing_ok=True)
    words = "feel", "demo/config.yaml", "--seconds", "60", "--record", path.name
    windows = sys.platform == "win32"
    group = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP} if windows else {}
    with subprocess.Popen([*COMMAND, *words], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, **group) as program:
        ended = threading.Timer(LIMIT_S, program.kill)
        ended.start()
        while program.poll() is None and not path.exists():
            time.sleep(0.1)
        time.sleep(after_s)
        try:
            program.send_signal(signal.CTRL_BREAK_EVENT if windows else signal.SIGINT)
        except SystemError as error:  # what Python makes of a console that takes no keys, as wine's without a window
            program.kill()
            raise AssertionError(f"no key could be pressed: {error.__cause__}") from error
        said = program.communicate()[1].decode("utf-8", "replace").strip().splitlines()
        ended.cancel()
    assert program.returncode == 130, f"exit code {program.returncode}: {said[-1:]}"
    from tangible_core.session import Recording

    return Recording.load(path)


def held() -> str:
    """Write over a file that another program holds open without sharing it, which Windows alone refuses."""
    if sys.platform != "win32":
        return "does not apply"
    import ctypes

    from tangible_core.files import writing

    path = Path("held.txt").absolute()
    path.write_text("before", "utf-8")
    kernel = ctypes.windll.kernel32
    kernel.CreateFileW.restype = ctypes.c_void_p
    handle = kernel.CreateFileW(str(path), 0x80000000, 0, None, 3, 0, None)
    try:
        writing.write_text(path, "after")
    except Exception as error:  # noqa: BLE001 - its words are what is looked at
        said = str(error)
    else:
        said = ""
    finally:
        kernel.CloseHandle(ctypes.c_void_p(handle))
    assert "held.txt" in said and "open" in said, f"it said {said!r}"
    assert path.read_text("utf-8") == "before", "the file was changed"
    writing.write_text(path, "after")
    return "refused with a sentence, and written once it was closed"


def console() -> str:
    """Print every text of methods, and a mistake, to a console of 1981, which has no Greek but a few letters."""
    for words in (["plugins", "show", "depth", "semi-global"], ["plugins"], ["run", "nothere.yaml"]):
        done = subprocess.run(
            [*COMMAND, *words], env={**os.environ, "PYTHONIOENCODING": "cp437"}, capture_output=True,
            timeout=LIMIT_S, stdin=subprocess.DEVNULL, check=False,
        )  # fmt: skip
        said = (done.stdout + done.stderr).decode("cp437")
        assert done.returncode == (2 if "run" in words else 0), said[-200:]
        assert "Traceback" not in said and "UnicodeEncodeError" not in said, said[-200:]
    return "to the end"


def rooms() -> str:
    """Run the fast tests of the rooms that calculate, where tests were given."""
    words = "-m", "pytest", "-q", "-n", "0", "-m", "fast", "-o", "timeout=3600", "-p", "no:cacheprovider"
    folders = [f"tests/core/{room}" for room in ROOMS]
    done = subprocess.run(
        [sys.executable, *words, *folders], cwd=TESTS, capture_output=True, timeout=LIMIT_S, text=True, check=False
    )
    last = (done.stdout.strip() or done.stderr.strip()).splitlines()[-1]
    assert done.returncode == 0, last
    return last


STEPS: list[Callable[[], str]] = [demo, run, feel, export, ui, compare, batch, video, interrupted, held, console, rooms]


def digests() -> dict[str, str]:
    """Return the digest of each array of the demo's products."""
    import numpy as np

    found: dict[str, str] = {}
    for name in ("disparity", "segments", "surface", "recording"):
        with np.load(Path("demo") / f"{name}.npz") as product:
            for each in product.files:
                if product[each].dtype.kind in "fiub":
                    found[f"{name}.{each}"] = hashlib.sha256(product[each].tobytes()).hexdigest()[:16]
    return found


def left(before: set[str]) -> list[str]:
    """Return what lies in the temporary folder now, and did not before."""
    now = {each.name for each in Path(tempfile.gettempdir()).iterdir()}
    return sorted(each for each in now - before if each.startswith("tangible"))


def main() -> None:
    """Try every step, or those that are named."""
    wanted = sys.argv[2:] or [each.__name__ for each in STEPS if each is not rooms or TESTS]
    before = {each.name for each in Path(tempfile.gettempdir()).iterdir()}
    result: dict[str, Any] = {
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "python": platform.python_version(),
        "date": time.strftime("%Y-%m-%d"),
        "steps": {},
    }
    for step in STEPS:
        if step.__name__ not in wanted:
            continue
        try:
            result["steps"][step.__name__] = step()
        except subprocess.TimeoutExpired:
            result["steps"][step.__name__] = f"FAILED: took longer than {LIMIT_S:g} s and was ended"
        except Exception as error:  # noqa: BLE001 - whatever fails is a result
            result["steps"][step.__name__] = f"FAILED: {type(error).__name__}: {error}"
        sys.stdout.write(f"{step.__name__}: {result['steps'][step.__name__]}\n")
        sys.stdout.flush()
        Path("tried.json").write_text(json.dumps(result, indent=1), "utf-8")
    result["left"] = left(before)
    for _ in range(CLEANING_S):
        if result["left"]:
            time.sleep(1)
            result["left"] = left(before)
    if Path("demo/surface.npz").exists():
        result["digests"] = digests()
    Path("tried.json").write_text(json.dumps(result, indent=1), "utf-8")


if __name__ == "__main__":
    main()

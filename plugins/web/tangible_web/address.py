"""The page's address, printed and opened before the server is imported: first requests wait in the socket."""

import os
import secrets
import socket
import threading
import webbrowser
from collections.abc import Generator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Self

from tangible_core.errors import ConfigError
from tangible_core.runtime import stream

HOST = "127.0.0.1"
HTTP_PORT = 80  # the port that an address may leave out
# Complaint of everything that needs the built page.
NOT_BUILT = (
    "the page was not built when this was installed, as npm could not be reached; install again where it can (`pip "
    "install --force-reinstall --no-deps .`), or build it: `npm ci && npm run build` in plugins/web"
)


@dataclass(frozen=True)
class Address:
    """A socket that listens on this machine alone, and the key that every request must carry."""

    listening: socket.socket
    key: str

    @classmethod
    @contextmanager
    def of(cls, port: int) -> Generator[Self]:
        """Listen on a port; 0 takes a free one. Raises: ConfigError if the page was not built, or the port is taken."""
        if not (static() / "app.js").is_file():
            raise ConfigError(NOT_BUILT)
        try:
            listening = socket.create_server((HOST, port))
        except OSError as error:
            why = os.strerror(error.errno) if error.errno else error
            raise ConfigError(f"--port {port}: {why}; 0 takes a free one") from error
        with listening:
            yield cls(listening, new_key())

    @classmethod
    @contextmanager
    def again(cls, memory: Path) -> Generator[Self]:
        """Listen on the address of a killed program, so that its pages return; else on a free port."""
        port, key = _recall(memory)
        with ExitStack() as stack:
            try:
                new = stack.enter_context(cls.of(port))
            except ConfigError:
                if not port:
                    raise
                yield stack.enter_context(cls.of(0))  # the other program lives
                return
            address = cls(new.listening, key or new.key)
            _remember(memory, address)
            stack.callback(memory.unlink, missing_ok=True)
            yield address

    @property
    def port(self) -> int:
        """The port that listens."""
        return self.listening.getsockname()[1]

    @property
    def hosts(self) -> frozenset[str]:
        """The names of this machine under which a browser may reach the server, in small letters, with the port."""
        ports = (f":{self.port}", "") if self.port == HTTP_PORT else (f":{self.port}",)
        return frozenset(f"{name}{port}" for name in (HOST, "localhost", "[::1]") for port in ports)

    def announce(self, browser: bool) -> None:
        """Print the address. browser: open it too."""
        url = f"http://{HOST}:{self.port}/?token={self.key}"
        print(url, file=stream(), flush=True)
        if browser:  # in a thread, as a browser in the terminal blocks until it ends
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()


def _recall(memory: Path) -> tuple[int, str]:
    """Return port and key; 0 and nothing without a file that holds both."""
    try:
        port, key = memory.read_text("utf-8").split()
        return (int(port), key) if 0 < int(port) < 2**16 else (0, "")
    except (OSError, ValueError):
        return 0, ""


def _remember(memory: Path, address: Address) -> None:
    with suppress(OSError):  # the next start takes another address
        memory.parent.mkdir(parents=True, exist_ok=True)
        memory.unlink(missing_ok=True)
        with os.fdopen(os.open(memory, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600), "w", encoding="utf-8") as file:
            file.write(f"{address.port} {address.key}")


def new_key() -> str:
    """Return a new key of 128 bits, or $TANGIBLE_UI_TOKEN, which tests set."""
    return os.environ.get("TANGIBLE_UI_TOKEN") or secrets.token_urlsafe(16)


def static() -> Path:
    """Return the folder of the built page; it does not exist if the page was not built."""
    return Path(str(files("tangible_web"))) / "static"


def page_file(name: str) -> str:
    """Return the text of a file of the built page. Raises: ConfigError if the page was not built."""
    try:
        return (static() / name).read_text("utf-8")
    except FileNotFoundError as error:
        raise ConfigError(NOT_BUILT) from error

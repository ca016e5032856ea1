"""Files that pages send, kept on this machine so that a pipeline file that names them finds them later."""

import asyncio
import hashlib
import os
import re
import secrets
import shutil
from collections.abc import AsyncIterator
from pathlib import Path
from typing import final

from tangible_core.errors import ConfigError, quoted
from tangible_core.files import MAX_BYTES, in_words

# Maximum number of files of one drop: two pictures with their maps, or a pipeline file and its pictures.
MAX_FILES = 16
MAX_NAME = 120
AT_ONCE_BYTES = 1 << 22  # bytes collected before they are written
WRONG = re.compile(r'[\x00-\x1f\x7f<>:"/\\|?*]')  # characters that some system does not allow in file names


@final
class UploadStore:
    """A store of batches of files; a complete batch gets a folder named by its content, once."""

    def __init__(self, folder: Path, incoming: Path) -> None:
        """folder: of complete batches. incoming: of incomplete ones; the end of the program removes it."""
        self._folder, self._incoming = folder, incoming

    def batch(self) -> str:
        """Begin a batch, and return its name."""
        name = secrets.token_hex(8)
        (self._incoming / name).mkdir(parents=True)
        return name

    async def put(self, batch: str, name: str, body: AsyncIterator[bytes]) -> None:
        """Store a file; a broken transfer leaves nothing. Raises: ConfigError, also for a full disk."""
        path = self._place(batch, name)
        try:
            with path.open("wb") as file:
                waiting, size = bytearray(), 0
                async for part in body:
                    size += len(part)
                    if size > MAX_BYTES:
                        raise ConfigError(f"{name}: holds more than {in_words(MAX_BYTES)}; open a smaller one")
                    waiting += part
                    if len(waiting) >= AT_ONCE_BYTES:
                        await asyncio.to_thread(file.write, waiting)
                        waiting = bytearray()
                await asyncio.to_thread(file.write, waiting)
        except OSError as error:
            path.unlink(missing_ok=True)
            raise ConfigError(f"{name}: cannot be kept: {error.strerror or error}; free some space") from error
        except BaseException:
            path.unlink(missing_ok=True)
            raise

    def keep(self, batch: str) -> list[Path]:
        """Move a complete batch to its folder, and return its files. Raises: ConfigError as `put`."""
        here = self._batch(batch)
        names = sorted(path.name for path in here.iterdir())
        there = self._folder / _digest([here / name for name in names])
        try:
            self._folder.mkdir(0o700, parents=True, exist_ok=True)
            if not there.is_dir():
                part = there.with_name(f".{there.name}-{os.getpid()}")
                shutil.rmtree(part, ignore_errors=True)
                shutil.move(here, part)
                part.replace(there)
        except OSError as error:
            raise ConfigError(f"{there}: cannot be written: {error.strerror or error}; free some space") from error
        finally:
            shutil.rmtree(here, ignore_errors=True)
        return [there / name for name in names]

    def single(self, batch: str) -> Path:
        """Return the only file of a batch. Raises: ConfigError if there is not exactly one."""
        files = list(self._batch(batch).iterdir())
        if len(files) != 1:
            raise ConfigError(f"{len(files)} files were sent where one is wanted; send one")
        return files[0]

    def drop(self, batch: str) -> None:
        """Remove a batch."""
        shutil.rmtree(self._batch(batch), ignore_errors=True)

    def _batch(self, batch: str) -> Path:
        here = self._incoming / batch
        if not re.fullmatch(r"[0-9a-f]{16}", batch) or not here.is_dir():
            raise ConfigError("these files were not sent, or are no longer waiting; send them again")
        return here

    def _place(self, batch: str, name: str) -> Path:
        here = self._batch(batch)
        path = here / name
        if not name.strip(". ") or WRONG.search(name) or len(os.fsencode(name)) > MAX_NAME:
            raise ConfigError(f"{quoted(name)}: a file of this name cannot be kept; give it a short, plain one")
        if not path.exists() and len(list(here.iterdir())) >= MAX_FILES:
            raise ConfigError(f"more than {MAX_FILES} files at once; open a pair, or a pipeline file and its pictures")
        return path


def _digest(paths: list[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(f"{path.name}\0{path.stat().st_size}\0".encode())
        with path.open("rb") as file:
            while part := file.read(1 << 20):
                digest.update(part)
    return digest.hexdigest()[:16]

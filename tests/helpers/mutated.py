"""Files damaged by chance, the same ones again by their number, and processes that read them and may die of it."""

import base64
import json
import mmap
import os
import random
import re
import signal
import struct
import sys
import traceback
import warnings
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from tangible_core.errors import TangibleError

CPU_S, STILL_S = 20, 60
"""Time limits of one file: of the processor, and by the clock, for a reader that waits for ever."""
MEMORY = 3 << 30
"""Bytes that the reading may add to a process: twice what a file may hold."""
TOKENS = [
    "nan", ".nan", "NaN", "1e999", "-1e999", ".inf", "-Infinity", "-3", "-0", "0", "0.5", "1e-320", "true", "false",
    "null", "~", '""', "''", "[]", "{}", "[[[[]]]]", "[1, [2, 3]]", "{a: {b: 1}}", "9" * 40, "9" * 400, "9" * 5000,
    "0x" + "f" * 70,
    "9223372036854775808", "-2147483649", "4294967296", "1_000", "0o17", "1:30", "²", "٣", "é", "\u2028", "\x00",
    "\x1b[31m",
    "\\ud800", "\\u0000", "\ufeff", '"', "'", "\\", "*a", "&a", "!!python/object:os.system", "!!int word", "!!binary x",
    "2024-13-45", "<<", "?", "---", "...", "%YAML", "../../etc/passwd", "/dev/zero", "~nobody/x", "a" * 300, "x" * 5000,
    "[" * 60, "[" * 3000, "{" * 3000, "]" * 60, "-", ":", "#", ",", "\t", "\r", "|", ">", "=", "builtin/brick", "word",
]  # fmt: skip
"""Words that people and programs do not expect where a number or a name stands."""
WORD = re.compile(rb"[\w.+-]+")
NUMBERS = (0, 1, -1, 2, 127, 128, 255, 32767, 32768, 65535, 2**31 - 1, -(2**31), 2**32 - 1)


class Reader(NamedTuple):
    """Valid files of one format, and the function that reads one of them."""

    make: Callable[[Path], object]
    """Writes the files into a folder."""
    read: Callable[[Path], object]
    """Reads the file that is damaged."""
    files: str = "*"
    """Pattern of the files that are damaged; others lie beside them."""
    text: bool = False
    """True for files that people write: words are replaced more often than bytes."""
    repair: Callable[[bytes], bytes] | None = None
    """Puts check sums right, for half of the files: else a reader looks no further."""


class Finding(NamedTuple):
    """A file that is neither read nor refused as a mistake of the user."""

    number: int
    name: str
    what: str
    data: str
    """The file, packed, if it is short."""


def mutate(data: bytes, chance: random.Random, text: bool) -> bytes:
    """Damage a file, mostly at one place."""
    for _ in range(min(8, 1 + int(chance.expovariate(1)))):
        change = chance.choice(TEXT_CHANGES if text and chance.random() < 0.8 else BYTE_CHANGES)
        data = change(data, chance)
    return data


def _span(data: bytes, chance: random.Random) -> tuple[int, int]:
    start = chance.randrange(len(data) + 1)
    return start, min(len(data), start + int(2 ** chance.uniform(0, 9)))


def _flip(data: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(data) or 1)
    return data[:at] + bytes(byte ^ 1 << chance.randrange(8) for byte in data[at : at + 1]) + data[at + 1 :]


def _set(data: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(data) or 1)
    return data[:at] + bytes([chance.choice((0, 1, 127, 128, 255, chance.randrange(256)))]) + data[at + 1 :]


def _number(data: bytes, chance: random.Random) -> bytes:
    """Replace two, four or eight bytes by a number at which programs go wrong."""
    order, kind = chance.choice("<>"), chance.choice("HIQ")
    size, at = struct.calcsize(order + kind), chance.randrange(len(data) or 1)
    number = chance.choice((*NUMBERS, chance.getrandbits(8 * size), len(data))) % (1 << 8 * size)
    return data[:at] + struct.pack(order + kind, number) + data[at + size :]


def _cut(data: bytes, chance: random.Random) -> bytes:
    return data[: chance.randrange(len(data) + 1)]


def _remove(data: bytes, chance: random.Random) -> bytes:
    start, end = _span(data, chance)
    return data[:start] + data[end:]


def _repeat(data: bytes, chance: random.Random) -> bytes:
    start, end = _span(data, chance)
    return data[:end] + data[start:end] * chance.choice((1, 1, 2, 50)) + data[end:]


def _insert(data: bytes, chance: random.Random) -> bytes:
    start, end = _span(data, chance)
    return data[:start] + chance.randbytes(end - start) + data[start:]


def _copy(data: bytes, chance: random.Random) -> bytes:
    """Write a block over another place."""
    (start, end), at = _span(data, chance), chance.randrange(len(data) + 1)
    return data[:at] + data[start:end] + data[at + end - start :]


def _zero(data: bytes, chance: random.Random) -> bytes:
    start, end = _span(data, chance)
    return data[:start] + bytes([chance.choice((0, 255))]) * (end - start) + data[end:]


def _word(data: bytes, chance: random.Random) -> bytes:
    """Replace a word by an unexpected one, or by another of the file."""
    words = list(WORD.finditer(data))
    if not words:
        return data
    old, other = chance.choice(words), chance.choice(words)[0]
    new = other if chance.random() < 0.2 else chance.choice(TOKENS).encode()
    return data[: old.start()] + new + data[old.end() :]


def _put_word(data: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(data) + 1)
    return data[:at] + chance.choice(TOKENS).encode() + data[at:]


def _value(data: bytes, chance: random.Random) -> bytes:
    """Replace all that stands behind a colon, an equals sign, a comma or a tab, up to the end of its line."""
    marks = list(re.finditer(rb"[:=,\t](?=.)", data))
    if not marks:
        return data
    at = chance.choice(marks).end()
    end = data.find(b"\n", at)
    return data[:at] + b" " + chance.choice(TOKENS).encode() + data[end if end >= 0 else len(data) :]


def _lines(data: bytes, chance: random.Random) -> bytes:
    """Remove, repeat, exchange or indent a line."""
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    at, other = chance.randrange(len(lines)), chance.randrange(len(lines))
    line = lines[at]
    lines[at : at + 1] = chance.choice(
        ([], [line, line], [lines[other]], [b"  " + line], [line.lstrip()], [b"- " + line])
    )
    return b"".join(lines)


def _nest(data: bytes, chance: random.Random) -> bytes:
    """Open many brackets where a value begins."""
    marks = list(re.finditer(rb"[:=,\t] *(?=.)|^", data))
    at = chance.choice(marks).end()
    return data[:at] + chance.choice((b"[", b"{a: ", b'{"a":')) * chance.choice((30, 3000)) + data[at:]


def _no_utf_8(data: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(data) + 1)
    return data[:at] + chance.choice((b"\xff", b"\xc3", b"\xed\xa0\x80", b"\xff\xfe", b"\xef\xbb\xbf")) + data[at:]


BYTE_CHANGES = (
    _flip,
    _flip,
    _set,
    _set,
    _number,
    _number,
    _number,
    _cut,
    _remove,
    _repeat,
    _insert,
    _copy,
    _zero,
    _word,
)
TEXT_CHANGES = (_word, _word, _word, _put_word, _value, _value, _lines, _lines, _no_utf_8, _nest)


class Damage:
    """The damaged files of a reader, by their numbers."""

    def __init__(self, name: str, reader: Reader, folder: Path) -> None:
        """Write the valid files into a folder."""
        self.name, self.reader, self.folder = name, reader, folder
        reader.make(folder)
        self.valid = {path: path.read_bytes() for path in sorted(folder.rglob(reader.files)) if path.is_file()}

    def file(self, number: int) -> tuple[Path, bytes]:
        """Return the path and the content of a damaged file."""
        chance = random.Random(f"{self.name} {number}")
        path = chance.choice(list(self.valid))
        data = mutate(self.valid[path], chance, self.reader.text)
        return path, self.reader.repair(data) if self.reader.repair and chance.random() < 0.5 else data

    def findings(self, numbers: range) -> Iterator[Finding]:
        """Read these files in forks of this process, and yield what should not be."""
        at = mmap.mmap(-1, 8)
        while numbers:
            with (self.folder.parent / f"{self.folder.name}.findings").open("w+b") as report:
                with warnings.catch_warnings(action="ignore"):  # of a fork beside threads, which read nothing
                    fork = os.fork()
                if not fork:
                    self._read_all(numbers, at, report.fileno())
                ended = os.waitstatus_to_exitcode(os.waitpid(fork, 0)[1])
                report.seek(0)
                yield from (self._finding(*json.loads(line)) for line in report)
            number = int.from_bytes(at[:8], "little")
            if ended:
                path, _ = self.file(number)
                path.write_bytes(self.valid[path])
                died = {-signal.SIGPROF: f"more than {CPU_S} s", -signal.SIGALRM: f"stands still for {STILL_S} s"}
                how = died.get(ended) or (signal.Signals(-ended).name if ended < 0 else f"exit code {ended}")
                yield self._finding(number, f"ends the process: {how}")
            numbers = range(number + 1, numbers.stop) if ended else range(0)

    def read(self, number: int) -> object:
        """Read a damaged file in this process, and put the valid one back."""
        path, data = self.file(number)
        path.write_bytes(data)
        os.utime(path, ns=(number, number * 1_000_000))  # readers remember files by their time
        try:
            return self.reader.read(path)
        finally:
            path.write_bytes(self.valid[path])

    def _read_all(self, numbers: range, at: mmap.mmap, report: int) -> None:
        """Read files in a process of their own, and end it."""
        try:
            _bound()
            for number in numbers:
                at[:8] = number.to_bytes(8, "little")
                signal.setitimer(signal.ITIMER_PROF, CPU_S)
                signal.setitimer(signal.ITIMER_REAL, STILL_S)
                try:
                    self.read(number)
                except TangibleError as error:
                    what = "" if str(error).strip() else "says nothing"
                except BaseException as error:  # noqa: BLE001 - that is what is sought
                    what = _in_a_line(error)
                else:
                    what = ""
                if what:
                    os.write(report, json.dumps([number, what]).encode() + b"\n")
        except BaseException:  # noqa: BLE001 - the fork ends here
            traceback.print_exc()
            os._exit(99)
        os._exit(0)

    def _finding(self, number: int, what: str) -> Finding:
        path, data = self.file(number)
        packed = base64.b85encode(zlib.compress(data, 9)).decode()
        return Finding(number, path.name, what, packed if len(packed) < 3000 else "")


def _bound() -> None:
    """Leave this process as a user's is, with bounded memory and silent."""
    import faulthandler
    import resource

    import jaxtyping

    jaxtyping.config.update("jaxtyping_disable", True)
    warnings.simplefilter("ignore")
    faulthandler.disable()
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    os.dup2(nothing, 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if sys.platform != "linux":  # others have no such limit
        return
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + MEMORY, held + MEMORY))


def _in_a_line(error: BaseException) -> str:
    *_, last = traceback.extract_tb(error.__traceback__)
    ours = [frame for frame in traceback.extract_tb(error.__traceback__) if "tangible_" in frame.filename]
    where = " < ".join(f"{Path(frame.filename).name}:{frame.lineno}" for frame in [last, *ours[:-4:-1]])
    return f"{type(error).__name__}: {str(error)[:200]!r} at {where}"


def main(readers: Mapping[str, Reader], names: list[str], first: int, last: int) -> None:
    """Print what readers make of these files, a line for each kind of finding: for a person who mends them."""
    import tempfile
    import time

    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "seeds").mkdir()
            since_s = time.process_time() + sum(os.times()[2:4])
            damage = Damage(name, readers[name], Path(folder) / "seeds")
            kinds: dict[str, list[Finding]] = {}
            for finding in damage.findings(range(first, last)):
                kinds.setdefault(re.sub(r"'.*'", "...", finding.what), []).append(finding)
            took_s = time.process_time() + sum(os.times()[2:4]) - since_s
            count = sum(map(len, kinds.values()))
            died = sum(len(found) for what, found in kinds.items() if what.startswith("ends"))
            print(
                f"{name} | {last - first} | {died} | {count - died} | {1000 * took_s / (last - first):.1f} ms",
                flush=True,
            )
            for found in kinds.values():
                print("   ", len(found), found[0].number, found[0].name, found[0].what, file=sys.stderr, flush=True)

"""Broken requests of HTTP and broken frames of websockets, drawn at random: what no browser sends."""

import json
import socket
import struct
from collections.abc import Callable
from contextlib import suppress
from random import Random

from waiting import LONGEST_S

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10
REQUEST = json.dumps({"number": 1, "ask": "examples"}).encode()


def frame(kind: int, body: bytes = b"", *, last: bool = True, mask: bool = True, rsv: int = 0, size: int = -1) -> bytes:
    """A frame of a client, with a mask of zeros. size: what its head says; its own by default."""
    first, size, masked = last << 7 | rsv << 4 | kind, len(body) if size < 0 else size, mask << 7
    if size < 126:
        head = bytes([first, masked | size])
    elif size < 2**16:
        head = bytes([first, masked | 126]) + struct.pack(">H", size)
    else:
        head = bytes([first, masked | 127]) + struct.pack(">Q", size)
    return head + bytes(4 * mask) + body


FRAMES: tuple[Callable[[Random], bytes], ...] = (
    lambda r: frame(TEXT, b"\xff\xfe" + r.randbytes(r.randrange(20))),
    lambda r: frame(TEXT, REQUEST[:5] + b"\xc3", last=False) + frame(0, b"(" + r.randbytes(4)),
    lambda r: frame(BINARY, r.randbytes(r.choice([0, 1, 3, 24, 37, 125, 126, 127, 65535, 65536]))),
    lambda r: frame(BINARY, b"1", last=False) + frame(0, b"2", last=False) * r.randrange(200) + frame(0),
    lambda r: frame(r.choice([TEXT, BINARY]), b"x", size=r.choice([2**20 + 1, 2**31, 2**63 - 1, 2**63, 2**64 - 1])),
    lambda r: frame(r.choice([CLOSE, PING, PONG]), r.randbytes(r.choice([126, 200, 70000]))),
    lambda r: frame(r.choice([CLOSE, PING, PONG]), b"1234", last=False),
    lambda r: frame(
        CLOSE, struct.pack(">H", r.choice([0, 1, 999, 1004, 1005, 1006, 1015, 1016, 2999, 5000])) + b"\xff"
    ),
    lambda r: frame(CLOSE, r.randbytes(1)),
    lambda r: frame(r.choice([TEXT, BINARY]), r.randbytes(9), rsv=r.randrange(1, 8)),
    lambda r: frame(r.choice([TEXT, BINARY, PING]), REQUEST, mask=False),
    lambda r: frame(r.choice([3, 4, 7, 11, 15]), r.randbytes(5)),
    lambda r: frame(0, r.randbytes(5)),
    lambda r: frame(TEXT, b"a", last=False) + frame(TEXT, b"b"),
    lambda r: mutated(frame(TEXT, REQUEST) + frame(BINARY, r.randbytes(37)), r),
)
BODIES = (b"zz\r\nabc\r\n", b"-5\r\n", b"f" * 18 + b"\r\nx", b"5;x=\xff\r\nabcde\r\n0\r\n\r\n", b"1" * 9000)
SIZES = ("9" * 5000, "-1", "0x5", "", "\xb2", "5\r\nContent-Length: 6")
HEADERS = (
    "X: \0\xff",
    "\r\n".join(f"X{k}: 1" for k in range(5000)),
    "X: " + "x" * 300_000,
    "X: 1\r\n  folded\r\n : x",
    "Host: evil",
    "Transfer-Encoding: xchunked",
    "Connection: Upgrade\r\nUpgrade: h2c",
    "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 99\r\nSec-WebSocket-Key: x",
    *(f"Content-Length: {size}" for size in SIZES),
)
TARGETS = ("*", "http://[", "/%zz", "/\xff", "/a b", "/?" + "&" * 3000, "", "/\0")
VERBS = ("HEAD", "TRACE", "CONNECT", "PRI", "get", "X" * 9000, "\0", "")
REQUESTS: tuple[Callable[[Random, str, str], bytes], ...] = (
    lambda r, path, own: _request("GET", path, own, r.choice(HEADERS)),
    lambda r, path, own: _request("POST", path, own, "Transfer-Encoding: chunked", r.choice(BODIES)),
    lambda r, path, own: _request("POST", path, own, f"Content-Length: {r.choice(SIZES)}", b"abcde"),
    lambda r, path, own: _request("GET", r.choice(TARGETS), own),
    lambda r, path, own: _request(r.choice(VERBS), path, own),
    lambda r, path, own: _request("GET", path, own).replace(b"HTTP/1.1", r.choice([b"HTTP/9.9", b"HTTP/\xb2", b""])),
    lambda r, path, own: mutated(_request("GET", path, own), r),
)


def broken_frames(random: Random) -> bytes:
    """Frames that a websocket must refuse or ignore."""
    return random.choice(FRAMES)(random)


def broken_request(random: Random, path: str, host: str) -> bytes:
    """A request to this path that a server must refuse or read as something else."""
    return random.choice(REQUESTS)(random, path, f"Host: {host}\r\nOrigin: http://{host}")


def send_broken(random: Random, said: bytes, host: str, port: int) -> None:
    """Send bytes on a connection of their own, and end it in some way, with an answer read or not."""
    with socket.create_connection((host, port), timeout=LONGEST_S) as raw, suppress(OSError):
        raw.sendall(said)
        if random.random() < 0.3:
            raw.shutdown(socket.SHUT_WR)
        raw.settimeout(random.choice([0.001, 0.03]))
        while raw.recv(65536):
            pass
        if random.random() < 0.3:
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


def mutated(whole: bytes, random: Random) -> bytes:
    """These bytes with up to five others."""
    said = bytearray(whole)
    for _ in range(random.randrange(1, 6)):
        said[random.randrange(len(said))] = random.randrange(256)
    return bytes(said)


def _request(method: str, path: str, own: str, more: str = "", body: bytes = b"") -> bytes:
    lines = [f"{method} {path} HTTP/1.1", own, *([more] if more else []), "", ""]
    return "\r\n".join(lines).encode("latin-1") + body

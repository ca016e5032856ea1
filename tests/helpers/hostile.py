"""Files that are small and claim, or become, something large; and other files that no honest program writes."""

import math
import struct
import zipfile
import zlib
from pathlib import Path

SIDE = 11_300
"""Of a picture of 127 megapixels."""


def npy_header(shape: object, dtype: str = "<f8") -> bytes:
    """What stands before the numbers in an .npy file."""
    text = f"{{'descr': {dtype!r}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x02\x00" + struct.pack("<I", len(text)) + text


def npz(path: Path, compression: int = zipfile.ZIP_STORED, **members: bytes) -> Path:
    """An archive of such files."""
    with zipfile.ZipFile(path, "w", compression) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    return path


def npz_bomb(path: Path, **shapes: tuple[int, ...]) -> Path:
    """Zeros, about a thousandth of their size in the file: each block of the packed stream is the same."""
    block = 1 << 24
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    packed = packer.compress(bytes(block)) + packer.flush(zlib.Z_FULL_FLUSH)
    ended = zlib.compressobj(9, zlib.DEFLATED, -15).flush()
    with path.open("wb") as file:
        entries = b""
        for name, shape in shapes.items():
            header = npy_header(shape)
            first = zlib.compressobj(9, zlib.DEFLATED, -15)
            blocks = -(-8 * math.prod(shape) // block)
            data = first.compress(header) + first.flush(zlib.Z_FULL_FLUSH) + packed * blocks + ended
            size = len(header) + 8 * math.prod(shape)
            said = struct.pack("<5H3I2H", 20, 0, 8, 0, 0, 0, len(data), size, len(name) + 4, 0)
            entries += b"PK\x01\x02\x14\x00" + said + struct.pack("<3H2I", 0, 0, 0, 0, file.tell())
            entries += f"{name}.npy".encode()
            file.write(b"PK\x03\x04" + said + f"{name}.npy".encode() + data)
        end = struct.pack("<4H2IH", 0, 0, len(shapes), len(shapes), len(entries), file.tell(), 0)
        file.write(entries + b"PK\x05\x06" + end)
    return path


def tiff(
    path: Path, width: int, height: int, bits: int = 64, samples: int = 1, sample_format: int = 3,
    more: tuple[tuple[int, int], ...] = (), strip_rows: int = 100,
) -> Path:  # fmt: skip
    """A picture of zeros, all of whose strips lie at one place. more: tags that are told besides, before the others."""
    strip = zlib.compress(bytes(strip_rows * width * samples * bits // 8), 9)
    strips = -(-height // strip_rows)
    after = 8 + 2 + 12 * (11 + len(more)) + 4
    places = struct.pack(f"<{strips}I", *[after + 8 * strips] * strips)
    sizes = struct.pack(f"<{strips}I", *[len(strip)] * strips)
    tags = [
        *more, (256, width), (257, height), (258, bits), (259, 8), (262, 1 if samples == 1 else 2), (277, samples),
        (278, strip_rows), (284, 1), (339, sample_format),
    ]  # fmt: skip
    entries = [(tag, 1, value) for tag, value in tags]
    entries += [(273, strips, after), (279, strips, after + 4 * strips)]
    if strips == 1:  # what is no longer than its own place stands there
        entries[-2:] = [(273, 1, after + 8), (279, 1, len(strip))]
    entries.sort(key=lambda each: each[0])  # stable: what is told twice stays in its order
    table = b"".join(struct.pack("<HHII", tag, 4, count, value) for tag, count, value in entries)
    path.write_bytes(b"II*\0" + struct.pack("<IH", 8, len(entries)) + table + bytes(4) + places + sizes + strip)
    return path


LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{after}: &{after} [{', '.join([f'*{before}'] * 9)}]\n"
    for before, after in zip("abcdefgh", "bcdefghi", strict=True)
)
"""Nine lines; followed, half a billion values."""

YAML_BOMBS = {
    "aliases": LAUGHS.replace("i: &i", "scene: &i"),
    "aliases of mappings": LAUGHS.replace("[x, x, x, x, x, x, x, x, x]", "{p: q, r: s}").replace("i: &i", "scene: &i"),
    "lists in lists": "scene: " + "[" * 3000 + "]" * 3000,
    "mappings in mappings": "scene: " + "{a: " * 3000 + "1" + "}" * 3000,
    "blocks in blocks": "scene:\n" + "".join(f"{' ' * depth}a:\n" for depth in range(1, 400)),
    "keys of keys": "? " * 20 + "a",
    "a number of 5000 digits": "scene: " + "9" * 5000,
    "a number of 5000 digits in a block": "scene: builtin/brick\nworkspace: {width_m: " + "9" * 5000 + "}",
    "a number in base 16": "scene: 0x" + "f" * 5000,
    "a date that is none": "scene: 2024-13-45",
    "a time that is none": "scene: 2024-02-30T99:99:99Z",
    "the year 0": "scene: builtin/brick\nwant: 0000-00-00",
    "a list of itself": "scene: &a [*a]",
    "a mapping of itself": "&a\nscene: *a",
    "merged with itself": "scene: builtin/brick\ndepth: &a {<<: *a, use: x}",
    "a whole number that is none": "scene: !!int word",
    "a number that is none": "scene: !!float word",
    "a long word": "scene: " + "x" * 200_000,
    "a text without end": "scene: " + "x" * 3_000_000,
    "a colour of a terminal": 'scene: "\\e[31mred\\e[0m\\n\\u2028next"',
    "many unknown keys": "scene: builtin/brick\n" + "".join(f"key{number}: 1\n" for number in range(3000)),
}
"""What costs seconds, gigabytes, a traceback or a screen of text."""

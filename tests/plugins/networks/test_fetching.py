"""Networks come here whole, with the right digest, or not at all; else a broken download runs as a network."""

import hashlib
import io
import json
import os
import socket
import tarfile
import threading
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from subprocess import PIPE, Popen

import pytest

from command_line import tangible
from tangible_core.errors import ConfigError, OutputError
from tangible_core.runtime import command
from tangible_networks import fetching
from tangible_networks.card import Card, Package
from tangible_networks.fetching import FetchError, add_network, remove_network
from tangible_networks.store import KnownNetwork, chosen_networks, known_networks

CONTENT = b"a network" * 100_000
DIGEST = hashlib.sha256(CONTENT).hexdigest()


def network(folder: Path, **facts: object) -> KnownNetwork:
    given = {"file": "net.onnx", "sha256": DIGEST, "size_bytes": len(CONTENT), "output": {"means": "figure"}, **facts}
    return KnownNetwork("net", Card.model_validate(given), folder / "net.onnx")


def packed(**facts: object) -> Package:
    return Package.model_validate({"pypi": "no-such-package-here", "version": "1", "member": "in/net.onnx", **facts})


def wheel(path: Path, content: bytes = CONTENT) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("in/net.onnx", content)
    return path


@pytest.fixture
def models(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TANGIBLE_MODELS_DIR", str(tmp_path / "models"))
    return tmp_path / "models"


class Resuming(BaseHTTPRequestHandler):
    """Serves CONTENT; the first answer breaks off in the middle, later ones begin where they are asked to."""

    asked: list[str | None]

    def do_GET(self) -> None:
        start = self.headers["Range"]
        self.asked.append(start)
        begin = int(start.removeprefix("bytes=").rstrip("-")) if start else 0
        self.send_response(206 if start else 200)
        self.send_header("Content-Length", str(len(CONTENT) - begin))
        self.end_headers()
        self.wfile.write(CONTENT[begin:] if start else CONTENT[: len(CONTENT) // 2])

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@pytest.fixture
def server() -> Iterator[tuple[str, list[str | None]]]:
    Resuming.asked = []
    with HTTPServer(("127.0.0.1", 0), Resuming) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/net.onnx", Resuming.asked
        server.shutdown()


@pytest.mark.parametrize("pack", ["wheel", "npm", "plain"])
def test_file_brought_by_hand_becomes_the_network(tmp_path: Path, pack: str) -> None:
    source = wheel(tmp_path / "p.whl")
    if pack == "npm":
        source = tmp_path / "p.tgz"
        with tarfile.open(source, "w:gz") as archive:
            member = tarfile.TarInfo("package/in/net.onnx")
            member.size = len(CONTENT)
            archive.addfile(member, io.BytesIO(CONTENT))
    elif pack == "plain":
        source.write_bytes(CONTENT)
    new = network(tmp_path / "models", source=packed())
    add_network(new, source)
    assert new.path.read_bytes() == CONTENT
    assert new.state == "here"
    assert [path.name for path in new.path.parent.iterdir()] == ["net.onnx"]
    assert remove_network(new) and not new.path.exists()


@pytest.mark.parametrize(
    ("content", "member", "words"),
    [
        (b"something else", "in/net.onnx", "not the one that its card describes"),
        (CONTENT, "elsewhere.onnx", "no readable file elsewhere.onnx"),
    ],
)
def test_card_that_lies_leaves_nothing(tmp_path: Path, content: bytes, member: str, words: str) -> None:
    new = network(tmp_path / "models", source=packed(member=member))
    with pytest.raises(ConfigError, match=words):
        add_network(new, wheel(tmp_path / "p.whl", content))
    assert list(new.path.parent.iterdir()) == []


def test_what_is_converted_is_checked_before(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(fetching.CONVERSIONS, "hed", lambda path: path.read_bytes()[::-1])
    new = network(tmp_path / "models", source=packed(convert="hed", member_sha256=DIGEST), sha256="")
    with pytest.raises(ConfigError, match="not the one that its card describes"):
        add_network(new, wheel(tmp_path / "p.whl", b"another"))
    add_network(new, wheel(tmp_path / "q.whl"))
    assert new.path.read_bytes() == CONTENT[::-1]


@pytest.mark.parametrize("content", [CONTENT, b"another"])
def test_file_of_the_user_stays(tmp_path: Path, content: bytes) -> None:
    own = tmp_path / "own.part"
    own.write_bytes(content)
    with suppress(ConfigError):
        add_network(network(tmp_path / "models"), own)
    assert own.read_bytes() == content


def test_only_a_checked_address_and_a_right_file_are_taken(tmp_path: Path) -> None:
    new = network(tmp_path)
    assert new.state == "absent"
    new.path.write_bytes(CONTENT[:-1] + b"?")
    assert new.state == "damaged"
    for facts in ({"source": "http://x/net.onnx"}, {"source": "https://x/net.onnx", "sha256": ""}, {"source": ""}):
        with pytest.raises(FetchError, match="not downloaded"):
            add_network(network(tmp_path / "models", **facts))


def test_download_goes_on_where_it_stopped(tmp_path: Path, server: tuple[str, list[str | None]]) -> None:
    address, asked = server
    partial, seen = tmp_path / "net.onnx.part", list[int]()
    with pytest.raises(FetchError, match="goes on there"):
        fetching._download_address(address, partial, 0, lambda done, whole: None)
    half = partial.stat().st_size
    assert 0 < half < len(CONTENT)
    fetching._download_address(address, partial, 0, lambda done, whole: seen.append(whole))
    assert asked == [None, f"bytes={half}-"]
    assert partial.read_bytes() == CONTENT
    assert set(seen) == {len(CONTENT)}


def test_without_a_connection_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PIP_INDEX_URL", "file:///no/such/index/")
    new = network(tmp_path / "models", source=packed())
    with pytest.raises(FetchError, match=r"no-such-package-here 1 on PyPI cannot be fetched by pip: .*--from FILE"):
        add_network(new)
    assert list(new.path.parent.iterdir()) == []


def test_full_disk_is_told(tmp_path: Path) -> None:
    (tmp_path / "models").write_text("a file where the folder should be")
    with pytest.raises(OutputError, match="cannot be written"):
        add_network(network(tmp_path / "models"), wheel(tmp_path / "p.whl"))


def test_task_stands_for_networks_whose_cards_say_where_they_come_from(models: Path) -> None:
    assert [chosen_network.name for chosen_network in chosen_networks(["faces", "figure"])] == [
        "face-finder",
        "face-points",
        "u2netp",
    ]
    with pytest.raises(ConfigError, match="did you mean"):
        chosen_networks(["figur"])
    for known in known_networks().values():
        card = known.card
        assert card.licence and card.improves and card.title
        assert not card.verified or (card.sha256 and card.size_bytes and isinstance(card.source, Package))


def test_commands(models: Path, tmp_path: Path) -> None:
    models.mkdir()
    (models / "own.yaml").write_text(
        f"task: figure\nfile: net.onnx\nsha256: {DIGEST}\nsource: {{pypi: p, version: 1, member: in/net.onnx}}\n"
        "output: {means: figure}\n"
    )
    package = wheel(tmp_path / "p.whl")

    def called(*words: object) -> tuple[int, str]:
        done = tangible("networks", *words, cwd=tmp_path)
        return done.returncode, done.stdout

    assert {network["name"]: network["state"] for network in json.loads(called("--json")[1])}["own"] == "absent"
    assert called("add", "own")[0] == 2  # there is no terminal to ask on
    assert called("add", "own", "--json")[0] == 2, "nor does a program fetch without --yes"
    assert called("add", "own", "--from", package)[0] == 0
    assert called("check")[0] == 0
    (models / "net.onnx").write_bytes(b"?")
    assert called("check")[0] == 1
    assert json.loads(called("remove", "own", "--json")[1]) == ["own"]


@pytest.mark.whole
def test_fetch_for_another_program_reports_ends_and_stops(models: Path) -> None:
    """The page's server fetches so: an error is a sentence, and the end of the input is a stop."""
    models.mkdir()
    source = models / "given"
    source.write_bytes(CONTENT)
    (models / "mine.yaml").write_text(f"sha256: {DIGEST}\noutput: {{means: figure}}\n")
    (models / "slow.yaml").write_text("source: {pypi: none, version: 1, member: a}\noutput: {means: figure}\n")

    def fetch(*told: object, **environment: str) -> list[dict[str, str]]:
        begin = command("tangible_networks.fetching")
        with Popen(begin, stdin=PIPE, stdout=PIPE, env={**os.environ, **environment}) as process:
            assert process.stdin is not None and process.stdout is not None
            process.stdin.write(f"{json.dumps(told)}\n".encode())
            process.stdin.flush()
            reports = []
            for line in process.stdout:
                reports.append(json.loads(line))
                if environment:
                    process.stdin.close()
        return reports

    assert fetch(["mine"], str(source)) == [{"name": "mine", "done": 0, "whole": 0, "why": ""}]
    assert (models / "mine.onnx").read_bytes() == CONTENT
    assert "mien: no such network" in fetch(["mien"], None)[0]["why"]
    with socket.create_server(("127.0.0.1", 0)) as silent:  # a registry that never answers
        reports = fetch(["slow"], None, PIP_INDEX_URL=f"http://127.0.0.1:{silent.getsockname()[1]}/")
    assert "stopped on request" in reports[-1]["why"]
    assert not list(models.glob(".*"))

"""What page and server must call and pack alike: otherwise one takes a word or a frame of the other for another."""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from page_files import UI, WEB, node
from tangible_core.data import TICK_COLUMNS, TickFlag
from tangible_core.pipeline.config.schema import json_schema
from tangible_legibility.words.languages import LANGUAGES, TABLES
from tangible_ui import requests
from tangible_ui.feeling.recorder import BY_HAND
from tangible_ui.requests import REQUESTS
from tangible_ui.requests.table import request
from tangible_ui.serving.routes import WRONG_KEY
from tangible_ui.serving.translating import in_language, tab_language
from tangible_ui.worker import jobs
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.jobs.table import job
from tangible_web import framing as wire

SAID = (1, 5, 513, 4_000_000_000, 4_000_000, 77, 1.7e12 + 0.25)
VECTORS = tuple(k / 8 for k in range(15))
SCRIPT = """
import { readFileSync } from "node:fs";
import { transformSync } from "esbuild";
const { code } = transformSync(readFileSync("kit/server/protocol.ts", "utf8"), { loader: "ts", format: "esm" });
const page = await import("data:text/javascript," + encodeURIComponent(code));
const hex = (buffer) => Buffer.from(buffer).toString("hex");
const bytes = (text) => Uint8Array.from(Buffer.from(text, "hex")).buffer;
const constants = Object.fromEntries(Object.entries(page).filter(([, value]) => typeof value !== "function"));
const read = page.parseState(bytes(process.argv[1]));
console.log(JSON.stringify({
  constants, read,
  short: page.parseState(bytes(process.argv[1].slice(2))),
  other: page.parseState(bytes("02" + process.argv[1].slice(2))),
  pointer: hex(page.encodePointer([0.5, -0.25, 0.125], 3, 4194303)),
  ack: hex(page.encodeAck(4000000000)),
  release: hex(page.encodeRelease()),
}));
"""


@cache
def page() -> dict[str, Any]:
    """Return what the page's own module writes, and what it reads of a state written here."""
    frame = wire.STATE_FRAME.pack(*SAID, *VECTORS, 12.5)
    done = node("--input-type=module", "-e", SCRIPT, frame.hex(), cwd=WEB)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


class TestFrames:
    def test_frames_are_read_as_they_were_written_with_equal_constants(self) -> None:
        said = page()["constants"]
        names = ("VERSION", "STATE", "POINTER", "ACK", "RELEASE", "TAGS")
        assert {name: said[name] for name in names} == {name: getattr(wire, name) for name in names}
        assert said["STATUS"] == {name: getattr(wire, name) for name in ("RUNNING", "HOLDING", "RECORDING")}
        assert said["FLAGS"] == {flag.name: int(flag) for flag in TickFlag}
        sizes = {name: getattr(wire, f"{name}_FRAME").size for name in ("STATE", "POINTER", "ACK", "RELEASE")}
        assert {name: said[f"{name}_BYTES"] for name in sizes} == sizes
        read = page()["read"]
        _, status, flags, seq, tag, overruns, sample_ms = SAID
        assert [read[name] for name in ("status", "flags", "seq", "tag", "overruns", "sampleMs", "lateUs")] == [
            status, flags, seq, tag, overruns, sample_ms, 12.5,
        ]  # fmt: skip
        names = ("hand", "proxy", "force", "velocity", "other")
        assert [part for name in names for part in read[name]] == list(VECTORS)
        assert page()["short"] is None
        assert page()["other"] is None
        kind, buttons, tag, sent_ms, *hand = wire.POINTER_FRAME.unpack(bytes.fromhex(page()["pointer"]))
        assert (kind, buttons, tag, hand) == (wire.POINTER, 3, wire.TAGS, [0.5, -0.25, 0.125])
        assert sent_ms > 1.6e12
        assert wire.ACK_FRAME.unpack(bytes.fromhex(page()["ack"])) == (wire.ACK, 4_000_000_000)
        assert bytes.fromhex(page()["release"]) == wire.RELEASE_FRAME.pack(wire.RELEASE)


def test_recording_columns_are_those_of_the_page() -> None:
    said = (UI / "src/panels/recordings/ticks.ts").read_text(encoding="utf-8")
    (count,), (places,) = re.findall(r"COLUMNS = (\d+);", said), re.findall(r"AT = \{(.*?)\}", said)
    assert int(count) == len(TICK_COLUMNS)
    read = {name: TICK_COLUMNS[int(place)] for name, place in re.findall(r"(\w+): (\d+)", places)}
    assert read == {
        **{"time": "time_s", "late": "late_s", "hand": "x_m", "velocity": "vx_m_per_s", "proxy": "proxy_x_m"},
        **{"force": "fx_n", "flags": "flags", "buttons": "buttons"},
    }


def sources(folder: Path, ending: str) -> str:
    files = [path for path in folder.rglob(f"*{ending}") if "static" not in path.parts]
    return "\n".join(path.read_text(encoding="utf-8") for path in sorted(files))


def page_sources() -> str:
    return sources(UI / "src", ".ts") + sources(WEB / "kit", ".ts")


class TestNames:
    def test_requests_and_events_of_the_page_and_the_server_are_the_same(self) -> None:
        asked = set(re.findall(r"\bask(?:<[^(]*>)?\(\s*[\"'](\w+)[\"']", page_sources()))
        assert len(asked) > 20
        assert asked <= ANSWERED
        written = set(re.findall(r"[\"'](\w+)[\"']", page_sources()))
        assert written >= ANSWERED
        here = sources(UI.parent / "tangible_ui", ".py") + sources(WEB / "tangible_web", ".py")
        there = (WEB / "kit/server/messages.ts").read_text(encoding="utf-8")
        told = set(re.findall(r"(?:\btell|\bEvent)\(\s*\"(\w+)\"", here) + re.findall(r"\"event\": \"(\w+)\"", here))
        body = there[there.index("export interface Events") :]
        assert told - {"answer", "refused"} == set(re.findall(r"^  (\w+): Said\b", body, re.M)) - OF_THE_PAGE
        assert f"WRONG_KEY = {WRONG_KEY};" in (WEB / "kit/server/connection.ts").read_text(encoding="utf-8")


OF_THE_PAGE = {"gone", "refused", "silence"}
"""Events that the page sends to itself when the program is gone, or is another one."""
PAGE_JOBS = {name for name, each in JOBS.items() if each.page}
ANSWERED = REQUESTS.keys() | PAGE_JOBS
"""Requests that the server answers, and those that the worker does."""


def topics(package: str) -> set[str]:
    return {path.stem for path in Path(package).parent.glob("*.py")} - {"__init__", "table"}


def test_topics_are_loaded_without_a_list_under_free_names() -> None:
    modules = {each.__module__.rpartition(".")[2] for each in REQUESTS.values()}
    assert modules == topics(requests.__file__)
    assert {each.do.__module__.rpartition(".")[2] for each in JOBS.values()} - {"table"} == topics(jobs.__file__)
    assert not REQUESTS.keys() & PAGE_JOBS

    async def make() -> None: ...

    with pytest.raises(ValueError, match="two requests named make"):
        request()(make)
    with pytest.raises(ValueError, match="two requests named set"):
        request("set")(make)
    with pytest.raises(ValueError, match="two jobs named make"):
        job()(make)


GONE, GONE_DE = "this file is gone", "diese Datei gibt es nicht mehr"
BROKE, BROKE_DE = "the upload broke off", "das Hochladen brach ab"


def test_english_message_is_sent_as_it_is():
    message = {"event": "error", "text": GONE, "checks": [{"sentence": BROKE}]}
    assert in_language(message, "en") is message


@pytest.mark.parametrize(("tag", "language"), [("de", "de"), ("en", "en"), ("xx", "en"), ("", "en"), ("DE", "en")])
def test_language_that_is_not_spoken_is_english(tag: str, language: str):
    assert tab_language(tag) == language


@pytest.mark.parametrize("event", ["refused", "error", "log"])
def test_text_of_what_is_said_is_translated(event: str):
    message = {"event": event, "text": GONE, "number": 3}
    assert in_language(message, "de") == {"event": event, "text": GONE_DE, "number": 3}


@pytest.mark.parametrize(
    ("message", "german"),
    [
        ({"event": "document", "text": GONE}, None),  # the text of a file
        ({"name": GONE, "label": BROKE}, None),
        ({"values": {"title": GONE}, "names": [GONE], "said": {"why": BROKE}, "says": {"en": BROKE}}, None),
        *[({"why": why}, None) for why in ("asked", "button", "scene", "ended", BY_HAND)],
        ({"slow": [0.5, 1], "empty": [], "nothing": None, "wide": True}, None),
        ({"why": GONE}, {"why": GONE_DE}),
        ({"steps": [{"why": BROKE, "product": BROKE}]}, {"steps": [{"why": BROKE_DE, "product": BROKE}]}),
        ({"complaint": {"text": GONE, "location": ["a"]}}, {"complaint": {"text": GONE_DE, "location": ["a"]}}),
        ({"why": f"{GONE}; {BROKE}", "notes": [{"text": BROKE, "kind": "doubt"}]},
         {"why": f"{GONE_DE}; {BROKE_DE}", "notes": [{"text": BROKE_DE, "kind": "doubt"}]}),
        ({"why": GONE, "notes": [{"text": BROKE, "kind": "doubt"}]},
         {"why": GONE_DE, "notes": [{"text": BROKE_DE, "kind": "doubt"}]}),
        ({"why": GONE, "notes": []}, {"why": GONE_DE, "notes": []}),
    ],
)  # fmt: skip
def test_german_message_has_german_texts_alone(message: dict[str, Any], german: dict[str, Any] | None):
    assert in_language(message, "de") == (german or message)


ROW = re.compile(r"^  (\w+): (\[.*\]),$", re.MULTILINE)


def test_page_names_materials_as_descriptions_do():
    rows = ROW.findall((WEB / "kit/words/material_words.ts").read_text(encoding="utf-8"))
    found = {name: json.loads(words) for name, words in rows}
    assert found == {name: [TABLES[each].materials[name] for each in LANGUAGES] for name in TABLES["en"].materials}


@pytest.mark.whole
def test_form_has_a_control_with_default_and_bounds_for_every_option(tmp_path: Path, monkeypatch):
    schema = tmp_path / "schema.json"
    schema.write_text(json.dumps(json_schema(None, None)))
    monkeypatch.setenv("TANGIBLE_SCHEMA", str(schema))
    done = node("test/run.mjs", "--test-name-pattern", "every option", cwd=WEB)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "# pass 0" not in done.stdout

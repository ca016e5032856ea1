"""Texts in other languages: recognised as they were made, with numbers and known arguments in the language."""

from pathlib import Path

import pytest

from command_line import tangible
from english import english_of
from shown_texts import is_prose, literals
from tangible_core.errors import UnknownMethod, did_you_mean
from tangible_core.testing.kit import CheckResult, checks, demand
from tangible_core.translation import language_of_environment, translate
from tangible_core.translation.catalogue import Catalogue, parse
from tangible_core.translation.chosen import set_language
from tangible_core.translation.numerals import Numerals
from tangible_core.translation.translate import localise_marked
from tangible_legibility import sizes

PO = """
msgid ""
msgstr "Language: de\\n"

# a comment
#: a file
msgid "{name} is {height} high, and {share} of {whole} lies on {material}{hint}."
msgstr "Auf {material}{hint} liegen {share} von {whole}; {name} ist {height} hoch."

msgid "write `{key}: {value}` into {file}"
msgstr "schreiben Sie `{key}: {value}` in {file!s}"

msgid "(did you mean {near}?)"
msgstr "(meinten Sie {near}?)"

msgid "wood"
msgstr "Holz"

msgid "in the middle"
msgstr "in der Mitte"

msgid "is too low"
msgstr "ist zu niedrig"

msgid "It is done."
msgstr ""
"Es ist "
"getan."

msgid "and"
msgstr "und"

msgid "{count} parts"
msgstr "{count} Teile"
"""
GERMAN = Catalogue(parse(PO), Numerals("de"))


@pytest.mark.parametrize(
    ("english", "german"),
    [
        ("It is done.", "Es ist getan."),
        ("It is\n    done.", "Es ist getan."),
        ("It is done", "Es ist getan"),
        ("wall is 1.5 mm high, and 1,250.5 of 2 lies on wood.", "Auf Holz liegen 1.250,5 von 2; wall ist 1,5 mm hoch."),
        (
            "wall is 2 mm high, and 1 of 2 lies on x (did you mean 'y'?).",
            "Auf x (meinten Sie 'y'?) liegen 1 von 2; wall ist 2 mm hoch.",
        ),
        ("write `a.b_m: 1.5` into file 2.5", "schreiben Sie `a.b_m: 1.5` in file 2.5"),
        ("wall is too low in the middle, wood", "wall ist zu niedrig in der Mitte, Holz"),
        ("3 parts and wood", "3 Teile und Holz"),
        ("wall: It is done.", "wall: Es ist getan."),
        ("a.yaml:3:1: It is done.", "a.yaml:3:1: Es ist getan."),
        ("It is done.\nand that is not known", "Es ist getan.\nand that is not known"),
        ("nothing of this is known, and so it stays in the middle", None),
        ("version 3.11", "version 3.11"),
    ],
)
def test_a_text_is_translated_whole_or_not_at_all(english: str, german: str | None) -> None:
    assert GERMAN(english) == (english if german is None else german)


def test_the_program_s_own_errors_are_translated() -> None:
    error = UnknownMethod("depth", "semi-globl", ["semi-global", "zncc"])
    said = translate(str(error), "de")
    assert not english_of(said)
    assert "'semi-global'" in said and "'semi-globl'" in said
    assert did_you_mean("a", ["b"]) == ""


def test_english_is_left_alone() -> None:
    assert translate("1.5 mm", "en") == "1.5 mm"


@pytest.mark.parametrize(
    ("environment", "language"),
    [
        ({}, "en"),
        ({"LANG": "de_AT.UTF-8"}, "de"),
        ({"LANG": "de_AT.UTF-8", "LC_ALL": "C"}, "en"),
        ({"LANG": "en_GB.UTF-8", "LC_MESSAGES": "fr_FR"}, "fr"),
        ({"LANG": "nl_NL.UTF-8", "LANGUAGE": "nl:de:fr"}, "de"),
        ({"LANG": "nl_NL.UTF-8"}, "en"),
    ],
)
def test_the_environment_names_the_language(environment: dict[str, str], language: str) -> None:
    assert language_of_environment(environment) == language


def test_conditions_in_a_text_give_whole_texts(tmp_path: Path) -> None:
    source = tmp_path / "module.py"
    source.write_text(
        "def say(n, path):\n"
        "    '''Not this text.'''\n"
        "    log.info('%s of %d are done', n, path)\n"
        "    raise ConfigError(f\"{path}: {'is' if n == 1 else 'are'} not there, \" + f'{n} file{\"s\" * (n > 1)}')\n"
    )
    assert {text for _, text in literals(source) if is_prose(text)} == {
        "{path}: is not there, {n} file",
        "{path}: is not there, {n} files",
        "{path}: are not there, {n} file",
        "{path}: are not there, {n} files",
        "{value} of {value2} are done",
    }


COMMANDS = [
    ("--help",),
    *((name, "--help") for name in (
        "demo", "run", "plan", "export", "preflight", "legible", "feel", "replay", "plugins", "check", "cache",
        "schema", "new", "parts", "batch", "compare", "devices", "materials", "pointer", "ui",
    )),
    ("plugins", "show", "--help"), ("devices", "doctor", "--help"), ("materials", "show", "--help"),
    ("plugins",), ("plugins", "show", "render", "proxy"), ("plugins", "show", "depth", "semi-global"),
    ("materials",), ("materials", "show", "wood"), ("devices", "doctor", "mock"), ("cache",),
]  # fmt: skip


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_the_terminal_has_no_english_in_german(words: tuple[str, ...], tmp_path: Path) -> None:
    done = tangible("--lang", "de", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert not english_of(done.stdout + done.stderr)


MISTAKES = [
    ("run", "nothere.yaml"), ("run",), ("run", "--nonsense"), ("nonsense",), ("run", "a.png", "b.png", "c.png"),
    ("plugins", "show", "depth", "nonsense"), ("materials", "show", "wod"), ("--log-level", "loud", "plugins"),
    ("run", "a.yaml", "--seconds", "long"),
]  # fmt: skip


@pytest.mark.parametrize("words", MISTAKES, ids=" ".join)
def test_mistakes_are_told_in_german(words: tuple[str, ...], tmp_path: Path) -> None:
    done = tangible(*words, "--lang", "de", cwd=tmp_path)
    assert done.returncode == 2
    assert not english_of(done.stderr)
    assert english_of(tangible(*words, cwd=tmp_path).stderr)


def test_checks_of_a_method_are_told_in_german(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong = "the wall is shifted by 5 px; the median error is 3.2 px"
    found = [CheckResult(each.__name__, True, demand(each)) for each in checks("depth")]
    found += [CheckResult("error", False, wrong)]
    monkeypatch.setattr("tangible_core.testing.run_checks", lambda kind, name: found)
    done = tangible("--lang", "de", "check", "depth", "luminance", cwd=tmp_path)
    assert done.returncode == 1
    assert "die Wand ist um 5 px verschoben; der Median des Fehlers ist 3,2 px" in " ".join(done.stdout.split())
    assert not english_of(done.stdout)


def test_results_are_told_in_german_and_data_in_english(tmp_path: Path) -> None:
    pipeline = tmp_path / "photo.yaml"
    pipeline.write_text(
        "scene: builtin/coins\nwant: touch\ntexture: {use: gradient, segments: 3}\nrender: {use: proxy}\n"
        "device: {use: mock}\nexport: [swell]\n"
    )
    for words in (("plan",), ("run", "--verbose", "--seconds", "0.2"), ("preflight", "--seconds", "0.1"),
                  ("legible", "--for", "swell"), ("legible",), ("export",), ("parts",)):  # fmt: skip
        done = tangible("--lang", "de", words[0], pipeline, *words[1:], cwd=tmp_path)
        assert not english_of(done.stdout + done.stderr), words
    data = tangible("--lang", "de", "plan", pipeline, "--json", cwd=tmp_path)
    assert data.stdout == tangible("plan", pipeline, "--json", cwd=tmp_path).stdout
    assert '"why"' in data.stdout


def test_a_point_in_a_number_ends_no_sentence() -> None:
    size = ", as a surface of 80 x 53 mm, 5.68 mm high"
    hand = "A simulated hand felt it for 8.0 s, with forces of up to 3.2 N."
    told = translate(f"a.jpg can now be felt{size}. {hand}", "de")
    assert "als Oberfläche von 80 x 53 mm, 5,68 mm hoch." in told
    assert "surface" not in told


def test_heading_with_marks_and_a_list_of_reasons_is_german() -> None:
    reasons = "part 5 is too narrow for a finger at the lower left, 4 more places are too narrow for a finger"
    said = f"a.jpg, 160 mm wide, on a 3-D print: [red]Illegible, because {reasons} and 6 more things.[/]"
    try:
        set_language("de")
        found = localise_marked(said)
    finally:
        set_language("en")
    assert found == (
        "a.jpg, 160 mm breit, auf einem 3-D-Druck: [red]Nicht lesbar, denn Teil 5 ist zu schmal für einen Finger unten "
        "links, 4 weitere Stellen sind zu schmal für einen Finger und 6 weitere Punkte.[/]"
    )


def test_sizes_that_an_exporter_chooses_are_judged_in_german() -> None:
    assert translate(sizes("print", base=0.0005).sentence, "de") == (
        "Nicht lesbar, denn Grundplatte: 0,5 mm, nötig sind mindestens 0,8 mm."
    )


def test_two_texts_of_one_template_are_two() -> None:
    wide, long = (f"the surface has more {each} than the device reaches" for each in ("width", "length"))
    said = f"Safe, but {wide} and {long}."
    assert translate(said, "de") == (
        "Sicher, aber die Oberfläche hat mehr Breite, als das Gerät reicht und die Oberfläche hat mehr Länge, als das "
        "Gerät reicht."
    )

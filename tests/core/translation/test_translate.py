"""Texts in other languages: recognised as they were made, with numbers and known arguments in the language."""

from pathlib import Path

import pytest

from command_line import tangible
from english import english_of
from shown_texts import is_prose, literals
from tangible_core.errors import UnknownMethod, did_you_mean
from tangible_core.testing.kit import CheckResult, checks, demand
from tangible_core.translation import language, language_of_environment, localise, translate
from tangible_core.translation.catalogue import Catalogue, parse
from tangible_core.translation.chosen import set_language
from tangible_core.translation.numerals import Numerals
from tangible_core.translation.template import Template
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


LISTS = """
msgid "the picture file {name}"
msgstr "die Bilddatei {name}"

msgid "the picture file {name} is {why}"
msgstr "{why} ist die Bilddatei {name}"

msgid "{size} wide at {place}"
msgstr "{place} {size} breit"

msgid "{first}{second} belongs to nobody"
msgstr "niemandem gehört {second}|{first}"

msgid "{count} of {all} files"
msgstr "von {all} Dateien {count}"

msgid "{whole} ends"
msgstr "{whole} endet"

msgid "the text {text} has\\n two lines, \\"quoted\\""
msgstr "zwei Zeilen,\\n \\"zitiert\\", hat {text}"

msgid "at the upper left"
msgstr "oben links"

msgid "too small"
msgstr "zu klein"

msgid "too large"
msgstr "zu groß"

msgid "; the rest is {what}"
msgstr "; der Rest ist {what}"

msgid " in all directions"
msgstr " in alle Richtungen"

msgid "near, far"
msgstr "nah, fern"

msgid "left, right"
msgstr "links, rechts"

msgid "It rained."
msgstr "Es regnete."

msgid "Really?"
msgstr "Wirklich?"

msgid "attention: rain"
msgstr "Achtung: Regen"

msgid "and"
msgstr "und"

msgid "or"
msgstr "oder"

msgid "no translation yet"
msgstr ""
"""


@pytest.mark.parametrize(
    ("english", "german"),
    [
        (
            "the picture file a.yaml is too small",
            "zu klein ist die Bilddatei a.yaml",
        ),  # which both first templates match
        ("the picture file a.yaml", "die Bilddatei a.yaml"),
        ("the picture file my own words of {why} and `name`", "die Bilddatei my own words of {why} and `name`"),
        ("the picture file {name}{why} is 1.5", "1,5 ist die Bilddatei {name}{why}"),
        ("3.5 mm wide at Jane Doe", "Jane Doe 3,5 mm breit"),
        ("3.5 mm wide at who knows what", None),  # so short a template needs arguments that are known
        ("too small belongs to nobody", "niemandem gehört |zu klein"),
        ("3 of 7 files and too large", "von 7 Dateien 3 und zu groß"),
        ("3 of 7 files, 4 of 9 files", "von 7 Dateien 3, von 9 Dateien 4"),
        ("the picture file a, the picture file b", "die Bilddatei a, die Bilddatei b"),
        ('the text 2.5 has\n two lines, "quoted"', 'zwei Zeilen,\n "zitiert", hat 2,5'),
        ("too small ends", "zu klein endet"),
        ("2 too small", "2 zu klein"),
        ("too small 2", None),
        ("  too small\n", "  zu klein\n"),
        ("too small\nof nothing known\n\ntoo large", "zu klein\nof nothing known\n\nzu groß"),
        ("too small.", "zu klein."),
        ("too large at the upper left", "zu groß oben links"),
        ("too large in all directions", "zu groß in alle Richtungen"),
        ("nothing of this in all directions", None),
        ("all words here at the upper left", None),
        ("too large; the rest is too small", "zu groß; der Rest ist zu klein"),
        ("too large; the rest is of unknown words", None),
        ("too small or too large and too small", "zu klein oder zu groß und zu klein"),
        ("too small (too large", "zu klein (zu groß"),
        ("a.png -> too small", "a.png -> zu klein"),
        ("3 mm <= 4.5 mm", "3 mm <= 4,5 mm"),
        ("1,234.5 N/mm > 3e-5 m", "1.234,5 N/mm > 3e-5 m"),
        ("whatever somebody called it: too small", "whatever somebody called it: zu klein"),
        ("whatever somebody called it: attention: rain", "whatever somebody called it: Achtung: Regen"),
        ("too small: whatever somebody called it", None),
        ("near, far, left, right", "nah, fern, links, rechts"),
        ("near, far; left, right", "nah, fern; links, rechts"),
        ("It rained. Really?  It rained.", "Es regnete. Wirklich? Es regnete."),
        ("It rained. Nobody knows this.", None),
        ("no translation yet", None),
        ("and", "und"),
        ("", None),
        (" ", None),
    ],
)
def test_texts_are_recognised_by_what_they_are_made_of(english: str, german: str | None) -> None:
    assert Catalogue(parse(LISTS), Numerals("de"))(english) == (english if german is None else german)


def test_literals_of_a_template_do_not_overlap_and_values_may_be_empty() -> None:
    lies = Template("{count} of {all} of it", "{all}: {count}")
    assert lies.match("3 of 7 of it") == {"count": "3", "all": "7"}
    assert lies.match("3 of  of it") == {"count": "3", "all": ""}
    assert lies.match("3 of it") is None
    near = Template("near{far}here", "{far}")
    assert (near.match("nearhere"), near.match("nearer here"), near.match("neare")) == (
        {"far": ""},
        {"far": "er "},
        None,
    )
    assert Template("a{one}{two}{three}b", "").match("aXYb") == {"one": "XY", "two": "", "three": ""}
    assert Template("{one}. {two}", "").match("1.5. 2.5") == {"one": "1.5", "two": "2.5"}
    assert Template("{one}.{two}", "").match("1.5.x") == {"one": "1.5", "two": "x"}
    assert Template("{one} or {two}", "").match("a\nb or c") is None
    assert Template("{one}\nor {two}", "").match("a\nb\nor c") == {"one": "a\nb", "two": "c"}


def test_a_text_of_a_book_s_length_is_not_taken_apart() -> None:
    catalogue = Catalogue(parse(LISTS), Numerals("de"))
    chapter, book = (f"the picture file {'a' * letters} is 1.5" for letters in (2976, 2977))
    assert (len(chapter), catalogue(chapter)) == (3000, f"1,5 ist die Bilddatei {'a' * 2976}")
    assert catalogue(book) == book


def test_a_long_list_stays_as_it_is_in_a_text_that_is_translated() -> None:
    """Each mark in a text is a step deeper, and 400 names were too deep for Python."""
    catalogue, names = Catalogue(parse(LISTS), Numerals("de")), ", ".join(f"m{each}" for each in range(400))
    assert catalogue(f"the picture file {names}") == f"die Bilddatei {names}"
    assert catalogue("too small, " * 30 + "wood") == "zu klein, " * 30 + "wood"
    assert catalogue(longer := "too small, " * 31 + "wood") == longer


@pytest.mark.parametrize(
    ("english", "german", "french"),
    [
        ("1.5 mm", "1,5 mm", "1,5 mm"),
        ("-1,234,567.25", "-1.234.567,25", "-1\u202f234\u202f567,25"),
        ("+3", "+3", "+3"),
        ("2.50 %", "2,50 %", "2,50 %"),
        ("2.5%", "2,5%", "2,5%"),
        ("1.5e-07 N/m", "1,5e-07 N/m", "1,5e-07 N/m"),
        ("1234.5", "1234,5", "1234,5"),
        ("12 GiB", "12 GiB", "12 GiB"),
        ("\u22120.5 kHz", "\u22120,5 kHz", "\u22120,5 kHz"),
        *((text, None, None) for text in ("0,123", "1,23", "1.2.3", "1.5 apples", ".5", "5.", "1.5  mm")),
    ],
)
def test_numbers_have_the_notation_of_the_language(english: str, german: str | None, french: str | None) -> None:
    assert (Numerals("de")(english), Numerals("fr")(english)) == (german, french)


def test_languages_are_chosen_by_their_tags_and_unknown_ones_are_english() -> None:
    try:
        for tag, spoken in {
            "de_AT.UTF-8": "de",
            "fr-CA": "fr",
            "DE": "de",
            "de.UTF-8": "de",
            "nl_NL": "en",
            "": "en",
        }.items():
            set_language("fr")
            set_language(tag)
            assert language() == spoken, tag
            assert localise("1.5 mm") == ("1.5 mm" if spoken == "en" else "1,5 mm")
    finally:
        set_language("en")


def test_marks_and_escaped_brackets_stay_where_they_are() -> None:
    """A bracket of a text itself is escaped, so that no mark is made of it; English is not touched at all."""
    said = r"[bold red]1.5 mm[/] \[x] [bold #12ab_9]nobody's \[red] text[/bold][dim]2.5[/] 3"
    assert localise_marked(said) == said
    try:
        set_language("de")
        assert localise_marked(said) == said.replace("1.5", "1,5").replace("2.5", "2,5")
    finally:
        set_language("en")


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

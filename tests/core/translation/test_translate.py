"""Translated texts. Otherwise a text would stay English, or say something else, in a German program."""

from pathlib import Path

import pytest

import catalogues
from command_line import tangible
from english import english_of
from tangible_core.errors import UnknownMethod
from tangible_core.translation import language, language_of_environment, localise, translate
from tangible_core.translation.catalogue import Catalogue, Numerals, Template, parse
from tangible_core.translation.translate import localise_marked, set_language
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
NAMES = [f"m{each}" for each in range(400)]


@pytest.mark.parametrize(
    ("english", "german"),
    [
        ("It is\n    done.", "Es ist getan."),
        ("It is done", "Es ist getan"),
        ("wall is 1.5 mm high, and 1,250.5 of 2 lies on wood.", "Auf Holz liegen 1.250,5 von 2; wall ist 1,5 mm hoch."),
        (
            "wall is 2 mm high, and 1 of 2 lies on x (did you mean 'y'?).",
            "Auf x (meinten Sie 'y'?) liegen 1 von 2; wall ist 2 mm hoch.",
        ),
        ("write `a.b_m: 1.5` into file 2.5", "schreiben Sie `a.b_m: 1.5` in file 2.5"),
        ("wall is too low in the middle, wood", "wall ist zu niedrig in der Mitte, Holz"),
        ("a.yaml:3:1: It is done.", "a.yaml:3:1: Es ist getan."),
        ("nothing of this is known, and so it stays in the middle", None),
        ("version 3.11", "version 3.11"),
    ],
)
def test_a_text_is_translated_whole_or_not_at_all(english: str, german: str | None) -> None:
    assert GERMAN(english) == (english if german is None else german)


LISTS = {
    "the picture file {name}": "die Bilddatei {name}",
    "the picture file {name} is {why}": "{why} ist die Bilddatei {name}",
    "{size} wide at {place}": "{place} {size} breit",
    "{first}{second} belongs to nobody": "niemandem gehört {second}|{first}",
    "{count} of {all} files": "von {all} Dateien {count}",
    "{whole} ends": "{whole} endet",
    'the text {text} has\\n two lines, \\"quoted\\"': 'zwei Zeilen,\\n \\"zitiert\\", hat {text}',
    "at the upper left": "oben links",
    "too small": "zu klein",
    "too large": "zu groß",
    "; the rest is {what}": "; der Rest ist {what}",
    " in all directions": " in alle Richtungen",
    "near, far": "nah, fern",
    "left, right": "links, rechts",
    "It rained.": "Es regnete.",
    "Really?": "Wirklich?",
    "attention: rain": "Achtung: Regen",
    "and": "und",
    "or": "oder",
    "no translation yet": "",
}
LISTED = parse("\n".join(f'msgid "{english}"\nmsgstr "{german}"\n' for english, german in LISTS.items()))


@pytest.mark.parametrize(
    ("english", "german"),
    [
        ("the picture file a.yaml is too small", "zu klein ist die Bilddatei a.yaml"),  # both first templates match
        ("the picture file a.yaml", "die Bilddatei a.yaml"),
        ("the picture file my own words of {why} and `name`", "die Bilddatei my own words of {why} and `name`"),
        ("the picture file {name}{why} is 1.5", "1,5 ist die Bilddatei {name}{why}"),
        ("3.5 mm wide at Jane Doe", "Jane Doe 3,5 mm breit"),
        ("3.5 mm wide at who knows what", None),  # so short a template needs arguments that are known
        ("too small belongs to nobody", "niemandem gehört |zu klein"),
        ("3 of 7 files and too large", "von 7 Dateien 3 und zu groß"),
        ("3 of 7 files, 4 of 9 files", "von 7 Dateien 3, von 9 Dateien 4"),
        ('the text 2.5 has\n two lines, "quoted"', 'zwei Zeilen,\n "zitiert", hat 2,5'),
        ("too small ends", "zu klein endet"),
        ("2.5 too small", "2,5 zu klein"),
        ("too small 2", None),
        ("  too small\n", "  zu klein\n"),
        ("too small\nof nothing known\n\ntoo large", "zu klein\nof nothing known\n\nzu groß"),
        ("too small.", "zu klein."),
        ("too large at the upper left", "zu groß oben links"),
        ("too large in all directions", "zu groß in alle Richtungen"),
        ("nothing of this in all directions", None),
        ("too large; the rest is too small", "zu groß; der Rest ist zu klein"),
        ("too large; the rest is of unknown words", None),
        ("too small or too large and too small", "zu klein oder zu groß und zu klein"),
        ("too small (too large", "zu klein (zu groß"),
        ("a.png -> too small", "a.png -> zu klein"),
        ("3 mm <= 4.5 mm", "3 mm <= 4,5 mm"),
        ("1,234.5 N/mm > 3e-5 m", "1.234,5 N/mm > 3e-5 m"),
        ("whatever somebody called it: attention: rain", "whatever somebody called it: Achtung: Regen"),
        ("too small: whatever somebody called it", None),
        ("near, far; left, right", "nah, fern; links, rechts"),
        ("It rained. Really?  It rained.", "Es regnete. Wirklich? Es regnete."),
        ("It rained. Nobody knows this.", None),
        ("no translation yet", None),
        ("", None),
        (f"the picture file {'a' * 2976} is 1.5", f"1,5 ist die Bilddatei {'a' * 2976}"),
        (f"the picture file {'a' * 2977} is 1.5", None),  # of a book's length
        (f"the picture file {', '.join(NAMES)}", f"die Bilddatei {', '.join(NAMES)}"),  # each mark is a step deeper
        ("too small, " * 30 + "wood", "zu klein, " * 30 + "wood"),
        ("too small, " * 31 + "wood", None),
    ],
)
def test_texts_are_recognised_by_what_they_are_made_of(english: str, german: str | None) -> None:
    assert Catalogue(LISTED, Numerals("de"))(english) == (english if german is None else german)


@pytest.mark.parametrize(
    ("template", "text", "values"),
    [
        ("{count} of {all} of it", "3 of 7 of it", {"count": "3", "all": "7"}),
        ("{count} of {all} of it", "3 of  of it", {"count": "3", "all": ""}),
        ("{count} of {all} of it", "3 of it", None),
        ("near{far}here", "nearhere", {"far": ""}),
        ("near{far}here", "neare", None),
        ("a{one}{two}{three}b", "aXYb", {"one": "XY", "two": "", "three": ""}),
        ("{one}. {two}", "1.5. 2.5", {"one": "1.5", "two": "2.5"}),
        ("{one}.{two}", "1.5.x", {"one": "1.5", "two": "x"}),
        ("{one} or {two}", "a\nb or c", None),
        ("{one}\nor {two}", "a\nb\nor c", {"one": "a\nb", "two": "c"}),
    ],
)
def test_literals_of_a_template_do_not_overlap_and_values_may_be_empty(template: str, text: str, values) -> None:
    assert Template(template, "").match(text) == values


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


def test_languages_are_chosen_by_tags_and_marks_stay() -> None:
    tags = {"de_AT.UTF-8": "de", "fr-CA": "fr", "DE": "de", "de.UTF-8": "de", "nl_NL": "en", "": "en"}
    try:
        for tag, spoken in tags.items():
            set_language("fr")
            set_language(tag)
            assert language() == spoken, tag
            assert localise("1.5 mm") == ("1.5 mm" if spoken == "en" else "1,5 mm")
    finally:
        set_language("en")
    said = r"[bold red]1.5 mm[/] \[x] [bold #12ab_9]nobody's \[red] text[/bold][dim]2.5[/] 3"
    assert localise_marked(said) == said
    try:
        set_language("de")
        assert localise_marked(said) == said.replace("1.5", "1,5").replace("2.5", "2,5")
    finally:
        set_language("en")


@pytest.mark.parametrize(
    ("english", "german"),
    [
        (str(UnknownMethod("depth", "semi-globl", ["semi-global", "zncc"])), "'semi-global'"),
        (
            "a.jpg can now be felt, as a surface of 80 x 53 mm, 5.68 mm high. A simulated hand felt it for 8.0 s, with "
            "forces of up to 3.2 N.",
            "als Oberfläche von 80 x 53 mm, 5,68 mm hoch.",
        ),
        (sizes("print", base=0.0005).sentence, "Grundplatte: 0,5 mm, nötig sind mindestens 0,8 mm."),
        (
            "Safe, but the surface has more width than the device reaches and the surface has more length than the "
            "device reaches.",
            "mehr Breite, als das Gerät reicht und die Oberfläche hat mehr Länge, als das Gerät reicht.",
        ),
        (
            "a.jpg, 160 mm wide, on a 3-D print: [red]Illegible, because part 5 is too narrow for a finger at the "
            "lower left, 4 more places are too narrow for a finger and 6 more things.[/]",
            "[red]Nicht lesbar, denn Teil 5 ist zu schmal für einen Finger unten links, 4 weitere Stellen sind",
        ),
    ],
)
def test_the_program_s_own_texts_are_translated(english: str, german: str) -> None:
    try:
        set_language("de")
        said = localise_marked(english)
    finally:
        set_language("en")
    assert german in said
    assert not english_of(said)
    assert localise_marked(english) == english == translate(english, "en")


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


FILE = """
scene: builtin/coins
want: touch
depth: luminance
texture: {use: gradient, segments: 3}
render: {use: proxy}
device: {use: mock}
export: [swell]
"""
RESULTS = [
    "--help", "run --help", "devices doctor --help", "plugins", "plugins show render proxy", "materials show wood",
    "devices doctor mock", "cache", "plan photo.yaml", "run photo.yaml --seconds 0.1", "export photo.yaml",
    "preflight photo.yaml --seconds 0.1", "legible photo.yaml --for swell", "networks",
]  # fmt: skip
MISTAKES = [
    "run nothere.yaml", "run", "run --nonsense", "nonsense", "plugins show depth nonsense", "materials show wod",
    "--log-level loud plugins", "run a.yaml --seconds long",
]  # fmt: skip


@pytest.mark.parametrize("words", [*RESULTS, *MISTAKES])
def test_the_terminal_has_no_english_in_german(words: str, tmp_path: Path) -> None:
    (tmp_path / "photo.yaml").write_text(FILE)
    done = tangible("--lang", "de", *words.split(), cwd=tmp_path)
    assert done.returncode == (2 if words in MISTAKES else 0), done.stderr
    assert not english_of(done.stdout + done.stderr)
    if words.startswith("plan"):
        data = tangible("--lang", "de", "plan", "photo.yaml", "--json", cwd=tmp_path)
        assert data.stdout == tangible("plan", "photo.yaml", "--json", cwd=tmp_path).stdout


HOW = (
    "run `python tests/helpers/catalogues.py`, and fill in the empty `msgstr` of "
    "tangible_core/translation/{language}.po (CONTRIBUTING.md, “Texts in other languages”)"
)


@pytest.mark.parametrize("language", catalogues.WHOLE)
def test_every_text_that_the_program_shows_is_translated(language: str) -> None:
    missing = list(catalogues.missing(language))
    assert not missing, HOW.format(language=language)


@pytest.mark.parametrize("language", ["de", "fr"])
def test_translations_are_of_living_texts_with_their_placeholders(language: str) -> None:
    gone = list(catalogues.stale(language))
    assert not gone, f"these are in {language}.po alone: run `python tests/helpers/catalogues.py`"
    assert not list(catalogues.misfits(language))

"""The words of the source: bare participles as names of functions, docstrings that open with a function word, and
turns of phrase that have a plainer form.

`python -m benchmarks.house_words [--list] [PATH ...]` counts them below these paths, by default in all Python that is
shipped; `--list` names each place.
"""

import ast
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
SHIPPED = ("tangible_core", "plugins")
_FUNCTION_WORDS = """
a about above after again all also among and another any as at be because been before below beside besides
between both but by called can does down each either else even every everything few for from half he her here
how however if in inside instead into is it its itself just least left less likewise made many may more most
much must near neither no nobody nor not nothing now of off on once one only or other others otherwise out over
own per said same several she should since so some somebody something still such than that their them then there
these they this those though through to together told too toward under until up upon was what whatever when
whenever where wherever whether which whichever while who whoever whom whose why will with within without yes
"""
_NOUN_PHRASES = "a all another both called each every half made no said several some told"
FUNCTION_WORDS = frozenset(_FUNCTION_WORDS.split()) - frozenset(_NOUN_PHRASES.split())
"""Words that begin neither an imperative nor a noun phrase; articles and counts of a noun are left out."""
_IRREGULAR = """
asked awaited become been begun bent bound bought bred brought built burnt caught chosen come cut dealt done
drawn driven dug eaten fallen fed felt fit flown forbidden forgotten found frozen given gone got grown heard
held hidden hit hung hurt kept known laid learnt led left lent let lost made meant met paid put read ridden
risen run said sat seen sent set shown shut slept slid sold sought spent split spoken spread stolen stood stuck
struck sunk swept swum swung taken taught thought thrown told torn understood woken won worn written wrung
"""
IRREGULAR = frozenset(_IRREGULAR.split())
"""Participles that do not end in -ed."""
_VERBS = "cut feed fit heed hit let need put read run seed set shed shut speed split spread"
VERBS = frozenset(_VERBS.split())
"""Participles that are imperatives as well, and words on -ed that are not participles."""

PLAINER = {
    r"(is|are|was|were|be|been) told(?! apart| from)": "log, report, print, show",
    r"(is|are|was|were|be|been) said(?! to)": "log, report, print, show",
    r"puts? right": "correct",
    r"(?<!there )(?<!here )(is|are|was|were) no(?= \w)(?! \w+er\b| more\b| less\b| worse\b)": "is not a",
    r"(?<!there )(?<!here )(is|are|was|were) none of (its|his|theirs|ours)": "is not one of",
    r"of one's own": "custom",
    r"so many(?! that)": "n",
    r"what is felt": "the surface, the touch",
    r"(handed|handing) on": "pass, export",
    r"asked for": "requested",
    r"whoever": "people who, a program that",
}
"""Turns of phrase of which a reader has to think twice, as regular expressions, and the plainer words for each."""
_PLAINER = re.compile("|".join(rf"\b(?:{each})\b" for each in PLAINER), re.IGNORECASE)


class Place(NamedTuple):
    """A name or a docstring that breaks a rule."""

    path: Path
    line: int
    text: str


class Words(NamedTuple):
    """The counts of some files, and the places that break a rule."""

    functions: int
    participles: list[Place]
    docstrings: int
    openers: list[Place]

    def __str__(self) -> str:
        names, texts = share(self.participles, self.functions), share(self.openers, self.docstrings)
        return (
            f"bare participles {len(self.participles)} of {self.functions} functions ({names:.1f} %); "
            f"docstrings that open with a function word {len(self.openers)} of {self.docstrings} ({texts:.1f} %)"
        )


def share(places: list[Place], count: int) -> float:
    """Return the share of places, in per cent."""
    return 100 * len(places) / max(count, 1)


def count_words(paths: Iterable[Path]) -> Words:
    """Count the words of the Python files below these paths."""
    words = Words(0, [], 0, [])
    for path in (file for each in paths for file in ([each] if each.is_file() else sorted(each.rglob("*.py")))):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
        docstrings = list(docstrings_of(tree))
        words.participles.extend(
            Place(path, node.lineno, node.name) for node in functions if is_bare_participle(node.name)
        )
        words.openers.extend(
            Place(path, line, text.partition("\n")[0]) for line, text in docstrings if opens_badly(text)
        )
        words = words._replace(
            functions=words.functions + len(functions), docstrings=words.docstrings + len(docstrings)
        )
    return words


def is_bare_participle(name: str) -> bool:
    """Tell whether a function's name is one participle, alone.

    >>> [is_bare_participle(name) for name in ("told", "_filtered", "read", "notify")]
    [True, True, False, False]
    """
    word = name.strip("_")
    if "_" in word or word in VERBS:
        return False
    return word in IRREGULAR or (word.endswith("ed") and len(word) > 3)


def opens_badly(text: str) -> bool:
    """Tell whether a docstring opens with a function word.

    >>> opens_badly("Of a part."), opens_badly("The width of a part."), opens_badly("Return the width.")
    (True, False, False)
    """
    first = text.split(maxsplit=1)[0] if text.strip() else ""
    return first.strip("\"'`(),.:;").lower() in FUNCTION_WORDS


def turns_of_phrase(path: Path) -> Iterator[Place]:
    """Yield the turns of phrase in a file that have a plainer form: in the texts of Python, or in every line."""
    text = path.read_text(encoding="utf-8")
    texts = strings_of(ast.parse(text)) if path.suffix == ".py" else enumerate(text.splitlines(), 1)
    for line, each in texts:
        words = " ".join(each.split())
        for match in _PLAINER.finditer(words):
            yield Place(path, line, words[max(0, match.start() - 40) : match.end() + 40])


def strings_of(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the line and the text of every string, docstrings and messages included."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.lineno, node.value


def docstrings_of(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the line and the text of every docstring, those of constants and fields included."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if not isinstance(body, list):
            continue
        for before, each in zip([None, *body], body, strict=False):
            if not (isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant)):
                continue
            text = each.value.value
            documents = before is None and isinstance(
                node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
            )
            if isinstance(text, str) and (documents or isinstance(before, ast.Assign | ast.AnnAssign)):
                yield each.lineno, text


def shipped() -> list[Path]:
    """Return the folders of the Python that is shipped."""
    return [ROOT / each for each in SHIPPED]


if __name__ == "__main__":
    wanted = [Path(each) for each in sys.argv[1:] if each != "--list"] or shipped()
    counted = count_words(wanted)
    if "--list" in sys.argv:
        files = [file for each in wanted for file in ([each] if each.is_file() else sorted(each.rglob("*.py")))]
        turns = [place for file in files for place in turns_of_phrase(file)]
        for place in (*counted.participles, *counted.openers, *turns):
            print(f"{place.path}:{place.line}: {place.text}")
    print(counted)

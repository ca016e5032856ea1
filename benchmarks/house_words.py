"""The words of the source: names that are bare participles, `each`, `..._of`, `MOST_` and `LEAST_`, docstrings that
open with a function word, and comments.

`python -m benchmarks.house_words [--list] [PATH ...]` counts them below these paths, by default in all Python that is
shipped; `--list` names each place.
"""

import ast
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple, TypeGuard

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
# Words that begin neither an imperative nor a noun phrase; articles and counts of a noun are left out.
FUNCTION_WORDS = frozenset(_FUNCTION_WORDS.split()) - frozenset(_NOUN_PHRASES.split())
_IRREGULAR = """
asked awaited become been begun bent bound bought bred brought built burnt caught chosen come cut dealt done
drawn driven dug eaten fallen fed felt fit flown forbidden forgotten found frozen given gone got grown heard
held hidden hit hung hurt kept known laid learnt led left lent let lost made meant met paid put read ridden
risen run said sat seen sent set shown shut slept slid sold sought spent split spoken spread stolen stood stuck
struck sunk swept swum swung taken taught thought thrown told torn understood woken won worn written wrung
"""
IRREGULAR = frozenset(_IRREGULAR.split())  # participles that do not end in -ed
_VERBS = "cut feed fit heed hit let need put read run seed set shed shut speed split spread"
# Participles that are imperatives as well, and words on -ed that are not participles.
VERBS = frozenset(_VERBS.split())


class Place(NamedTuple):
    """A name or a docstring that breaks a rule."""

    path: Path
    line: int
    text: str


class Words:
    """The counts of names, docstrings and lines of some files, and the places that break a rule, by kind."""

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.places: defaultdict[str, list[Place]] = defaultdict(list)

    def add(self, kind: str, place: Place, breaks: bool) -> None:
        """Count a name or a docstring."""
        self.counts[kind] += 1
        if breaks:
            self.places[kind].append(place)

    def share(self, kind: str) -> float:
        """Return the share of a kind that breaks its rule, in per cent."""
        return 100 * len(self.places[kind]) / max(self.counts[kind], 1)

    def __str__(self) -> str:
        return "; ".join(f"{kind}: {len(self.places[kind])} of {self.counts[kind]}" for kind in sorted(self.counts))


def count_words(paths: Iterable[Path]) -> Words:
    """Count the words of the Python files below these paths."""
    words = Words()
    for path in (file for root in paths for file in ([root] if root.is_file() else sorted(root.rglob("*.py")))):
        text = path.read_text(encoding="utf-8")
        lines, tree = text.splitlines(), ast.parse(text)
        words.counts["lines"] += len(lines)
        words.counts["comments"] += sum(line.lstrip().startswith("#") for line in lines)
        sides = " right" in text  # beside it, `left` is a side
        for kind, line, name in names_in(tree):
            place = Place(path, line, name)
            if kind == "loop variables":
                words.add(kind, place, name == "each")
            elif kind == "constants":
                words.add(kind, place, name.strip("_").startswith(("MOST_", "LEAST_")))
            else:
                words.add(kind, place, is_bare_participle(name) and not (sides and name.strip("_") == "left"))
            if kind == "functions":
                words.add("functions x_of", place, name.endswith("_of"))
        for line, docstring in docstrings_of(tree):
            words.add("docstrings", Place(path, line, docstring.partition("\n")[0]), opens_badly(docstring))
    return words


def names_in(tree: ast.Module) -> Iterator[tuple[str, int, str]]:
    """Yield the kind, the line and the name of all that a module names: each local once in its function."""
    for statement in tree.body:
        targets = getattr(statement, "targets", [getattr(statement, "target", None)])
        yield from (("constants", name.lineno, name.id) for name in targets if isinstance(name, ast.Name))
    for node in ast.walk(tree):
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef():
                yield "functions", node.lineno, node.name
                args = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                yield from (("parameters", arg.lineno, arg.arg) for arg in args if arg.arg not in ("self", "cls"))
                stored = {name.id: name.lineno for name in ast.walk(node) if is_stored(name)}
                yield from (
                    ("locals", line, name) for name, line in stored.items() if name not in {a.arg for a in args}
                )
            case ast.ClassDef():
                fields = [item.target for item in node.body if isinstance(item, ast.AnnAssign)]
                yield from (("attributes", name.lineno, name.id) for name in fields if isinstance(name, ast.Name))
            case ast.Attribute(value=ast.Name(id="self"), ctx=ast.Store()):
                yield "attributes", node.lineno, node.attr
            case ast.For() | ast.AsyncFor() | ast.comprehension():
                names = (name for name in ast.walk(node.target) if isinstance(name, ast.Name))
                yield from (("loop variables", name.lineno, name.id) for name in names)
            case _:
                pass


def is_stored(node: ast.AST) -> TypeGuard[ast.Name]:
    """Return True for a name to which something is assigned."""
    return isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)


def is_bare_participle(name: str) -> bool:
    """Return True for a name that is one participle, alone.

    >>> [is_bare_participle(name) for name in ("told", "_filtered", "read", "notify")]
    [True, True, False, False]
    """
    word = name.strip("_")
    if "_" in word or word in VERBS:
        return False
    return word in IRREGULAR or (word.endswith("ed") and len(word) > 3)


def opens_badly(text: str) -> bool:
    """Return True for a docstring that opens with a function word.

    >>> opens_badly("Of a part."), opens_badly("The width of a part."), opens_badly("Return the width.")
    (True, False, False)
    """
    first = text.split(maxsplit=1)[0] if text.strip() else ""
    return first.strip("\"'`(),.:;").lower() in FUNCTION_WORDS


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
    wanted = [Path(word) for word in sys.argv[1:] if word != "--list"] or shipped()
    counted = count_words(wanted)
    if "--list" in sys.argv:
        for kind, places in counted.places.items():
            for place in places:
                print(f"{place.path}:{place.line}: {kind}: {place.text}")
    print(counted)

"""Faults put into the code on purpose, one at a time: do the tests notice? Reasons in docs/decisions/0014-mutants.md.

python -m benchmarks mutants                        # all lists; the score goes to benchmarks/results
python -m benchmarks mutants guard --jobs 2         # those of a list, or whose name has this in it
python -m benchmarks mutants --sample 400 --seed 1  # faults drawn at random; needs the dependency group `nightly`
python -m benchmarks mutants study export --sample 40 --seed 1  # in these rooms
"""

import argparse
import os
import shutil
import signal
import sys
import tempfile
from collections.abc import Generator, Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import closing, contextmanager
from enum import StrEnum
from itertools import groupby
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

from tangible_core.servo.ring import shared_folder

from .figures import Figure, judged, table
from .mutants_lists import Mutant, StaleError, mutants
from .mutants_sample import sample
from .mutants_tree import Programs, Tree, copy_of

ROOT = Path(__file__).parents[1]
# A mutant's tests may take so long, and three times what all tests of its list take without it; then they hang.
PATIENCE_S = 30.0
PASSED, INTERRUPTED = 0, 2
"""What pytest ends with: 1 between them where a test fails, the last where a test file cannot be imported."""


class Outcome(StrEnum):
    """What became of a mutant."""

    KILLED = "killed"
    HUNG = "killed (hung)"
    SURVIVED = "SURVIVED"
    EXPLAINED = "explained"
    CONTRADICTED = "KILLED, ALTHOUGH CALLED EQUIVALENT"
    BROKEN = "BROKEN"


BAD = (Outcome.SURVIVED, Outcome.CONTRADICTED, Outcome.BROKEN)


class Result(NamedTuple):
    """A mutant, what became of it, and the line of pytest that says it."""

    mutant: Mutant
    outcome: Outcome
    seconds: float
    why: str


class UnreadyError(Exception):
    """Nothing can be said of mutants: without any fault the tests fail, or are not those of the copy."""


def section() -> str:
    """Return the section as Markdown."""
    results = complete(ROOT, (), _jobs())
    count = _count(results, *BAD)
    return "\n".join([*rows(results), "", *judged([Figure("faults not noticed", "none", str(count), not count)])])


def rows(results: Iterable[Result]) -> list[str]:
    """Return a table with a line a list, and a line each for what went wrong."""
    found = sorted(results, key=lambda each: each.mutant.room)
    measured = {room: _row(list(group)) for room, group in groupby(found, lambda each: each.mutant.room)}
    sums = (str(sum(map(int, column))) for column in zip(*measured.values(), strict=True))
    lines = [*((f"`{room}`", *cells) for room, cells in measured.items()), ("all", *sums)]
    wrong = [f"- {each.mutant.place}: {each.mutant.name}: {each.outcome}" for each in found if each.outcome in BAD]
    return [
        "A fault at a time is put into a copy of the code, and the tests that are named beside it are run. Lists and "
        "explanations: `benchmarks/mutations`.",
        "",
        *table(("list", "mutants", "killed", "of them hung", "explained", "not noticed", "seconds"), lines),
        *(["", *wrong] if wrong else []),
    ]


def _row(results: Sequence[Result]) -> tuple[str, ...]:
    counts = [
        len(results),
        _count(results, Outcome.KILLED, Outcome.HUNG),
        _count(results, Outcome.HUNG),
        _count(results, Outcome.EXPLAINED),
        _count(results, *BAD),
    ]
    return *map(str, counts), f"{sum(result.seconds for result in results):.0f}"


def _count(results: Iterable[Result], *outcomes: Outcome) -> int:
    return sum(result.outcome in outcomes for result in results)


def run(root: Path, chosen: Sequence[Mutant], jobs: int, patience_s: float = PATIENCE_S) -> Generator[Result]:
    """Yield the chosen mutants of a tree, as they are done.

    Raises: UnreadyError if the tests do not pass without them.
    """
    programs = Programs()
    with _folder(None) as folder, _folder(shared_folder()) as shared:
        pool = ThreadPoolExecutor(jobs)
        try:
            limits_s = pool.submit(_unharmed, root, folder / "0", shared / "0", chosen, programs).result()
            futures: list[Future[Result]] = [
                pool.submit(_tried, folder, shared, i, each, patience_s + 3 * limits_s[each.room], programs)
                for i, each in enumerate(chosen, 1)
            ]
            for future in as_completed(futures):
                yield future.result()
        finally:  # Ctrl-C too, and a caller who wants no more
            programs.stop()
            pool.shutdown(cancel_futures=True)


@contextmanager
def _folder(parent: Path | None) -> Generator[Path]:
    with tempfile.TemporaryDirectory(prefix="mutants-", dir=parent, ignore_cleanup_errors=True) as folder:
        yield Path(folder)


def _unharmed(root: Path, folder: Path, shared: Path, chosen: Sequence[Mutant], programs: Programs) -> dict[str, float]:
    """Seconds that the tests of each list take in a copy without any fault; it is left with all compiled."""
    tree = Tree(folder, shared)
    copy_of(root, tree.sources)
    tree.make()
    if not tree.owns(programs, [each.file for each in chosen]):
        raise UnreadyError("what the tests import is not what was copied")
    seconds: dict[str, float] = {}
    for room in dict.fromkeys(each.room for each in chosen):
        start = perf_counter()
        tests = dict.fromkeys(test for each in chosen if each.room == room for test in each.tests)
        if tests:
            ended = tree.pytest(programs, list(tests), 3600)
            if ended.code != PASSED:
                raise UnreadyError(f"{room}: its tests fail without any fault:\n{ended.said[-4000:]}")
        seconds[room] = perf_counter() - start
        _say(f"{room}: its tests pass in {seconds[room]:.0f} s")
    return seconds


def _tried(folder: Path, shared: Path, number: int, mutant: Mutant, limit_s: float, programs: Programs) -> Result:
    start = perf_counter()
    if not mutant.tests:
        return Result(mutant, Outcome.EXPLAINED, 0.0, mutant.equivalent)
    tree = Tree(folder / str(number), shared / str(number))
    try:
        shutil.copytree(folder / "0" / "tree", tree.sources)
        tree.make()
        tree.put_in(mutant)
        ended = tree.pytest(programs, mutant.tests, limit_s)
    finally:
        for each in (folder, shared):
            shutil.rmtree(each / str(number), ignore_errors=True)
    outcome = _outcome(mutant, ended.code)
    lines = ended.said.splitlines()[-40 if outcome is Outcome.BROKEN else -1 :]
    why = next((line for line in ended.said.splitlines() if line.startswith(("FAILED", "ERROR"))), "\n".join(lines))
    return Result(mutant, outcome, perf_counter() - start, why)


def _outcome(mutant: Mutant, code: int | None) -> Outcome:
    if code == PASSED:
        return Outcome.EXPLAINED if mutant.equivalent else Outcome.SURVIVED
    if code is not None and code > INTERRUPTED:
        return Outcome.BROKEN
    if mutant.equivalent:
        return Outcome.CONTRADICTED
    return Outcome.HUNG if code is None else Outcome.KILLED


def complete(root: Path, words: Sequence[str], jobs: int) -> list[Result]:
    """Those of the lists, or with names, that the words are of; each said as it is done."""
    try:
        known = mutants(root)
        rooms = sorted({each.room for each in known})
        chosen = [
            each
            for each in known
            if not words or any(each.room == word if word in rooms else word in each.name for word in words)
        ]
        if not chosen:
            sys.exit(f"no mutant is of {', '.join(words)}; lists are {', '.join(rooms)}")
        return _all(root, chosen, jobs)
    except StaleError as error:
        sys.exit(str(error))


def _all(root: Path, chosen: Sequence[Mutant], jobs: int) -> list[Result]:
    results: list[Result] = []
    try:
        with closing(run(root, chosen, jobs)) as done:
            for result in done:
                results.append(result)
                place = f"{result.mutant.place}: {result.mutant.name}"
                _say(f"[{len(results)}/{len(chosen)}] {place}: {result.outcome} ({result.seconds:.0f} s) {result.why}")
    except UnreadyError as error:
        sys.exit(str(error))
    return results


def sampled(root: Path, rooms: Sequence[str], count: int, seed: int, jobs: int) -> list[Result]:
    """Return what becomes of faults that are drawn at random, each printed as it is done."""
    try:
        return _all(root, sample(root, count, seed, rooms), jobs)
    except (ImportError, ValueError) as error:
        sys.exit(
            f"{error}; mutmut comes by `pip install --group nightly`" if isinstance(error, ImportError) else str(error)
        )


def shares(results: Iterable[Result]) -> list[str]:
    """Return the share of faults that were noticed, in all and by room, as a table."""
    found = sorted(results, key=lambda result: result.mutant.room)
    by_room = {room: list(group) for room, group in groupby(found, lambda result: result.mutant.room)}
    cells = [
        (name, str(len(group)), f"{_count(group, Outcome.KILLED, Outcome.HUNG) / len(group):.2f}")
        for name, group in [*by_room.items(), *([("all", found)] if found else [])]
    ]
    unnoticed = [
        f"- {result.mutant.place}: {result.mutant.name}: {result.outcome}" for result in found if result.outcome in BAD
    ]
    return [*table(("room", "faults", "noticed"), cells), "", *unnoticed]


def _say(text: str) -> None:
    print(f"  {text}", file=sys.stderr, flush=True)


def _jobs() -> int:
    return max(1, (os.cpu_count() or 1) // 2)


def main(words: Sequence[str] | None = None) -> None:
    """Run the command line, or these words of one; exit 1 if a mutant was not noticed."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks mutants", description="Do the tests notice faults?")
    parser.add_argument("words", nargs="*", help="names of lists, or parts of names of mutants; all")
    parser.add_argument("--jobs", type=int, default=_jobs(), help="so many at a time (%(default)s)")
    parser.add_argument("--sample", type=int, metavar="N", help="draw so many faults at random; the words are rooms")
    parser.add_argument("--seed", type=int, default=1, help="seed of the sample (%(default)s)")
    asked = parser.parse_args(words)
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, signal.default_int_handler)
    try:
        if asked.sample:
            print("\n".join(shares(sampled(ROOT, asked.words, asked.sample, asked.seed, asked.jobs))))
            sys.exit()
        results = complete(ROOT, asked.words, asked.jobs)
    except KeyboardInterrupt:
        sys.exit(130)
    print("\n".join(rows(results)))
    sys.exit(any(result.outcome in BAD for result in results))


if __name__ == "__main__":
    main()

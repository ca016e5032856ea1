"""Make what the document says: products, and what is felt; and stop."""

import asyncio
from typing import Any

from tangible_core.errors import Stopped

from ..state.session import Desk, Tab
from ..worker.handle import MakingStopped
from .table import request

PATIENCE_S = 1.5
"""So long what is outdated may take to end by itself."""


@request()
async def make(desk: Desk, tab: Tab | None, want: str = "touch") -> None:
    """Make a product of the document, and feel it if it is a touch. What was being made before gives way."""
    made = await long_job(desk, "make", want, sets=desk.felt_sets(), want=want)
    if made is not None:
        await desk.feel(made)


@request()
async def stop_making(desk: Desk, tab: Tab | None) -> None:
    """End what is being made at once; what is felt goes on."""
    if desk.makes.running:
        desk.makes.stop()
        desk.maker.kill()


@request()
async def try_again(desk: Desk, tab: Tab | None) -> None:
    """Start the maker again, which did not start."""
    desk.maker.try_again()


async def foresee(desk: Desk, apply: bool = False) -> None:
    """Tell what making the document would do; make it if that is asked for and nothing slow has to run."""
    digest, told = desk.digest, {"text": desk.text, "path": desk.path, "sets": desk.felt_sets()}
    plan = await desk.maker.quick("plan", **told, want="touch")
    if desk.digest != digest:
        return  # of a text that was edited again: that edit has its own
    desk.tell("plan", **plan)
    if apply and desk.makes.running:
        desk.makes.apply_after = True
    elif apply and not plan["slow"] and not plan["refusal"]:
        await make(desk, None)


async def long_job(desk: Desk, job: str, needs: str, sets: list[str], **told: Any) -> Any:
    """Do a long job of the document as it is now; None if it was stopped, which pages hear.

    needs: the product that it is made from. Raises: whatever the job raises.
    """
    document = {"text": desk.text, "path": desk.path, "sets": sets}
    digest, earlier, number = desk.digest, set(desk.makes.running), desk.makes.begin()
    try:
        if earlier and await desk.maker.quick("give_way", number=number, **document, want=needs):
            desk.begin(_insist(desk, earlier))
        return await _asked(desk, job, number, {**document, **told})
    except Exception as error:
        outcome = "failed" if _is_wanted(desk, number, error) else "stopped"
        desk.tell("made", want=told.get("want", job), digest=digest, outcome=outcome, why=str(error), seconds=0.0)
        if outcome == "stopped":
            return None
        raise
    finally:
        desk.makes.running.discard(number)
        if desk.makes.apply_after and not desk.makes.running:
            desk.makes.apply_after = False
            desk.begin(foresee(desk, apply=True))


async def _asked(desk: Desk, job: str, number: int, told: dict[str, Any]) -> Any:
    """Ask for a long job; again, if the maker was killed for its sake."""
    while True:
        try:
            return await desk.maker.ask(job, number=number, **told)
        except MakingStopped:
            if not desk.makes.killed or number != desk.makes.newest:
                raise
            desk.makes.killed = False


def _is_wanted(desk: Desk, number: int, error: Exception) -> bool:
    """Whether somebody still waits for it, so that its failure is news."""
    return number == desk.makes.newest or not isinstance(error, Stopped | MakingStopped)


async def _insist(desk: Desk, numbers: set[int]) -> None:
    """Kill the maker if these do not end by themselves."""
    await asyncio.sleep(PATIENCE_S)
    if numbers & desk.makes.running:
        desk.makes.killed = True
        desk.maker.kill()

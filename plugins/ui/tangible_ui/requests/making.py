"""Requests to make products of the document, to export them, and to stop."""

import asyncio
from typing import Any

from tangible_core.errors import Stopped

from ..state.session import Session
from ..state.tabs import Tab
from ..worker.handle import WorkerKilled
from .table import request

# Time that an outdated job has to end by itself before the worker is killed, s.
PATIENCE_S = 1.5


@request()
async def make(session: Session, tab: Tab | None, want: str = "touch") -> None:
    """Make a product of the document, and feel it if it is a touch. Earlier jobs give way."""
    loop_input = await long_job(session, "make", want, sets=session.felt_sets(), want=want)
    if loop_input is not None:
        await session.feel(loop_input)


@request()
async def stop_making(session: Session, tab: Tab | None) -> None:
    """Stop the running jobs at once; the loop goes on."""
    if session.long_jobs.running:
        session.long_jobs.stop()
        session.worker.kill()


@request()
async def try_again(session: Session, tab: Tab | None) -> None:
    """Start the worker again after it failed to start."""
    session.worker.try_again()


async def foresee(session: Session, apply: bool = False) -> None:
    """Send all tabs the plan of making the document. apply: make it unless something slow has to run."""
    digest = session.document.digest
    plan = await session.worker.quick("plan", **session.document.arguments(session.felt_sets()), want="touch")
    if session.document.digest != digest:
        return  # the text was edited again, and that edit sends its own plan
    session.tabs.tell("plan", **plan)
    if apply and session.long_jobs.running:
        session.long_jobs.apply_after = True
    elif apply and not plan["slow"] and not plan["refusal"]:
        await make(session, None)


async def long_job(session: Session, job: str, needs: str, sets: list[str], **arguments: Any) -> Any:
    """Do a long job of the current document, made from the product `needs`; None if stopped. Raises: as the job."""
    document = session.document.arguments(sets)
    digest, earlier, number = session.document.digest, set(session.long_jobs.running), session.long_jobs.begin()
    try:
        if earlier and await session.worker.quick("give_way", number=number, **document, want=needs):
            session.begin(_kill_if_still_running(session, earlier))
        return await _request_job(session, job, number, {**document, **arguments})
    except Exception as error:
        # Somebody still waits for the newest job, and hears of a failure that no stop explains.
        is_reported = number == session.long_jobs.newest or not isinstance(error, Stopped | WorkerKilled)
        outcome = "failed" if is_reported else "stopped"
        message = {"want": arguments.get("want", job), "outcome": outcome, "why": str(error), "seconds": 0.0}
        session.tabs.tell("made", digest=digest, **message)
        if outcome == "stopped":
            return None
        raise
    finally:
        session.long_jobs.running.discard(number)
        if session.long_jobs.apply_after and not session.long_jobs.running:
            session.long_jobs.apply_after = False
            session.begin(foresee(session, apply=True))


async def _request_job(session: Session, job: str, number: int, arguments: dict[str, Any]) -> Any:
    """Request a long job, and again if the worker was killed for its sake."""
    while True:
        try:
            return await session.worker.ask(job, number=number, **arguments)
        except WorkerKilled:
            if not session.long_jobs.was_killed or number != session.long_jobs.newest:
                raise
            session.long_jobs.was_killed = False


async def _kill_if_still_running(session: Session, numbers: set[int]) -> None:
    """Kill the worker if these jobs do not end by themselves."""
    await asyncio.sleep(PATIENCE_S)
    if numbers & session.long_jobs.running:
        session.long_jobs.was_killed = True
        session.worker.kill()


@request()
async def export(
    session: Session, tab: Tab | None, exports: list[dict[str, Any] | str], language: str = "en"
) -> dict[str, Any] | None:
    """Write files of the document, by `export:` of a pipeline file; None if it was stopped. Raises: ConfigError."""
    return await long_job(session, "export", "surface", session.document.sets, exports=exports, language=language)

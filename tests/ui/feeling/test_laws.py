"""Two laws compared: one acts, the page shows the other's force; a blind comparison hides which is which."""

import asyncio
import os
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from tangible_core import load_method
from tangible_core.errors import ConfigError
from tangible_core.servo import Packed, Safety, pack_touch
from tangible_ui.feeling.choice import Choice, NotConfirmed
from tangible_ui.feeling.comparison import NOTHING
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.framing import STATE_FRAME
from tangible_ui.requests import feeling as asks
from tangible_ui.serving.serve import watch
from tangible_ui.state.session import Session
from waiting import happened

TEXT = """\
scene: {height: flat.npy}
want: touch
workspace: {relief_m: 0.001, smooth_m: 0}
render: {use: penalty, stiffness_n_per_m: 400}
device: {use: pointer}
"""
DEPTH_M = 0.001


@asynccontextmanager
async def felt_session(folder: Path) -> AsyncIterator[tuple[Session, list[dict[str, Any]]]]:
    """A session whose document is felt, and what it told."""
    np.save(folder / "flat.npy", np.zeros((8, 8)))
    (folder / "scene").mkdir()
    session = Session(folder / "scene", Feeling(f"laws-{os.getpid()}"), [])
    told: list[dict[str, Any]] = []

    class Heard:
        def say(self, event: dict[str, Any]) -> None:
            told.append(event)

    session.enter(Heard())
    session.text, session.path = TEXT, folder / "p.yaml"
    try:
        made = (await session.worker.ask("laws", text=TEXT, path=session.path, sets=session.felt_sets(), others=[]))[0]
        await session.feel(made)
        yield session, told
    finally:
        await session.close()


def forces(session: Session) -> tuple[float, float]:
    """Upwards: of the law that is felt, and of the other one, as a page has them."""
    frame = session.feeling.frame(1, 0, session.laws.other_law())
    assert frame is not None
    values = STATE_FRAME.unpack(frame)
    return values[15], values[21]


def raises_soon() -> Packed:
    return pack_touch(FaultyTouch("odd error"), load_method("device", "pointer")().spec())


async def press_until(session: Session, until: Callable[[], bool]) -> None:
    """Press on the surface until something is so."""

    def press() -> bool:
        session.feeling.hand.point((0.0, 0.0, -DEPTH_M), 1, 1)
        session.laws.follow(session.feeling)
        return until()

    await happened(press)


@pytest.mark.usefixtures("loop_in_thread")
def test_second_law_is_computed_on_the_same_hand(tmp_path: Path) -> None:
    async def compare() -> None:
        async with felt_session(tmp_path) as (session, told):
            await asks.compare_laws(session, None, "penalty", "{stiffness_n_per_m: 800}")
            await press_until(session, lambda: np.allclose(forces(session), (0.4, 0.8), atol=0.02))
            await asks.switch_law(session, None, "b")
            await press_until(session, lambda: np.allclose(forces(session), (0.8, 0.4), atol=0.02))
            assert told[-1]["named"] == ["penalty (a)", "penalty (b)"]
            assert told[-1]["felt"] == 1
            session.feeling.hand.release()

            def release_and_look() -> bool:
                session.laws.follow(session.feeling)
                return forces(session) == (0, 0)

            await happened(release_and_look)
            await asks.end_laws(session, None)
            assert session.laws.comparison.force_n == NOTHING
            assert not session.laws.comparison.running
            await press_until(session, lambda: np.allclose(forces(session), (0.4, 0), atol=0.02))

    asyncio.run(compare())


@pytest.mark.usefixtures("loop_in_thread")
def test_second_law_that_raises_is_reported_once_and_can_be_replaced(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async def compare() -> None:
        async with felt_session(tmp_path) as (session, _):
            await asks.compare_laws(session, None, "penalty", "{stiffness_n_per_m: 800}")
            session.laws.comparison.feel(raises_soon(), Safety())
            polling = asyncio.ensure_future(watch(session))
            await press_until(session, lambda: "penalty (b) is no longer computed" in caplog.text)
            await press_until(session, lambda: np.allclose(forces(session), (0.4, 0), atol=0.02))
            await asks.switch_law(session, None, "b")
            await press_until(session, lambda: np.allclose(forces(session), (0.8, 0.4), atol=0.02))
            assert caplog.text.count("OddError") == 1
            polling.cancel()
            session.laws.comparison.feel(raises_soon(), Safety())
            await press_until(session, lambda: not session.laws.comparison.running)  # and the session can be closed

    asyncio.run(compare())


@pytest.mark.usefixtures("loop_in_thread")
def test_blind_comparison_hides_which_law_acts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))

    async def compare() -> None:
        async with felt_session(tmp_path) as (session, told):
            await asks.compare_laws(session, None, "proxy", "")
            told.clear()
            await asks.begin_blind(session, None, "Which is harder?")
            tally = session.laws.tally
            assert tally is not None
            for called in (2, 1):
                await asks.feel_blind(session, None, called)
                await press_until(session, lambda: forces(session)[0] > 0.1)
                frame = STATE_FRAME.unpack(session.feeling.frame(1, 0, session.laws.other_law()) or b"")
                assert all(np.isnan(frame[10:13]))
                assert frame[19:22] == (0, 0, 0)
            assert not [event for event in told if "penalty" in str(event) or "proxy" in str(event)]
            chosen = tally.laws[tally.law(2)]
            await asks.choose_blind(session, None, 2)
            found = await asks.end_blind(session, None)
            assert found["trials"][0][2] == chosen
            assert Path(found["path"]).is_relative_to(tmp_path / "data")
            assert chosen in Path(found["path"]).read_text()

    asyncio.run(compare())


@pytest.mark.usefixtures("loop_in_thread")
def test_invalid_law_is_refused_and_the_law_before_stays(tmp_path: Path) -> None:
    wrong = {("penalti", ""): "penalty", ("penalty", "{stifness: 3}"): "unknown option", ("penalty", "["): "not YAML"}

    async def compare() -> None:
        async with felt_session(tmp_path) as (session, _):
            for (use, options), says in wrong.items():
                with pytest.raises(ConfigError, match=says):
                    await asks.compare_laws(session, None, use, options)
            assert session.laws.message() == {"state": "one"}
            await press_until(session, lambda: np.allclose(forces(session), (0.4, 0), atol=0.02))

    asyncio.run(compare())


@pytest.mark.usefixtures("loop_in_thread")
def test_comparison_opens_no_motor_without_consent(tmp_path: Path) -> None:
    async def compare() -> None:
        async with felt_session(tmp_path) as (session, _):
            session.choice = Choice("document", sure=True, agreed=type(load_method("device", "mock")()))
            session.text = TEXT.replace("{use: pointer}", "{use: falcon}")
            with pytest.raises(NotConfirmed):
                await asks.compare_laws(session, None, "penalty", "")
            assert session.laws.message() == {"state": "one"}
            await press_until(session, lambda: np.allclose(forces(session), (0.4, 0), atol=0.02))

    asyncio.run(compare())

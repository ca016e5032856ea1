"""Two laws on one hand: one is felt, the other's force is shown; blindly, nobody is told which."""

import asyncio
import os
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tangible_core import load_method
from tangible_core.errors import ConfigError
from tangible_ui.feeling.choice import Choice, NotAgreed
from tangible_ui.feeling.comparison import NOTHING
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.framing import STATE_FRAME
from tangible_ui.requests import feeling as asks
from tangible_ui.state.session import Desk
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
async def felt_desk(folder: Path) -> AsyncIterator[tuple[Desk, list[dict[str, Any]]]]:
    """A desk whose document is felt, and what it told."""
    np.save(folder / "flat.npy", np.zeros((8, 8)))
    (folder / "scene").mkdir()
    desk = Desk(folder / "scene", Feeling(f"laws-{os.getpid()}"), [])
    told: list[dict[str, Any]] = []

    class Heard:
        def say(self, event: dict[str, Any]) -> None:
            told.append(event)

    desk.enter(Heard())
    desk.text, desk.path = TEXT, folder / "p.yaml"
    try:
        made = (await desk.maker.ask("laws", text=TEXT, path=desk.path, sets=desk.felt_sets(), others=[]))[0]
        await desk.feel(made)
        yield desk, told
    finally:
        await desk.close()


def forces(desk: Desk) -> tuple[float, float]:
    """Upwards: of the law that is felt, and of the other one, as a page has them."""
    frame = desk.feeling.frame(1, 0, desk.laws.beside())
    assert frame is not None
    values = STATE_FRAME.unpack(frame)
    return values[15], values[21]


async def pressed(desk: Desk, until: Callable[[], bool]) -> None:
    """Press on the surface until something is so."""

    def pressed() -> bool:
        desk.feeling.hand.point((0.0, 0.0, -DEPTH_M), 1, 1)
        desk.laws.follow(desk.feeling)
        return until()

    await happened(pressed)


@pytest.mark.usefixtures("loop_in_thread")
def test_the_other_law_is_computed_on_the_same_hand(tmp_path: Path) -> None:
    async def compare() -> None:
        async with felt_desk(tmp_path) as (desk, told):
            await asks.compare_laws(desk, None, "penalty", "{stiffness_n_per_m: 800}")
            await pressed(desk, lambda: np.allclose(forces(desk), (0.4, 0.8), atol=0.02))
            await asks.switch_law(desk, None, "b")
            await pressed(desk, lambda: np.allclose(forces(desk), (0.8, 0.4), atol=0.02))
            assert told[-1]["named"] == ["penalty (a)", "penalty (b)"]
            assert told[-1]["felt"] == 1
            desk.feeling.hand.release()

            def released() -> bool:
                desk.laws.follow(desk.feeling)
                return forces(desk) == (0, 0)

            await happened(released)
            await asks.end_laws(desk, None)
            assert desk.laws.rival.force_n == NOTHING
            assert not desk.laws.rival.running
            await pressed(desk, lambda: np.allclose(forces(desk), (0.4, 0), atol=0.02))

    asyncio.run(compare())


@pytest.mark.usefixtures("loop_in_thread")
def test_blindly_nothing_says_which_law_is_felt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))

    async def compare() -> None:
        async with felt_desk(tmp_path) as (desk, told):
            await asks.compare_laws(desk, None, "proxy", "")
            told.clear()
            await asks.begin_blind(desk, None, "Which is harder?")
            tally = desk.laws.tally
            assert tally is not None
            for called in (2, 1):
                await asks.feel_blind(desk, None, called)
                await pressed(desk, lambda: forces(desk)[0] > 0.1)
                frame = STATE_FRAME.unpack(desk.feeling.frame(1, 0, desk.laws.beside()) or b"")
                assert all(np.isnan(frame[10:13]))
                assert frame[19:22] == (0, 0, 0)
            assert not [event for event in told if "penalty" in str(event) or "proxy" in str(event)]
            chosen = tally.laws[tally.law(2)]
            await asks.choose_blind(desk, None, 2)
            found = await asks.end_blind(desk, None)
            assert found["trials"][0][2] == chosen
            assert Path(found["path"]).is_relative_to(tmp_path / "data")
            assert chosen in Path(found["path"]).read_text()

    asyncio.run(compare())


@pytest.mark.usefixtures("loop_in_thread")
def test_what_is_no_law_is_said_and_the_one_before_is_felt_on(tmp_path: Path) -> None:
    wrong = {("penalti", ""): "penalty", ("penalty", "{stifness: 3}"): "unknown option", ("penalty", "["): "not YAML"}

    async def compare() -> None:
        async with felt_desk(tmp_path) as (desk, _):
            for (use, options), says in wrong.items():
                with pytest.raises(ConfigError, match=says):
                    await asks.compare_laws(desk, None, use, options)
            assert desk.laws.told() == {"state": "one"}
            await pressed(desk, lambda: np.allclose(forces(desk), (0.4, 0), atol=0.02))

    asyncio.run(compare())


@pytest.mark.usefixtures("loop_in_thread")
def test_no_motor_is_opened_that_nobody_said_yes_to(tmp_path: Path) -> None:
    async def compare() -> None:
        async with felt_desk(tmp_path) as (desk, _):
            desk.choice = Choice("document", sure=True, agreed=type(load_method("device", "mock")()))
            desk.text = TEXT.replace("{use: pointer}", "{use: falcon}")
            with pytest.raises(NotAgreed):
                await asks.compare_laws(desk, None, "penalty", "")
            assert desk.laws.told() == {"state": "one"}
            await pressed(desk, lambda: np.allclose(forces(desk), (0.4, 0), atol=0.02))

    asyncio.run(compare())

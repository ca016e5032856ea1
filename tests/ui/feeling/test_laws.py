"""Two laws compared: otherwise the force of another law is felt or shown, or a study of them is of others."""

import asyncio
import math
import os
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from sessions import Heard, InlineWorker
from tangible_core import load_method
from tangible_core.errors import ConfigError
from tangible_core.plugins.registry import default_registry
from tangible_core.servo import Packed, Safety, pack_touch
from tangible_study.presenting.stimuli import Stimuli
from tangible_study.study_file import config_of_recipe, load_study
from tangible_ui.feeling.choice import Choice, NotConfirmed
from tangible_ui.feeling.comparison import NOTHING, ComparisonLoop
from tangible_ui.feeling.feeling import Feeling
from tangible_ui.requests import feeling as asks
from tangible_ui.serving.serve import watch
from tangible_ui.state.session import Laws, Session
from tangible_web.framing import STATE_FRAME
from waiting import happened

TEXT = """\
scene: {height: flat.npy}
want: touch
workspace: {relief_m: 0.001, smooth_m: 0}
render: {use: penalty, stiffness_n_per_m: 400}
device: {use: pointer}
"""
DEPTH_M = 0.001
pytestmark = pytest.mark.anyio


@pytest.fixture
async def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, loop_in_thread: None) -> AsyncIterator[Session]:
    """A session whose document is felt."""
    monkeypatch.setenv("TANGIBLE_DATA_DIR", str(tmp_path / "data"))
    monkeypatch.setattr("tangible_ui.state.session.Worker", InlineWorker)
    np.save(tmp_path / "flat.npy", np.zeros((8, 8)))
    (tmp_path / "scene").mkdir()
    session = Session(tmp_path / "scene", Feeling(f"laws-{os.getpid()}"), [])
    session.document.text, session.document.path = TEXT, tmp_path / "p.yaml"
    try:
        [made] = await session.worker.ask("laws", **session.document.arguments(session.felt_sets()), others=[])
        await session.feel(made)
        yield session
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


async def test_second_law_is_computed_on_the_same_hand(session: Session, tab: Heard) -> None:
    await asks.compare_laws(session, None, "penalty", "{stiffness_n_per_m: 800}")
    await press_until(session, lambda: np.allclose(forces(session), (0.4, 0.8), atol=0.02))
    await asks.switch_law(session, None, "b")
    await press_until(session, lambda: np.allclose(forces(session), (0.8, 0.4), atol=0.02))
    assert (tab.events[-1]["named"], tab.events[-1]["felt"]) == (["penalty (a)", "penalty (b)"], 1)
    session.feeling.hand.release()

    def release_and_look() -> bool:
        session.laws.follow(session.feeling)
        return forces(session) == (0, 0)

    await happened(release_and_look)
    await asks.end_laws(session, None)
    assert session.laws.comparison.force_n == NOTHING
    assert not session.laws.comparison.running
    await press_until(session, lambda: np.allclose(forces(session), (0.4, 0), atol=0.02))


async def test_second_law_that_raises_is_reported_once_and_can_be_replaced(
    session: Session, caplog: pytest.LogCaptureFixture
) -> None:
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


@pytest.mark.parametrize("question", ["same", "rougher", "higher"])
async def test_study_of_both_laws_is_a_study_that_can_be_run(session: Session, question: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="no other law"):
        await asks.study_laws(session, None, question)
    await asks.compare_laws(session, None, "penalty", "{stiffness_n_per_m: 800}")
    found = await asks.study_laws(session, None, question, "de")
    assert Path(found["file"]).is_relative_to(tmp_path / "data")
    stimuli = Stimuli(load_study(Path(found["file"])))
    stimuli.make(lambda _: None)
    stimuli.check()
    study = stimuli.file.study
    assert (study.language, study.comparisons[0].question) == ("de", question)
    configs = {
        key[1].condition: config_of_recipe(recipe, default_registry()) for key, recipe in stimuli.recipes.items()
    }
    laws: Any = {name: config.render and config.render.method for name, config in configs.items()}
    assert {name: law.stiffness_n_per_m for name, law in laws.items()} == {"penalty (a)": 400, "penalty (b)": 800}


async def test_invalid_law_is_refused_and_the_law_before_stays(session: Session) -> None:
    wrong = {("penalti", ""): "penalty", ("penalty", "{stifness: 3}"): "unknown option", ("penalty", "["): "not YAML"}
    with pytest.raises(ConfigError, match="no other law"):
        await asks.switch_law(session, None, "b")

    for (use, options), says in wrong.items():
        with pytest.raises(ConfigError, match=says):
            await asks.compare_laws(session, None, use, options)
    assert session.laws.message() == {"state": "one"}
    await press_until(session, lambda: np.allclose(forces(session), (0.4, 0), atol=0.02))


async def test_comparison_opens_no_motor_without_consent(session: Session) -> None:
    session.choice = Choice("document", sure=True, agreed_device=type(load_method("device", "mock")()))
    session.document.text = TEXT.replace("{use: pointer}", "{use: falcon}")
    with pytest.raises(NotConfirmed):
        await asks.compare_laws(session, None, "penalty", "")
    assert session.laws.message() == {"state": "one"}
    await press_until(session, lambda: np.allclose(forces(session), (0.4, 0), atol=0.02))


@pytest.mark.parametrize("running", [True, False])
def test_second_law_follows_the_hand_and_leaves_with_it(running: bool) -> None:
    ring = SimpleNamespace(latest=lambda: np.arange(17.0))
    feeling: Any = Mock(Feeling, servo=SimpleNamespace(ring=ring), running=running)
    comparison = Mock(ComparisonLoop, running=True)
    Laws(comparison).follow(feeling)
    comparison.follow.assert_called_once_with((2.0, 3.0, 4.0 if running else math.inf))

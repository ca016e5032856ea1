import logging

import pluggy
import pytest

from tangible_core.data import NO_FORCE, HapticState, Outcome, Plan, ServoReport
from tangible_core.plugins import hooks
from tangible_core.plugins.hooks import hookimpl

RAN = Outcome("relief", "ran", "requested")
FACTS = {
    "tangible_methods": {"kind": "depth"},
    "tangible_plan_made": {"plan": Plan("relief", (RAN,))},
    "tangible_stage_started": {"product": "relief", "method": "core"},
    "tangible_stage_finished": {"outcome": RAN},
    "tangible_servo_report": {"report": ServoReport(1, 0.001, HapticState((0, 0, 0)), NO_FORCE, 1.0, 0.0)},
    "tangible_panels": {},
    "tangible_listings": {},
    "tangible_legibility": {},
    "tangible_commands": {"app": object()},
}


def manager(*observers) -> pluggy.PluginManager:
    plugins = pluggy.PluginManager("tangible")
    plugins.add_hookspecs(hooks.Specs)
    for observer in observers:
        plugins.register(observer, name=type(observer).__name__)
    return plugins


class Witness:
    def __init__(self):
        self.calls = []

    @hookimpl
    def tangible_methods(self, kind):
        self.calls.append(("tangible_methods", {"kind": kind}))
        return {"mine": "acme:Mine"}

    @hookimpl
    def tangible_plan_made(self, plan):
        self.calls.append(("tangible_plan_made", {"plan": plan}))

    @hookimpl
    def tangible_stage_started(self, product, method):
        self.calls.append(("tangible_stage_started", {"product": product, "method": method}))

    @hookimpl
    def tangible_stage_finished(self, outcome):
        self.calls.append(("tangible_stage_finished", {"outcome": outcome}))

    @hookimpl
    def tangible_servo_report(self, report):
        self.calls.append(("tangible_servo_report", {"report": report}))

    @hookimpl
    def tangible_panels(self):
        self.calls.append(("tangible_panels", {}))

    @hookimpl
    def tangible_listings(self):
        self.calls.append(("tangible_listings", {}))

    @hookimpl
    def tangible_legibility(self):
        self.calls.append(("tangible_legibility", {}))

    @hookimpl
    def tangible_commands(self, app):
        self.calls.append(("tangible_commands", {"app": app}))


class Failing:
    @hookimpl
    def tangible_stage_finished(self, outcome):
        raise RuntimeError("I always fail")


class Terse:
    """An observer with fewer arguments than the hook has."""

    def __init__(self):
        self.calls = []

    @hookimpl
    def tangible_stage_started(self, product):
        self.calls.append(product)


@pytest.mark.parametrize("moment", FACTS)
def test_hook_calls_observers_with_all_arguments(moment):
    witness = Witness()
    hooks.tell(manager(witness), moment, **FACTS[moment])
    assert witness.calls == [(moment, FACTS[moment])]


def test_hooks_are_all_tested_here():
    assert set(FACTS) == {name for name in vars(hooks.Specs) if name.startswith("tangible_")}


@pytest.mark.parametrize("moment", FACTS)
def test_hook_without_observers_gives_no_answers(moment):
    assert hooks.tell(manager(), moment, **FACTS[moment]) == []


def test_hook_answers_are_returned_without_none():
    assert hooks.tell(manager(Witness(), Failing()), "tangible_methods", kind="depth") == [{"mine": "acme:Mine"}]
    assert hooks.tell(manager(Witness()), "tangible_stage_started", product="relief", method="core") == []


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_failing_observer_is_logged_once_and_harms_no_other(caplog, order, log_dir):
    witness = Witness()
    both = (witness, Failing())
    plugins = manager(*(both[i] for i in order))
    for _ in range(3):
        hooks.tell(plugins, "tangible_stage_finished", outcome=RAN)
    assert witness.calls == 3 * [("tangible_stage_finished", {"outcome": RAN})]
    [record] = caplog.records
    assert (record.levelno, record.exc_info) == (logging.WARNING, None)
    assert "observer Failing failed in tangible_stage_finished" in record.message
    log = log_dir / "failures.log"
    assert f"RuntimeError: I always fail; the traceback is in {log}" in record.message
    assert log.read_text().count("Traceback") == 1


def test_observer_with_fewer_arguments_is_called():
    terse = Terse()
    hooks.tell(manager(terse), "tangible_stage_started", product="relief", method="core")
    assert terse.calls == ["relief"]


def test_hook_modules_are_found_by_entry_point(install):
    install(
        "acme",
        {"tangible.hooks": {"diary": "acme_diary"}},
        acme_diary="""
            from tangible_core.plugins.hooks import hookimpl
            @hookimpl
            def tangible_methods(kind):
                return {kind: "acme:Mine"}
            """,
    )
    plugins = hooks.manager()
    assert hooks.tell(plugins, "tangible_methods", kind="depth") == [{"depth": "acme:Mine"}]
    assert plugins.has_plugin("acme/diary")


def test_hook_module_that_cannot_be_imported_is_left_out_with_a_warning(install, caplog):
    install(
        "broken",
        {"tangible.hooks": {"broken": "broken_hooks", "gone": "no_such_module", "quits": "quits"}},
        broken_hooks="1 / 0",
        quits="raise SystemExit",
    )
    install("acme", {"tangible.hooks": {"diary": "acme_diary"}}, acme_diary="")
    assert [name for name, _ in hooks.manager().list_name_plugin()] == ["acme/diary"]
    assert {record.args[0] for record in caplog.records} == {"broken", "gone", "quits"}
    assert all("left out" in record.message for record in caplog.records)


def test_unknown_hook_is_logged_with_the_nearest_name(install, caplog):
    install(
        "acme",
        {"tangible.hooks": {"diary": "acme_diary"}},
        acme_diary="""
            from tangible_core.plugins.hooks import hookimpl
            @hookimpl
            def tangible_stage_finisched(outcome): ...
            """,
    )
    assert hooks.tell(hooks.manager(), "tangible_stage_finished", outcome=RAN) == []
    assert "acme/diary implements an unknown hook: tangible_stage_finisched (did you mean" in caplog.text


def test_observer_with_an_unknown_argument_is_left_out(install, caplog):
    install(
        "acme",
        {"tangible.hooks": {"diary": "acme_diary"}},
        acme_diary="""
            from tangible_core.plugins.hooks import hookimpl
            @hookimpl
            def tangible_stage_finished(outcome, mood): ...
            """,
    )
    plugins = hooks.manager()
    assert hooks.tell(plugins, "tangible_stage_finished", outcome=RAN) == []
    assert "mood" in caplog.text

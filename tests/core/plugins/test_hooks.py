"""Hooks. Otherwise one package that fails would end the program, or an answer of another would be lost."""

import logging

import pluggy
import pytest

from tangible_core.data import Outcome
from tangible_core.plugins import hooks
from tangible_core.plugins.hooks import hookimpl

RAN = Outcome("relief", "ran", "requested")


def manager(*observers) -> pluggy.PluginManager:
    plugins = pluggy.PluginManager("tangible")
    plugins.add_hookspecs(hooks.Specs)
    for observer in observers:
        plugins.register(observer, name=type(observer).__name__)
    return plugins


class Witness:
    """An observer, one of whose hooks has fewer arguments than it could."""

    def __init__(self):
        self.calls = []

    @hookimpl
    def tangible_methods(self, kind):
        return {"mine": "acme:Mine"}

    @hookimpl
    def tangible_stage_started(self, product):
        self.calls.append(product)

    @hookimpl
    def tangible_stage_finished(self, outcome):
        self.calls.append(outcome)


class Failing:
    @hookimpl
    def tangible_stage_finished(self, outcome):
        raise RuntimeError("I always fail")


def test_hook_calls_observers_and_returns_their_answers():
    witness = Witness()
    hooks.tell(manager(witness), "tangible_stage_started", product="relief", method="core")
    hooks.tell(manager(witness), "tangible_stage_finished", outcome=RAN)
    assert witness.calls == ["relief", RAN]
    assert hooks.tell(manager(), "tangible_methods", kind="depth") == []
    assert hooks.tell(manager(Witness(), Failing()), "tangible_methods", kind="depth") == [{"mine": "acme:Mine"}]
    assert hooks.tell(manager(Witness()), "tangible_stage_started", product="relief", method="core") == []


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_failing_observer_is_logged_once_and_harms_no_other(caplog, order, log_dir):
    witness = Witness()
    both = (witness, Failing())
    plugins = manager(*(both[i] for i in order))
    for _ in range(3):
        hooks.tell(plugins, "tangible_stage_finished", outcome=RAN)
    assert witness.calls == 3 * [RAN]
    [record] = caplog.records
    assert (record.levelno, record.exc_info) == (logging.WARNING, None)
    log = log_dir / "failures.log"
    assert f"RuntimeError: I always fail; the traceback is in {log}" in record.message
    assert log.read_text().count("Traceback") == 1


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


@pytest.mark.parametrize(
    ("hook", "said"),
    [("tangible_stage_finisched(outcome)", "(did you mean"), ("tangible_stage_finished(outcome, mood)", "mood")],
)
def test_hook_that_does_not_exist_or_fit_is_left_out(install, caplog, hook, said):
    diary = f"from tangible_core.plugins.hooks import hookimpl\n@hookimpl\ndef {hook}: ...\n"
    install("acme", {"tangible.hooks": {"diary": "acme_diary"}}, acme_diary=diary)
    assert hooks.tell(hooks.manager(), "tangible_stage_finished", outcome=RAN) == []
    assert said in caplog.text

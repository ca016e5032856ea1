"""Functions for fingers. Otherwise a broken package would judge parts, or end an export without its name."""

import pluggy
import pytest

from tangible_core.errors import BrokenMethod
from tangible_core.pipeline.engine.hooked import judge_function, legibility_point, simplify_function
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import Registry, default_registry


class Rules:
    def __init__(self, **functions):
        self.functions = functions

    @hooks.hookimpl
    def tangible_legibility(self):
        return self.functions


def registry(*rules: Rules) -> Registry:
    plugins = pluggy.PluginManager("tangible")
    plugins.add_hookspecs(hooks.Specs)
    for rule in rules:
        plugins.register(rule)
    return Registry(plugins)


def test_installed_hook_names_functions_that_can_be_imported():
    assert callable(judge_function(default_registry()))
    assert callable(simplify_function(default_registry()))


def test_first_answer_counts_and_an_answer_without_the_name_is_passed_over():
    chosen = legibility_point(registry(Rules(judge="a:b"), Rules(simplify="c:d"), Rules(simplify="e:f")), "simplify")
    assert chosen.value == "c:d"


@pytest.mark.parametrize(
    ("rules", "why"),
    [
        ((), "no hook tangible_legibility names a function to simplify parts"),
        ((Rules(simplify="nothing.here:f"),), "nothing.here:f, which tangible_legibility names .*No module named"),
        ((Rules(simplify="math:nothing"),), "math:nothing, which tangible_legibility names .*no attribute"),
    ],
)
def test_missing_function_is_named(rules, why):
    with pytest.raises(BrokenMethod, match=why):
        simplify_function(registry(*rules))

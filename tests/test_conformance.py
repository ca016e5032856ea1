"""Every check of the conformance kit, over every method that is shipped."""

from tangible_core.plugins.registry import default_registry
from tangible_core.testing import conforms

EXPECTED_FAILURES: dict[tuple[str, str], dict[str, str]] = {
    ("render", "penalty"): {"springs_are_exact": "a spring along z alone is its law, on slopes too"},
}
"""By kind and name: the checks that a method does not keep, each with the reason."""

for each in default_registry().listings:
    if each.distribution == "tangible-images":
        test = conforms(each.kind, each.name, EXPECTED_FAILURES.get((each.kind, each.name)))
        globals()[f"test_{each.kind}_{each.name}".replace("-", "_")] = test
del test  # pytest would collect it once more

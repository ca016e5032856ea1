"""What goes into a plugin's verbs and comes out: converted where it can be, else said in one sentence.

Around the verbs of every method and touch, ours and anyone else's, so that none has to look for itself.
"""

from collections.abc import Callable
from functools import wraps
from typing import Any, NamedTuple

from ..data.arguments import as_force, as_state
from ..data.device import Force, HapticState
from ..errors import BrokenMethod, what_is, wrong_argument
from ..runtime.threads import limited_threads
from .naming import named

Convert = Callable[[Any], Any]


def taking(name: str, wanted: type, hint: str = "") -> Convert:
    """What takes an argument of one type alone. hint: how to make one."""

    def convert(value: Any) -> Any:
        if not isinstance(value, wanted):
            raise wrong_argument(name, value, f"a {wanted.__name__}{hint}")
        return value

    return convert


class Verb(NamedTuple):
    """A verb of a kind of plugin: what it takes and what it returns."""

    kind: str
    name: str
    returns: type
    take: Convert | None = None
    """Converts each argument; None for a verb without arguments, or of any."""


def guard_verb(cls: type, verb: Verb) -> None:
    """Wrap a class's own verb, if it has one: arguments are converted, and the result is of the verb's type.

    A caller gets a BrokenMethod that names the plugin in place of a result of another type.
    """
    own = cls.__dict__.get(verb.name)
    if own is None or getattr(own, "__isabstractmethod__", False):
        return

    @wraps(own)
    def guarded(self: Any, *given: Any, **by_name: Any) -> Any:
        if verb.take is not None:
            given, by_name = tuple(map(verb.take, given)), {name: verb.take(each) for name, each in by_name.items()}
        with limited_threads():
            result = own(self, *given, **by_name)
        if not isinstance(result, verb.returns):
            raise _unexpected(self, verb.kind, verb.name, result, verb.returns)
        return result

    setattr(cls, verb.name, guarded)


def guard_force(cls: type) -> None:
    """Around a touch's `force`, if the class has one of its own: three numbers do for a state and for a force."""
    own = cls.__dict__.get("force")
    if own is None or getattr(own, "__isabstractmethod__", False):
        return

    @wraps(own)
    def force(self: Any, state: HapticState) -> Force:
        found = own(self, state if type(state) is HapticState else as_state(state))
        if type(found) is Force:
            return found
        if (made := as_force(found)) is None:
            raise _unexpected(self, "render", "force", found, Force)
        return made

    setattr(cls, "force", force)  # noqa: B010 - of a class that is made now


def _unexpected(giver: object, kind: str, verb: str, found: Any, wanted: type) -> BrokenMethod:
    who, gave = named(kind, type(giver).__module__, type(giver).__qualname__), what_is(found)
    return BrokenMethod(f"{who}: {verb} gave {gave}; it must give a {wanted.__name__}, as `tangible check` tests")

"""The end of a force loop, and why it ended."""

from tangible_core.errors import TangibleError
from tangible_core.plugins.failures import sentence
from tangible_core.servo import Servo

STOPPED = "stopped"


def end_loop(servo: Servo) -> str:
    """End a loop if it still runs, and return why it ended."""
    try:
        return servo.stop(STOPPED).stopped
    except TangibleError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001 - what a plugin raised in the loop is no failure of stopping it
        return sentence(error)

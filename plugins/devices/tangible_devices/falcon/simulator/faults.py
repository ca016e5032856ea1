"""Faults of a USB device, on demand."""

from typing import Annotated, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field

Step = Literal["look", "open", "configure", "driver", "claim", "control", "write", "read"]
ERRORS = {"unplugged": 19, "access-denied": 13, "busy": 16, "timeout": 110, "stall": 32, "overflow": 75}


class Fault(BaseModel):
    """A step of USB that fails; an unplugged device stays unplugged until `Unit.plug_in`."""

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    at: Step = "read"
    """Step that fails: looking for devices, opening one, asking for its configuration, detaching the system's driver,
    claiming the interface, a request to the chip, a write, a read."""
    error: Literal["unplugged", "access-denied", "busy", "timeout", "stall", "overflow"] = "unplugged"
    """Kind of failure."""
    after: Annotated[int, Field(ge=0)] = 0
    """Number of such steps that succeed first."""
    times: Annotated[int, Field(ge=1)] = 1
    """Number of such steps in a row that fail."""

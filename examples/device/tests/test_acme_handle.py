import pytest
from acme_handle.handle import Handle, HandleLink
from acme_handle.maker import Box

from tangible_core import Force
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.testing import conforms

test_handle = conforms("device", "acme-handle")


def test_frame():
    box = Box()
    with HandleLink(box) as link:
        link.write(Force(1.0, 2.0, 3.0))
        assert box.held_mn == (1000.0, 3000.0, -2000.0)
        assert link.applied == (1.0, 2.0, 3.0)


def test_absence_and_loss(monkeypatch):
    link = Handle().open()
    monkeypatch.setattr(Box, "there", False)
    with pytest.raises(DeviceError, match="stopped answering"):
        link.read()
    link.close()
    with pytest.raises(DeviceAbsent, match="plug it in"):
        Handle().open()

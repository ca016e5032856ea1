"""To measure what a user has who was given no real-time rights."""

import ctypes
import sys

CAP_IPC_LOCK, CAP_SYS_NICE = 14, 23
PR_CAPBSET_DROP = 24


def give_up() -> None:
    """Deny real time and locked memory to all that this process starts from now on. It cannot be taken back."""
    if sys.platform != "linux":
        return
    import resource

    control = ctypes.CDLL(None).prctl
    for capability in (CAP_IPC_LOCK, CAP_SYS_NICE):  # refused to who is no administrator, and has them not
        control(PR_CAPBSET_DROP, capability, 0, 0, 0)
    for limit in (resource.RLIMIT_RTPRIO, resource.RLIMIT_MEMLOCK):
        resource.setrlimit(limit, (0, 0))

"""Texts of unforeseen errors: pages show one sentence, and the traceback goes to a file."""

import asyncio

from tangible_core.errors import TangibleError
from tangible_core.plugins.failures import sentence


async def describe_error(error: BaseException) -> str:
    """Return the sentence that a page shows for an error."""
    if isinstance(error, TangibleError):
        return str(error)
    return await asyncio.to_thread(sentence, error)

"""Errors that nobody foresaw: pages are told one sentence, and the traceback is kept in a file."""

import asyncio

from tangible_core.errors import TangibleError
from tangible_core.plugins.failures import sentence


async def describe_error(error: BaseException) -> str:
    """What a page is told of an error."""
    if isinstance(error, TangibleError):
        return str(error)
    return await asyncio.to_thread(sentence, error)

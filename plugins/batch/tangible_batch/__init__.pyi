from .running import batch as batch

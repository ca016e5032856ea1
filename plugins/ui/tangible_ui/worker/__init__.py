"""The process that makes surfaces, and its handle in the server: it may take long, and be killed at any moment."""

from .handle import Worker

__all__ = ["Worker"]

"""The process that computes surfaces, and its handle in the server: jobs may take long, and be killed at any moment."""

from .handle import Worker

__all__ = ["Worker"]

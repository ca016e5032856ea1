"""Requests and jobs: one module per topic, found without a list."""

from pathlib import Path

import pytest

from tangible_ui import requests
from tangible_ui.requests import REQUESTS
from tangible_ui.requests.table import request
from tangible_ui.worker import jobs
from tangible_ui.worker.jobs import JOBS
from tangible_ui.worker.jobs.table import job


def topics(package: str) -> set[str]:
    return {path.stem for path in Path(package).parent.glob("*.py")} - {"__init__", "table"}


def test_topic_of_the_server_has_the_name_of_a_topic_of_the_worker() -> None:
    assert topics(requests.__file__) == topics(jobs.__file__)


def test_topic_module_is_loaded_without_a_list() -> None:
    assert {each.__module__.rpartition(".")[2] for each in REQUESTS.values()} == topics(requests.__file__)
    assert {each.do.__module__.rpartition(".")[2] for each in JOBS.values()} == topics(jobs.__file__)


def test_request_of_a_taken_name_is_refused() -> None:
    async def make() -> None: ...

    with pytest.raises(ValueError, match="two requests named make"):
        request()(make)
    with pytest.raises(ValueError, match="two requests named set"):
        request("set")(make)


def test_job_of_a_taken_name_is_refused() -> None:
    def make() -> None: ...

    with pytest.raises(ValueError, match="two jobs named make"):
        job()(make)

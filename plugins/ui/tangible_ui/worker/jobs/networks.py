"""Jobs that list, check and remove networks; the server has them fetched."""

from typing import Any

from tangible_networks.card import forget_digests
from tangible_networks.fetching import remove_network
from tangible_networks.store import chosen_networks, known_networks, models_folder

from ..state import WorkerState
from .table import job


@job(page=True)
def networks(state: WorkerState, check: bool = False) -> dict[str, Any]:
    """List the networks that have a card, and their folder. check: read all files again."""
    if check:
        forget_digests()
    return {"folder": str(models_folder()), "networks": [network.as_data() for network in known_networks().values()]}


@job(page=True)
def remove_networks(state: WorkerState, names: list[str]) -> None:
    """Delete the files of networks. Raises: ConfigError for an unknown name."""
    for network in chosen_networks(names):
        remove_network(network)

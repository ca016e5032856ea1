"""The networks that are known by their cards, and those of them whose files are in the user's folder."""

import logging
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, NamedTuple, get_args

from tangible_core.errors import ConfigError, TangibleError, did_you_mean
from tangible_core.files import as_path

from .card import Card, Package, Task, check_file, read_card, shipped_cards

log: logging.Logger = logging.getLogger(__name__)
VARIABLE = "TANGIBLE_MODELS_DIR"  # the folder of networks
TASKS: tuple[Task, ...] = get_args(Task)
PHOTOGRAPH: tuple[Task, ...] = ("figure", "borders", "faces")  # what looks at a photograph
State = Literal["here", "absent", "damaged"]


class KnownNetwork(NamedTuple):
    """A network that has a card, whether its file is here or not."""

    name: str
    card: Card
    path: Path  # where its file is, or would be
    card_file: Path | None = None  # None for a card that is shipped

    @property
    def is_here(self) -> bool:
        """True for a file of the right size, which is not read."""
        size = self.card.size_bytes
        return self.path.is_file() and (not size or self.path.stat().st_size == size)

    @property
    def state(self) -> State:
        """`here`, `absent`, or `damaged` if the file is not the one of the card; reads the file once."""
        if not self.path.is_file():
            return "absent"
        try:
            check_file(self.path, self.card)
        except ConfigError:
            return "damaged"
        return "here"

    @property
    def can_be_fetched(self) -> bool:
        """True if its card says where it is and by which digest it is known; otherwise it is brought by hand."""
        source = self.card.source
        return isinstance(source, Package) or (source.startswith("https://") and bool(self.card.sha256))

    def as_data(self) -> dict[str, str | int | bool]:
        """Return what is known of it as JSON data; reads the file once."""
        card = self.card
        return {
            "name": self.name, "title": card.title, "task": card.task, "state": self.state, "file": str(self.path),
            "bytes": card.size_bytes or card.about_bytes, "licence": card.licence, "trained_on": card.trained_on,
            "improves": card.improves, "source": str(card.source), "verified": card.verified,
            "recommended": card.recommended, "can_be_fetched": self.can_be_fetched,
        }  # fmt: skip


def models_folder() -> Path:
    """Return the folder of networks: `models` in the user's data, or TANGIBLE_MODELS_DIR."""
    if folder := os.environ.get(VARIABLE):
        return as_path(folder, VARIABLE)
    from platformdirs import user_data_path

    return user_data_path("tangible-images") / "models"


def known_networks() -> Mapping[str, KnownNetwork]:
    """Return all networks with a card, shipped or of the user's folder, by name; warn of a card that cannot be read."""
    folder = models_folder()
    networks = {name: KnownNetwork(name, card, folder / card.file) for name, card in shipped_cards().items()}
    for path in sorted(folder.glob("*.yaml")) if folder.is_dir() else ():
        try:
            card = read_card(path)
        except (TangibleError, OSError) as error:
            log.warning("a network cannot be used: %s", error)
            continue
        networks.setdefault(path.stem, KnownNetwork(path.stem, card, folder / (card.file or f"{path.stem}.onnx"), path))
    return networks


def chosen_networks(names: list[str]) -> list[KnownNetwork]:
    """Return networks by names or tasks, which stand for recommended ones. Raises: ConfigError for another word."""
    known = known_networks()
    chosen: dict[str, KnownNetwork] = {}
    for name in names:
        if name in known:
            chosen[name] = known[name]
        elif name in TASKS:
            chosen |= {key: known[key] for key in known if known[key].card.task == name and known[key].card.recommended}
        else:
            near = did_you_mean(name, [*TASKS, *known])
            raise ConfigError(f"{name}: no such network or task{near}; `tangible networks` lists them")
    return list(chosen.values())


def networks_here(task: Task) -> list[KnownNetwork]:
    """Return the networks for a task whose files are here."""
    if not models_folder().is_dir():  # most people have none: no card is read
        return []
    return [network for network in known_networks().values() if network.card.task == task and network.is_here]


def identity_here(*tasks: Task) -> str:
    """Return a text that differs for other networks for these tasks, without reading their files; "" without one."""
    present = (network for task in tasks or PHOTOGRAPH for network in networks_here(task))
    return " ".join(f"{network.name}:{network.card.sha256}:{network.path.stat().st_mtime_ns}" for network in present)

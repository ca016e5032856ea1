"""`plugins`: what is installed, read from metadata and source text."""

from ..registry import default_registry


def plugins(as_json: bool) -> None:
    """One line a method."""
    from .show import print_json, table

    listings = default_registry().listings
    if as_json:
        rows = [
            {
                "kind": each.kind,
                "name": each.name,
                "origin": each.origin,
                "target": each.target,
                "summary": each.summary,
            }
            for each in listings
        ]
        print_json(rows)
    else:
        table(("kind", "name", "origin", "what it does"), [(e.kind, e.name, e.origin, e.summary) for e in listings])

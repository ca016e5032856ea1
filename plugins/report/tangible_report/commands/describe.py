"""The command `describe`: the surface in words, on the terminal."""

from tangible_core.cli import ConfigOrPictures, NoCache, Sets, open_pipeline, plain
from tangible_core.errors import ConfigError
from tangible_core.translation import language


def describe(config: ConfigOrPictures, sets: Sets = None, no_cache: NoCache = False) -> None:
    """Print the surface in words: the whole, then part by part.

    It is the text that `export --to text` writes, in the language of the terminal (`--lang`).
    """
    from pathlib import Path
    from tempfile import TemporaryDirectory

    pipeline = open_pipeline(config, [f"export.text.language={language()}", *(sets or [])], not no_cache)
    with TemporaryDirectory() as folder:
        (exported,) = pipeline.export(folder, ["text"]).exports
        if not exported.files:
            raise ConfigError(exported.outcome.why)
        plain(next(Path(file) for file in exported.files if file.suffix == ".txt").read_text(encoding="utf-8").rstrip())

"""What is written in the language of the pipeline file: sheet and descriptions."""

import re
from pathlib import Path

from command_line import tangible
from english import english_of

TEXT = """
scene: builtin/motorcycle
language: de
title: Motorrad
want: touch
depth: {use: opencv-sgbm}
texture: {use: gradient, segments: 3}
render: {use: proxy}
device: {use: mock}
export: [{use: sheet, format: svg}, {use: text, braille: true}, swell, {use: pins, display: monarch}]
"""


def test_exports_in_german_have_no_english(tmp_path: Path) -> None:
    (tmp_path / "m.yaml").write_text(TEXT)
    run = tangible("--lang", "de", "run", "m.yaml", "--out", "run", "--sheet", "svg", "--seconds", "0.2", cwd=tmp_path)
    done = tangible("--lang", "de", "export", "m.yaml", "--out", "out", cwd=tmp_path)
    assert (run.returncode, done.returncode) == (0, 0), run.stderr + done.stderr
    assert not english_of(run.stdout + run.stderr + done.stdout + done.stderr)
    for path in (*tmp_path.glob("out/*.svg"), tmp_path / "run/sheet.svg", *tmp_path.glob("out/*.html")):
        text = path.read_text()
        shown = [
            *re.findall(r"<!-- (.*?) -->", text),
            *re.findall(r">([^<>]+)<", re.sub(r"(?s)<style.*?</style>", "", text)),
        ]
        assert shown
        assert not english_of("\n".join(shown)), path.name
    assert not english_of((tmp_path / "out/m.txt").read_text())
    assert "Motorrad" in (tmp_path / "run/sheet.svg").read_text()
    assert re.search(r"<!-- \d,\d+ -->", (tmp_path / "run/sheet.svg").read_text()), "numbers at the axes"

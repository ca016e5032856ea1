"""Steps back and forth: in their order, and with the texts of a file that was moved."""

from pathlib import Path

from tangible_ui.state.texts import MOST_STEPS, Text, Texts

AT = Path("/a/mine.yaml")


def text(number: int) -> Text:
    return Text(f"text {number}\n", AT)


def steps(texts: Texts, now: Text, *, back: bool) -> list[str]:
    """The texts of all steps in one direction."""
    found: list[str] = []
    while (other := texts.before() if back else texts.after()) is not None:
        texts.step(now, back=back)
        now = other
        found.append(now.text)
    return found


def edited(count: int) -> Texts:
    """The history of so many edits; the last text is the current one."""
    texts = Texts()
    for number in range(count - 1):
        texts.leave(text(number))
    return texts


def test_steps_are_undone_and_redone_in_their_order():
    texts = edited(4)
    assert steps(texts, text(3), back=True) == [text(number).text for number in (2, 1, 0)]
    assert (texts.can_undo, texts.can_redo) == (False, True)
    assert texts.all == [text(number).text for number in (3, 2, 1)]
    assert steps(texts, text(0), back=False) == [text(number).text for number in (1, 2, 3)]
    assert (texts.can_undo, texts.can_redo) == (True, False)


def test_edit_after_an_undo_ends_what_can_be_redone():
    texts = edited(2)
    texts.step(text(1), back=True)
    assert texts.can_redo
    texts.leave(text(0))
    assert (texts.after(), texts.before()) == (None, text(0))


def test_texts_are_rewritten_on_both_sides_and_stay_bounded():
    texts = edited(4)
    texts.step(text(3), back=True)
    texts.rewrite({text(number).text: f"moved {number}\n" for number in (0, 3)})
    assert texts.all == ["moved 0\n", text(1).text, "moved 3\n"]
    for number in range(MOST_STEPS + 5):
        texts.leave(text(number))
    assert len(texts.all) == MOST_STEPS

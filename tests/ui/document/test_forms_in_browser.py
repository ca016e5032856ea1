"""An option by the keyboard alone: otherwise nobody changes one without a mouse, or the file says another value."""

from pathlib import Path
from typing import TYPE_CHECKING

from browser_tabs import OpenPage
from page_files import built_page
from page_panels import bring, open_panel, wait_for_force
from sessions import TEXT, small_scene
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page

STIFFNESS = "field:render.stiffness_n_per_m"


def test_option_typed_in_the_form_is_saved_to_the_file(serve, open_page: OpenPage, tmp_path: Path):
    built_page()
    server = serve(small_scene(tmp_path), cwd=tmp_path)
    page, other = open_page(server.url), open_page(server.url)
    wait_for_force(page)  # the loop too has started
    until(lambda: state(page, "touch") == "ran" and page.locator("#section-render").count() == 1)

    for each in (page, other):
        bring(each, "methods")
    page.locator("#section-render > summary").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")  # the method
    page.keyboard.press("Tab")
    until(lambda: focus_id(page) == STIFFNESS, "the focus is in the field")
    assert "Over 0 N/m. Default: 800 N/m." in description_of(page, STIFFNESS)
    retype(page, "-5")
    until(lambda: field(page).get_attribute("aria-invalid") == "true")
    assert field(page).input_value() == "-5"
    until(lambda: "greater than 0" in description_of(page, STIFFNESS), "the reason is read next to the field")
    complaint = page.locator("#methods .complaints button")
    assert complaint.inner_text().startswith("render.stiffness_n_per_m: ")
    complaint.focus()
    page.keyboard.press("Enter")
    until(lambda: focus_id(page) == STIFFNESS, "the complaint leads to its field")

    felt = page.locator("#log li", has_text="Feeling penalty")
    until(lambda: felt.count() > 0)
    runs = felt.count()
    retype(page, "0.5 N/mm")  # made and felt at once: nothing slow has to run
    until(lambda: field(page).get_attribute("aria-invalid") is None)
    until(lambda: felt.count() > runs, "the new stiffness is felt")  # an earlier line may be shown late
    until(lambda: page.locator("#methods .complaints").is_hidden(), "no complaint is left")
    until(lambda: other.locator(f'[id="{STIFFNESS}"]').input_value() == "0.5 N/mm")

    other.locator("#section-render > summary").click()
    other.locator(f'[id="{STIFFNESS}"]').press_sequentially("9")  # begun, not finished
    page.locator('[id="field:depth"]').evaluate("each => { each.closest('details').open = true; each.focus() }")
    page.keyboard.press("a")  # auto
    page.keyboard.press("Enter")
    until(lambda: "changed since" in page.locator("#methods").inner_text().lower())
    until(lambda: state(page, "disparity") == "waiting")
    assert other.locator(f'[id="{STIFFNESS}"]').input_value() == "90.5 N/mm"  # nobody typed over it
    page.locator("#make").focus()
    page.keyboard.press("Enter")
    until(lambda: state(page, "disparity") == state(page, "touch") == "ran")
    until(lambda: "auto" in page.locator('#stages [data-product="disparity"]').inner_text(), "the method is shown")

    open_panel(page, "yaml")
    save = bring(page, "save")
    page.locator("#save-path").fill("saved.yaml")
    page.keyboard.press("Enter")
    expected = TEXT.replace("stiffness_n_per_m: 400", "stiffness_n_per_m: 0.5 N/mm").replace("luminance", "auto")
    until(lambda: page.locator("#yaml-text").input_value() == expected)
    save.get_by_role("button", name="Save").press("Enter")
    until(lambda: (tmp_path / "saved.yaml").is_file())
    assert (tmp_path / "saved.yaml").read_text() == expected


def retype(page: "Page", text: str) -> None:
    page.keyboard.press("Control+A")
    page.keyboard.type(text)
    page.keyboard.press("Enter")


def field(page: "Page"):
    return page.locator(f'[id="{STIFFNESS}"]')


def focus_id(page: "Page") -> str:
    return page.evaluate("() => document.activeElement.id")


def description_of(page: "Page", name: str) -> str:
    """Return the text that a screen reader reads next to a field."""
    return page.evaluate(
        """name => (document.getElementById(name).getAttribute("aria-describedby") ?? "").split(" ")
        .map(id => document.getElementById(id)).filter(each => each && !each.hidden)
        .map(each => each.textContent).join(" ")""",
        name,
    )


def state(page: "Page", product: str) -> str | None:
    found = page.locator(f'#stages [data-product="{product}"]')
    return found.get_attribute("data-state") if found.count() else None

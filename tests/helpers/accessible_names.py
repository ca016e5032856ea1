"""What axe and the browser's accessibility tree find wrong in a page: violations, and names of controls."""

from typing import TYPE_CHECKING, Any, NamedTuple

from browser_tabs import SETTLED
from needed import lacking
from page_files import WEB

if TYPE_CHECKING:
    from playwright.sync_api import CDPSession, Page

AXE = WEB / "node_modules/axe-core/axe.min.js"
RULES = {"type": "tag", "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]}
COLOURS = {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}
"""All that a theme can break."""
CONTROLS = {
    "button", "checkbox", "combobox", "DisclosureTriangle", "link", "listbox", "menuitem", "radio", "searchbox",
    "slider", "spinbutton", "switch", "tab", "textbox", "textfield",
}  # fmt: skip
"""Roles of the accessibility tree that somebody acts on."""
SEEN = """function () {
  const UNREAD = "input, select, textarea, output, kbd, datalist, [aria-hidden=true]";
  const text = (each) => {
    const copy = each.cloneNode(true);
    for (const inner of copy.querySelectorAll(UNREAD)) inner.remove();
    return copy.textContent.replace(/\\s+/g, " ").trim();
  };
  const own = /BUTTON|SUMMARY|A/.test(this.tagName) ? text(this) : "";
  const label = this.labels?.length ? [...this.labels].map(text).join(" ") : own;
  const around = this.tagName === "SUMMARY" ? this.parentElement : this;
  const inside = around.parentElement?.closest("[role=group], fieldset, tr, li, table, details, dialog, section");
  return { label, tag: this.outerHTML.slice(0, 120), inside: inside ? inside.outerHTML.slice(0, 200) : "" };
}"""
"""Returns the text that people see as the label of a control, and the box in which its name is to be the only one."""


def axe_finds(page: "Page", rules: dict[str, Any] = RULES, within: tuple[str, ...] = ()) -> list[str]:
    """Return axe's violations in a page at rest. within: elements by selector; without, all of the page."""
    if not AXE.is_file():
        lacking("axe-core is not installed: npm ci in plugins/web")
    page.evaluate(f"{AXE.read_text(encoding='utf-8')}; 0")
    page.evaluate(SETTLED)
    found = page.evaluate(
        """([within, runOnly]) => axe.run(within.length ? { include: within } : document,
          { runOnly, resultTypes: ["violations"], elementRef: false })""",
        [list(within), rules],
    )
    return [
        f"{each['id']} {node['target']} {node['failureSummary']}"
        for each in found["violations"]
        for node in each["nodes"]
    ]


class Control(NamedTuple):
    """A control of the page."""

    role: str
    name: str
    label: str
    """The visible label."""
    inside: str
    tag: str


def controls_of(page: "Page") -> list[Control]:
    """Return every control that the browser's accessibility tree has."""
    session: CDPSession = page.context.new_cdp_session(page)
    nodes: list[dict[str, Any]] = session.send("Accessibility.getFullAXTree")["nodes"]
    found = [node for node in nodes if not node["ignored"] and node["role"]["value"] in CONTROLS]
    controls = [
        Control(each["role"]["value"], each.get("name", {}).get("value", "").strip(), **_seen(session, each))
        for each in found
    ]
    session.detach()
    return controls


def _seen(session: "CDPSession", node: dict[str, Any]) -> dict[str, str]:
    found = session.send("DOM.resolveNode", {"backendNodeId": node["backendDOMNodeId"]})["object"]["objectId"]
    asked = {"objectId": found, "functionDeclaration": SEEN, "returnByValue": True}
    return session.send("Runtime.callFunctionOn", asked)["result"]["value"]


def faults_of(controls: list[Control]) -> list[str]:
    """Return the controls without a name, with another one than people see, or with one that a neighbour has too."""
    faults = [f"no name: {control.role} {control.tag}" for control in controls if not control.name]
    faults += [
        f"{control.role} {control.name!r} reads {control.label!r}"
        for control in controls
        if control.name and _plain(control.label) not in _plain(control.name)
    ]
    known = set[tuple[str, str, str]]()
    for control in controls:
        key = control.role, control.name, control.inside
        if control.name and key in known:
            faults.append(f"twice: {control.role} {control.name!r} in {control.inside}")
        known.add(key)
    return faults


def _plain(text: str) -> str:
    return "".join(text.casefold().split()).rstrip(":.…")

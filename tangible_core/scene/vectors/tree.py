"""The tree of an SVG: what is painted, with which names, and what leads out of the file."""

import re
from collections.abc import Iterator, Mapping
from typing import NamedTuple
from xml.etree.ElementTree import Element

HIDE = ";display:none!important"
SHAPES = frozenset(("path", "rect", "circle", "ellipse", "polygon", "polyline", "line"))
"""Elements that are painted."""
CLOSED = frozenset(("rect", "circle", "ellipse", "polygon"))
UNSEEN = ("none", "transparent")
DROPPED = frozenset(("script", "foreignObject"))  # elements that are programs, or documents of another kind
# Elements whose content shapes others, and is not painted by itself.
ASIDE = frozenset(("clipPath", "mask", "pattern", "marker", "linearGradient", "radialGradient", "filter"))
MAX_DEPTH = 200  # the most elements inside one another
PICTURES = re.compile(r"data:image/(png|jpe?g|gif|webp)\b", re.IGNORECASE)
"""The start of a picture inside of the file."""
# An id that a program gave, such as `path123`.
GIVEN = re.compile(
    r"(?:(?:path|rect|g|group|circle|ellipse|line|line2d|poly(?:gon|line)|use|image|layer|svg|shape|text|tspan|object|vector|"
    r"cell|node|xmlid|svgid|patch|axes|figure|[xy]tick|legend|collection|ebene|calque|canvas|frame|union|subtract)s?)?"
    r"[-_. ]?(?:x?\d[-_.\da-f]*)?",
    re.IGNORECASE,
)
RULE = re.compile(r"([^{}]+)\{([^{}]*)\}")
SELECTOR = re.compile(r"([\w-]*|\*)(?:\.([\w-]+)|#([\w-]+))?")
"""A selector of one element: a tag, a class, an id, or a tag with a class."""
# The marks of our own pages for swell paper that do not belong to the picture (`data-mark`).
OWN_MARKS = ("braille", "fill", "corner")


class Item(NamedTuple):
    """A shape or a text of the tree."""

    element: Element
    # What its title, its `aria-label` or its layer's label says, or those of the nearest group that has one.
    label: str
    name: str  # the id of it or of the nearest group, if a person chose it
    filled: bool = True  # true where it covers an area
    outline: bool = False  # true where it has no fill, and its closed stroke is the outline of an area
    stroked: bool = False


def local(element: Element) -> str:
    """Return the tag without its namespace."""
    return str(element.tag).rpartition("}")[2]


def walk(root: Element) -> Iterator[tuple[Element, Element | None, int]]:
    """Yield each element with its parent and its depth, parents first. Raises: ValueError where they lie too deep."""
    waiting: list[tuple[Element, Element | None, int]] = [(root, None, 0)]
    while waiting:
        element, parent, depth = waiting.pop()
        if depth > MAX_DEPTH:
            raise ValueError(f"its groups lie more than {MAX_DEPTH} deep")
        yield element, parent, depth
        waiting += [(child, element, depth + 1) for child in reversed(element)]


def cut_off(root: Element) -> tuple[set[str], bool]:
    """Remove what leads out of the file and what runs; return the addresses, and whether there were scripts."""
    outside, runs = set[str](), False
    for element, _, _ in [*walk(root)]:
        for child in [child for child in element if local(child) in DROPPED]:
            runs |= local(child) == "script"
            element.remove(child)
        for name in [name for name in element.attrib if name.rpartition("}")[2] in ("href", "src")]:
            address = element.attrib[name].strip()
            if local(element) == "a" or not (address.startswith("#") or PICTURES.match(address)):
                outside |= set[str]() if local(element) == "a" else {address[:60]}
                del element.attrib[name]
    return outside, runs


def find_items(root: Element) -> tuple[list[Item], list[Item]]:
    """Return the shapes and the texts, in the order in which they are painted."""
    rules = [rule for element, _, _ in walk(root) if local(element) == "style" for rule in _rules(element.text or "")]
    contexts: dict[Element, tuple[Mapping[str, str], str, str]] = {}
    shapes, texts, aside = list[Item](), list[Item](), set[Element]()
    for element, parent, _ in walk(root):
        styles, label, name = (dict[str, str](), "", "") if parent is None else contexts[parent]
        styles = {**styles, **_declarations(element, rules)}
        if parent is not None:
            label, name = find_label(element) or label, _own_name(element.get("id", "")) or name
        contexts[element] = styles, label, name
        tag = local(element)
        if tag in ASIDE or parent in aside:
            aside.add(element)
        elif element.get("data-mark") in OWN_MARKS:
            element.set("style", (element.get("style", "") + HIDE).lstrip(";"))
            aside.add(element)
        elif tag == "text":
            texts.append(Item(element, label, name))
        elif tag in SHAPES:
            shapes.append(_shape(element, styles, label, name))
    return shapes, texts


def words_in(element: Element) -> str:
    """Return the words of an element, without its title; what begins on a place of its own is another word."""
    if local(element) in ("title", "desc"):
        return ""
    apart = " " if {"x", "y", "dy"} & element.attrib.keys() else ""
    return apart + (element.text or "") + "".join(words_in(child) + (child.tail or "") for child in element)


def _shape(element: Element, styles: Mapping[str, str], label: str, name: str) -> Item:
    is_visible = all(_number(styles.get(key, "1")) > 0 for key in ("opacity", "fill-opacity"))
    is_filled = is_visible and styles.get("fill", "black") not in UNSEEN and local(element) != "line"
    is_stroked = styles.get("stroke", "none") not in UNSEEN
    is_closed = local(element) in CLOSED or element.get("d", "").rstrip().endswith(("Z", "z"))
    # Of outlines, those with a name are parts: tactile graphics have no fills.
    outline = is_stroked and not is_filled and is_closed and bool(label)
    return Item(element, label, name, is_filled or outline, outline, is_stroked)


def find_label(element: Element) -> str:
    """Return the title of an element, or its label; "" without one."""
    titles = (" ".join("".join(child.itertext()).split()) for child in element if local(child) == "title")
    labels = (value for key, value in element.attrib.items() if key == "aria-label" or key.endswith("inkscape}label"))
    return next(filter(None, titles), "") or next((" ".join(title.split()) for title in labels), "")


def _own_name(own: str) -> str:
    return "" if GIVEN.fullmatch(own) else " ".join(own.replace("_", " ").split())


def _rules(sheet: str) -> Iterator[tuple[re.Match[str], dict[str, str]]]:
    for selectors, block in RULE.findall(re.sub(r"/\*.*?\*/", "", sheet, flags=re.DOTALL)):
        for selector in selectors.split(","):
            if match := SELECTOR.fullmatch(selector.strip()):
                yield match, _pairs(block)


def _pairs(block: str) -> dict[str, str]:
    pairs = (rule.partition(":") for rule in block.split(";"))
    return {name.strip(): value.replace("!important", "").strip() for name, _, value in pairs if value}


def _declarations(element: Element, rules: list[tuple[re.Match[str], dict[str, str]]]) -> dict[str, str]:
    """Return what an element says of its paint: attributes, then rules in their order, then its own style."""
    values = dict(element.attrib)
    classes = element.get("class", "").split()
    for match, pairs in rules:
        tag, of_class, of_id = match.groups()
        if tag in ("", "*", local(element)) and of_class in (None, *classes) and of_id in (None, element.get("id")):
            values |= pairs
    values |= _pairs(element.get("style", ""))
    names = ("fill", "stroke", "fill-opacity", "opacity")
    return {name: values[name] for name in names if values.get(name, "inherit") != "inherit"}


def _number(text: str) -> float:
    match = re.match(r"\s*(\d*\.?\d+)", text)
    return float(match[1]) if match else 1.0

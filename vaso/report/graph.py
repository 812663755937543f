"""Draw an automaton as SVG: layers by distance from the start, top to bottom."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from vaso.plan.transition_system import TransitionSystem
from vaso.report.automaton import Drawing, Link, Node, condense, gather
from vaso.report.graph_layout import DEEP, LANE, ROW, Layout, Place, make_layout, measure
from vaso.report.markup import Markup, el, join
from vaso.report.plot import NARROW

MOST = 60
COLUMNS, LETTERS = 26, 30
FOLDED = "Every box stands for all states in which the robot executes that plan line. "
DOTS = "A dot is where ways meet: there the plan reads its sensors, and goes on as they say. "


@dataclass(frozen=True, slots=True)
class Path:
    """The way of an edge.

    Attributes:
        d: The path, as SVG has it.
        tip: Where it ends.
        turn: Direction of the arrowhead in degrees: 0 to the right, 90 down.
        at: Where its label stands.
        tail: Where it begins.
    """

    d: str
    tip: tuple[float, float]
    turn: int
    at: tuple[float, float]
    tail: tuple[float, float] = (0.0, 0.0)


def automaton_svg(system: TransitionSystem, behaviour: Sequence[int] = ()) -> Markup:
    """The automaton as a drawing; the first nodes only where there are very many.

    Args:
        system: The automaton.
        behaviour: Control states of a behaviour, one after the other, to be brought out.
    """
    whole = condense(system)
    shown = gather(_first(whole, MOST))
    texts = [_lines(node, "states" if whole.folded else "") for node in shown.nodes]
    layout = make_layout(shown, texts)
    hot_nodes, hot_links = _visited(shown, behaviour)
    boxes = [
        _box(node, texts[i], layout.places[i], start=i == 0, hot=i in hot_nodes)
        for i, node in enumerate(shown.nodes)
    ]
    width = max([_lanes_end(layout), *(_label_end(k, layout) for k in shown.links if k.label)])
    size = f"0 0 {width:g} {layout.height:g}"
    style = "graph small" if width <= NARROW else "graph"
    told = el("title", f"Automaton of the plan: {len(whole.nodes)} boxes")
    edges = list(_edges(shown, layout, hot_links))
    svg = el("svg", told, edges, boxes, viewBox=size, width=f"{width:g}", cls=style, role="img")
    rest = len(whole.nodes) - MOST
    remark = f"{rest} more boxes are not drawn. " if rest > 0 else ""
    remark += FOLDED if whole.folded else ""
    remark += DOTS if any(n.junction for n in shown.nodes) else ""
    scroll = el("div", svg, cls="scroll", tabindex=0)
    return join(scroll, el("p", remark.strip(), cls="soft small") if remark else None)


def _lanes_end(layout: Layout) -> float:
    return layout.width + (len(layout.lanes) + 1) * LANE if layout.lanes else layout.width


def _label_end(link: Link, layout: Layout) -> float:
    return _path(link, layout).at[0] + measure(_cut(link.label, LETTERS)) + 8


def _first(drawing: Drawing, count: int) -> Drawing:
    links = tuple(k for k in drawing.links if k.source < count and k.target < count)
    return Drawing(drawing.nodes[:count], links, drawing.folded)


def _visited(
    drawing: Drawing, behaviour: Sequence[int]
) -> tuple[Collection[int], Collection[tuple[int, int]]]:
    """The nodes and links that a behaviour goes through."""
    index = {state: n for n, node in enumerate(drawing.nodes) for state in node.states}
    way = [index[s] for s in behaviour if s in index]
    junction = {
        k.source: k.target for k in drawing.links if drawing.nodes[k.target].junction
    }  # fmt: skip
    links: set[tuple[int, int]] = set()
    for a, b in pairwise(way):
        links |= {(a, junction[a]), (junction[a], b)} if a in junction else {(a, b)}
    return {*way, *(j for link in links for j in link if drawing.nodes[j].junction)}, links


# --- edges ----------------------------------------------------------------------------------------


def _edges(drawing: Drawing, layout: Layout, hot: Collection[tuple[int, int]]) -> Iterator[Markup]:
    """The links; a way from a junction to the layer below and the way back are one line."""
    pairs = {(k.source, k.target) for k in drawing.links}
    for link in drawing.links:
        back = (link.target, link.source)
        a, b = layout.places[link.source], layout.places[link.target]
        together = back in pairs and abs(a.layer - b.layer) == 1
        if together and drawing.nodes[link.target].junction and a.layer > b.layer:
            continue
        both = together and drawing.nodes[link.source].junction
        is_hot = (link.source, link.target) in hot or (both and back in hot)
        yield _edge(link, _path(link, layout), both=both, hot=is_hot)


def _edge(link: Link, path: Path, *, both: bool, hot: bool) -> Markup:
    cls = " hot" if hot else ""
    line = el("path", d=path.d, cls=f"edge{cls}")
    heads = [_arrowhead(path.tip, path.turn, cls)]
    heads += [_arrowhead(path.tail, path.turn + 180, cls)] if both else []
    return el("g", line, heads, _label(link.label, path.at) if link.label else None)


def _arrowhead(at: tuple[float, float], turn: int, cls: str) -> Markup:
    place = f"translate({at[0]:g} {at[1]:g}) rotate({turn})"
    return el("path", d="M-8 -4 L0 0 L-8 4 z", transform=place, cls=f"arrowhead{cls}")


def _path(link: Link, layout: Layout) -> Path:
    a, b = layout.places[link.source], layout.places[link.target]
    if link.source == link.target:
        return _self_loop(a)
    if link in layout.lanes:
        return _lane(a, b, layout.width + layout.lanes.index(link) * LANE)
    if link in layout.bows:
        return _bow(a, b, layout.bows.index(link))
    return _sideways(a, b) if a.layer == b.layer else _between(a, b)


def _self_loop(a: Place) -> Path:
    """Below the right corner."""
    x, y = a.right - 26, a.bottom
    d = f"M{x - 12:g} {y:g} C{x - 20:g} {y + DEEP:g} {x + 20:g} {y + DEEP:g} {x + 12:g} {y:g}"
    return Path(d, (x + 12, y), -105, (x + 20, y + 18))


def _lane(a: Place, b: Place, x: float) -> Path:
    """Out to the right, along a lane of its own, and back in."""
    start, end = (min(14.0, p.tall / 2 - 4) for p in (a, b))
    d = f"M{a.right:g} {a.y + start:g} H{x - 8:g} Q{x:g} {a.y + start:g} {x:g} {(a.y + b.y) / 2:g} "
    d += f"Q{x:g} {b.y - end:g} {x - 8:g} {b.y - end:g} H{b.right:g}"
    return Path(d, (b.right, b.y - end), 180, (a.right + 4, a.y + start - 4))


def _sideways(a: Place, b: Place) -> Path:
    """Straight to the neighbour; there and back apart."""
    right = b.x > a.x
    start, end = (a.right, b.left) if right else (a.left, b.right)
    y = a.y + (-8 if right else 8)
    at = (min(start, end) + 6, y - 6 if right else y + 16)
    return Path(f"M{start:g} {y:g} H{end:g}", (end, y), 0 if right else 180, at)


def _bow(a: Place, b: Place, number: int) -> Path:
    """Round below the boxes in between."""
    shift = 16 if b.x > a.x else -16
    y, low = a.bottom, a.bottom + DEEP + 7 * (number + 1)
    d = f"M{a.x + shift:g} {y:g} C{a.x + shift:g} {low:g} {b.x + shift:g} {low:g}"
    at = (a.x + shift + 8, y + 14 + 14 * (number % 2))
    return Path(f"{d} {b.x + shift:g} {y:g}", (b.x + shift, y), -90, at)


def _between(a: Place, b: Place) -> Path:
    """Between adjacent layers; down on the left, back up on the right, so both can be seen."""
    down = b.layer > a.layer
    shift = 0 if down else 30
    y1, y2 = (a.bottom, b.top) if down else (a.top, b.bottom)
    x1, x2 = a.x + min(shift, a.wide / 3), b.x + min(shift, b.wide / 3)
    middle = (y1 + y2) / 2
    d = f"M{x1:g} {y1:g} C{x1:g} {middle:g} {x2:g} {middle:g} {x2:g} {y2:g}"
    at = (x2 + 8, y2 - 12 if down else y2 + 18)
    return Path(d, (x2, y2), 90 if down else -90, at, (x1, y1))


def _label(text: str, at: tuple[float, float]) -> Markup:
    x, y = at
    return el(
        "text", el("title", text), _cut(text, LETTERS), x=f"{x:g}", y=f"{y:g}", cls="soft halo"
    )


# --- boxes ----------------------------------------------------------------------------------------


def _lines(node: Node, unit: str) -> list[tuple[str, str]]:
    """The lines of a box with their styles: condition, command, how often and where, remark."""
    if node.junction:
        return []
    count = len(node.states)
    times = "" if count == 1 else f"{count} {unit}" if unit else f"{count} steps"
    where = " · ".join(p for p in (f"line {node.line}" if node.line else "", times) if p)
    end = "not explored further" if node.cut else node.note
    before = _wrapped(f"if {node.entry}") if node.entry else []
    after = [where, *_wrapped(end)] if where else _wrapped(end)
    return [*((t, "soft") for t in before), (node.title, "call"), *((t, "soft") for t in after)]


def _wrapped(text: str) -> list[str]:
    """A text in lines of a box; what is beyond the third one is left out."""
    return textwrap.wrap(text, COLUMNS, max_lines=3, placeholder=" …")


def _box(
    node: Node, lines: Sequence[tuple[str, str]], place: Place, *, start: bool, hot: bool
) -> Markup:
    if node.junction:
        title = el("title", node.title)
        style = "junction hot" if hot else "junction"
        return el("g", title, el("circle", cx=place.x, cy=place.y, r=place.tall / 2, cls=style))
    flags = (("node", True), ("start", start), ("cut", node.cut), ("hot", hot))
    style = " ".join(c for c, on in flags if on)
    first = place.y - (len(lines) - 1) * ROW / 2 + 4.5
    size = {"x": place.left, "y": place.top, "width": place.wide, "height": place.tall}
    return el(
        "g",
        el("title", " ".join(text for text, _ in lines)),
        el("rect", rx=8, cls=style, **size),
        [
            _centred(_cut(text, _room(place, cls)), place.x, first + ROW * n, cls)
            for n, (text, cls) in enumerate(lines)
        ],
    )


def _room(place: Place, style: str) -> int:
    """How many letters fit a box."""
    return int((place.wide - 16) / measure("x", style))


def _centred(text: str, x: float, y: float, cls: str) -> Markup:
    return el("text", text, x=f"{x:g}", y=f"{y:g}", text_anchor="middle", cls=cls)


def _cut(text: str, letters: int) -> str:
    return text if len(text) <= letters else text[: letters - 1] + "…"

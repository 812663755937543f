"""Draw an automaton as SVG: layers by distance from the start, top to bottom."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

from vaso.plan.transition_system import TransitionSystem
from vaso.report.automaton import Drawing, Link, Node, condense
from vaso.report.graph_layout import BOX, DEEP, LANE, SIDE, Layout, Place, make_layout
from vaso.report.markup import Markup, el, join
from vaso.report.plot import NARROW

LETTERS = 33
MOST = 60
FOLDED = "Every box stands for all states in which the robot executes that plan line."


@dataclass(frozen=True, slots=True)
class Path:
    """The way of an edge.

    Attributes:
        d: The path, as SVG has it.
        tip: Where it ends.
        turn: Direction of the arrowhead in degrees: 0 to the right, 90 down.
        at: Where its label stands.
    """

    d: str
    tip: tuple[float, float]
    turn: int
    at: tuple[float, float]


def automaton_svg(system: TransitionSystem, behaviour: Sequence[int] = ()) -> Markup:
    """The automaton as a drawing; the first nodes only where there are very many.

    Args:
        system: The automaton.
        behaviour: Control states of a behaviour, one after the other, to be brought out.
    """
    drawing = condense(system)
    shown = _first(drawing, MOST)
    texts = [_lines(node, "states" if drawing.folded else "") for node in shown.nodes]
    layout = make_layout(shown, [len(lines) for lines in texts])
    hot_nodes, hot_links = _visited(shown, behaviour)
    edges = [_edge(link, layout, (link.source, link.target) in hot_links) for link in shown.links]
    boxes = [
        _box(node, texts[i], layout.places[i], start=i == 0, hot=i in hot_nodes)
        for i, node in enumerate(shown.nodes)
    ]
    width = layout.width + (len(layout.lanes) + 1) * LANE
    width += SIDE if any(k.label for k in shown.links) else 0
    size = f"0 0 {width:g} {layout.height:g}"
    style = "graph small" if width <= NARROW else "graph"
    told = el("title", f"Automaton of the plan: {len(drawing.nodes)} boxes")
    svg = el("svg", told, edges, boxes, viewBox=size, width=f"{width:g}", cls=style, role="img")
    rest = len(drawing.nodes) - len(shown.nodes)
    more = f"{rest} more boxes are not drawn. " if rest else ""
    remark = more + (FOLDED if drawing.folded else "")
    scroll = el("div", svg, cls="scroll", tabindex=0)
    return join(scroll, el("p", remark, cls="soft small") if remark else None)


def _first(drawing: Drawing, count: int) -> Drawing:
    links = tuple(k for k in drawing.links if k.source < count and k.target < count)
    return Drawing(drawing.nodes[:count], links, drawing.folded)


def _visited(
    drawing: Drawing, behaviour: Sequence[int]
) -> tuple[Collection[int], Collection[tuple[int, int]]]:
    """The nodes and links that a behaviour goes through."""
    index = {state: n for n, node in enumerate(drawing.nodes) for state in node.states}
    way = [index[s] for s in behaviour if s in index]
    return set(way), set(pairwise(way))


# --- edges ----------------------------------------------------------------------------------------


def _edge(link: Link, layout: Layout, hot: bool) -> Markup:
    path = _path(link, layout)
    cls = " hot" if hot else ""
    (x, y), turn = path.tip, path.turn
    line = el("path", d=path.d, cls=f"edge{cls}")
    place = f"translate({x:g} {y:g}) rotate({turn})"
    head = el("path", d="M-8 -4 L0 0 L-8 4 z", transform=place, cls=f"arrowhead{cls}")
    return el("g", line, head, _label(link.label, path.at) if link.label else None)


def _path(link: Link, layout: Layout) -> Path:
    a, b = layout.places[link.source], layout.places[link.target]
    if link.source == link.target:
        return _self_loop(a)
    if link in layout.lanes:
        return _lane(a, b, layout.width + layout.lanes.index(link) * LANE)
    if a.layer == b.layer:
        return _sideways(a, b, layout)
    return _between(a, b)


def _self_loop(a: Place) -> Path:
    """Below the right corner."""
    x, y = a.x + BOX / 2 - 26, a.bottom
    d = f"M{x - 12:g} {y:g} C{x - 20:g} {y + DEEP:g} {x + 20:g} {y + DEEP:g} {x + 12:g} {y:g}"
    return Path(d, (x + 12, y), -105, (x + 20, y + 18))


def _lane(a: Place, b: Place, x: float) -> Path:
    """Out to the right, along a lane of its own, and back in."""
    start, end = a.x + BOX / 2, b.x + BOX / 2
    d = f"M{start:g} {a.y + 14:g} H{x - 8:g} Q{x:g} {a.y + 14:g} {x:g} {(a.y + b.y) / 2:g} "
    d += f"Q{x:g} {b.y - 14:g} {x - 8:g} {b.y - 14:g} H{end:g}"
    return Path(d, (end, b.y - 14), 180, (start + 4, a.y + 10))


def _sideways(a: Place, b: Place, layout: Layout) -> Path:
    """Within a layer: straight between neighbours (there and back apart), else round below."""
    right = b.x > a.x
    if abs(a.x - b.x) > layout.pitch + 1:
        return _below(a, b)
    start, end = (a.x + BOX / 2, b.x - BOX / 2) if right else (a.x - BOX / 2, b.x + BOX / 2)
    y = a.y + (-8 if right else 8)
    at = (min(start, end) + 6, y - 6 if right else y + 16)
    return Path(f"M{start:g} {y:g} H{end:g}", (end, y), 0 if right else 180, at)


def _below(a: Place, b: Place) -> Path:
    shift = 16 if b.x > a.x else -16
    y = a.bottom
    low = y + 1.5 * DEEP
    d = f"M{a.x + shift:g} {y:g} C{a.x + shift:g} {low:g} {b.x + shift:g} {low:g}"
    return Path(f"{d} {b.x + shift:g} {y:g}", (b.x + shift, y), -90, (a.x + shift + 8, y + 16))


def _between(a: Place, b: Place) -> Path:
    """Between adjacent layers; down on the left, back up on the right, so both can be seen."""
    down = b.layer > a.layer
    shift = 0 if down else 30
    y1, y2 = (a.bottom, b.top) if down else (a.top, b.bottom)
    x1, x2, middle = a.x + shift, b.x + shift, (y1 + y2) / 2
    d = f"M{x1:g} {y1:g} C{x1:g} {middle:g} {x2:g} {middle:g} {x2:g} {y2:g}"
    at = (x2 + 8, y2 - 12 if down else y2 + 18)
    return Path(d, (x2, y2), 90 if down else -90, at)


def _label(text: str, at: tuple[float, float]) -> Markup:
    x, y = at
    return el("text", el("title", text), _cut(text, LETTERS), x=x, y=y, cls="soft halo")


# --- boxes ----------------------------------------------------------------------------------------


def _lines(node: Node, unit: str) -> list[tuple[str, str]]:
    """The lines of a box with their styles: condition, command, how often and where, remark."""
    count = len(node.states)
    times = "" if count == 1 else f"{count} {unit}" if unit else f"{count} steps"
    where = " · ".join(p for p in (f"line {node.line}" if node.line else "", times) if p)
    end = "not explored further" if node.cut else node.note
    lines = [(f"if {node.entry}" if node.entry else "", "soft"), (node.title, "call")]
    return [line for line in (*lines, (where, "soft"), (end, "soft")) if line[0]]


def _box(
    node: Node,
    lines: Sequence[tuple[str, str]],
    place: Place,
    *,
    start: bool,
    hot: bool,
) -> Markup:
    flags = (("node", True), ("start", start), ("cut", node.cut), ("hot", hot))
    style = " ".join(c for c, on in flags if on)
    first = place.y - (len(lines) - 1) * 9 + 4.5
    left, top, tall = place.x - BOX / 2, place.top, place.tall
    return el(
        "g",
        el("title", " ".join(text for text, _ in lines)),
        el("rect", x=left, y=top, width=BOX, height=tall, rx=8, cls=style),
        [
            _centred(_cut(text, LETTERS), place.x, first + 18 * n, cls)
            for n, (text, cls) in enumerate(lines)
        ],
    )  # fmt: skip


def _centred(text: str, x: float, y: float, cls: str) -> Markup:
    return el("text", text, x=f"{x:g}", y=f"{y:g}", text_anchor="middle", cls=cls)


def _cut(text: str, letters: int) -> str:
    return text if len(text) <= letters else text[: letters - 1] + "…"

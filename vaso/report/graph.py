"""Draw an automaton as SVG: layers by distance from the start, top to bottom."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

from vaso.plan.transition_system import TransitionSystem
from vaso.report.automaton import Drawing, Link, Node, condense
from vaso.report.markup import Markup, el, join

BOX, TALL, GAP_Y, MARGIN = 232, 62, 62, 20
NARROW, WIDE = 60, 140
LANE = 16
DEEP = 30
SIDE = 90
LETTERS = 33
MOST = 60
FOLDED = "Every box stands for all states in which the robot executes that plan line."


@dataclass(frozen=True, slots=True)
class Place:
    """Layer and centre of a node, in pixels."""

    layer: int
    x: float
    y: float


def automaton_svg(system: TransitionSystem) -> Markup:
    """The automaton as a drawing; the first ones only where there are very many nodes."""
    drawing = condense(system)
    shown = _first(drawing, MOST)
    places, width = _layout(shown)
    lanes = [k for k in shown.links if _is_far(k, places)]
    total = width + (len(lanes) + 1) * LANE + (SIDE if any(k.label for k in shown.links) else 0)
    height = max(p.y for p in places) + TALL / 2 + MARGIN + DEEP
    edges = [_edge(link, places, width, lanes) for link in shown.links]
    unit = "states" if drawing.folded else ""
    nodes = [_box(node, places[i], i == 0, unit) for i, node in enumerate(shown.nodes)]
    svg = el(
        "svg",
        _arrowhead(),
        edges,
        nodes,
        viewBox=f"0 0 {total:g} {height:g}",
        width=f"{total:g}",
        cls="wide",
        role="img",
        aria_label="automaton of the plan",
    )
    rest = len(drawing.nodes) - len(shown.nodes)
    more = f"{rest} more nodes are not drawn. " if rest else ""
    remark = more + (FOLDED if drawing.folded else "")
    return join(el("div", svg, cls="scroll"), el("p", remark, cls="soft small") if remark else None)


def _first(drawing: Drawing, count: int) -> Drawing:
    links = tuple(k for k in drawing.links if k.source < count and k.target < count)
    return Drawing(drawing.nodes[:count], links, drawing.folded)


def _layout(drawing: Drawing) -> tuple[list[Place], float]:
    layers = _layers(drawing)
    rows: dict[int, list[int]] = defaultdict(list)
    for node, layer in enumerate(layers):
        rows[layer].append(node)
    gap = WIDE if _has_side_labels(drawing, layers) else NARROW
    widest = max(len(row) for row in rows.values())
    width = widest * (BOX + gap) - gap + 2 * MARGIN
    places: list[Place] = [Place(0, 0, 0)] * len(layers)
    for layer, row in rows.items():
        left = (width - len(row) * (BOX + gap) + gap) / 2
        for column, node in enumerate(row):
            x = left + column * (BOX + gap) + BOX / 2
            places[node] = Place(layer, x, MARGIN + TALL / 2 + layer * (TALL + GAP_Y))
    return places, width


def _layers(drawing: Drawing) -> list[int]:
    distance = {0: 0}
    queue = [0]
    for node in queue:
        for link in drawing.links:
            if link.source == node and link.target not in distance:
                distance[link.target] = distance[node] + 1
                queue.append(link.target)
    return [distance.get(n, 0) for n in range(len(drawing.nodes))]


def _has_side_labels(drawing: Drawing, layers: list[int]) -> bool:
    return any(
        k.label and k.source != k.target and layers[k.source] == layers[k.target]
        for k in drawing.links
    )


def _is_far(link: Link, places: list[Place]) -> bool:
    return abs(places[link.source].layer - places[link.target].layer) > 1


def _edge(link: Link, places: list[Place], width: float, lanes: list[Link]) -> Markup:
    a, b = places[link.source], places[link.target]
    if link.source == link.target:
        path, at = _self_loop(a)
    elif link in lanes:
        path, at = _lane(a, b, width + lanes.index(link) * LANE)
    elif a.layer == b.layer:
        path, at = _sideways(a, b)
    else:
        path, at = _between(a, b)
    line = el("path", d=path, cls="edge", marker_end="url(#vaso-arrow)")
    return el("g", line, _label(link.label, at) if link.label else None)


def _self_loop(a: Place) -> tuple[str, tuple[float, float]]:
    """Below the right corner."""
    x, y = a.x + BOX / 2 - 26, a.y + TALL / 2
    return f"M{x - 12} {y} C{x - 20} {y + DEEP} {x + 20} {y + DEEP} {x + 12} {y}", (x + 20, y + 18)


def _lane(a: Place, b: Place, x: float) -> tuple[str, tuple[float, float]]:
    """Out to the right, along a lane of its own, and back in."""
    start, end = a.x + BOX / 2, b.x + BOX / 2
    path = f"M{start} {a.y + 14} H{x - 8} Q{x} {a.y + 14} {x} {(a.y + b.y) / 2} "
    return f"{path}Q{x} {b.y - 14} {x - 8} {b.y - 14} H{end}", (start + 4, a.y + 10)


def _sideways(a: Place, b: Place) -> tuple[str, tuple[float, float]]:
    """Within a layer: straight between neighbours (there and back apart), else round below."""
    right = b.x > a.x
    if abs(a.x - b.x) > BOX + WIDE + 1:
        return _below(a, b)
    start, end = (a.x + BOX / 2, b.x - BOX / 2) if right else (a.x - BOX / 2, b.x + BOX / 2)
    y = a.y + (-8 if right else 8)
    return f"M{start} {y} H{end}", (min(start, end) + 6, y - 6 if right else y + 16)


def _below(a: Place, b: Place) -> tuple[str, tuple[float, float]]:
    shift = 16 if b.x > a.x else -16
    y = a.y + TALL / 2
    path = f"M{a.x + shift} {y} C{a.x + shift} {y + 1.5 * DEEP} {b.x + shift} {y + 1.5 * DEEP}"
    return f"{path} {b.x + shift} {y}", (a.x + shift + 8, y + 16)


def _between(a: Place, b: Place) -> tuple[str, tuple[float, float]]:
    """Between adjacent layers; down on the left, back up on the right, so both can be seen."""
    down = b.layer > a.layer
    shift = 0 if down else 30
    y1, y2 = (a.y + TALL / 2, b.y - TALL / 2) if down else (a.y - TALL / 2, b.y + TALL / 2)
    x1, x2, middle = a.x + shift, b.x + shift, (y1 + y2) / 2
    return f"M{x1} {y1} C{x1} {middle} {x2} {middle} {x2} {y2}", (
        x2 + 6,
        y2 - 12 if down else y2 + 18,
    )


def _label(text: str, at: tuple[float, float]) -> Markup:
    return el("text", el("title", text), _cut(text, LETTERS), x=at[0], y=at[1], cls="soft halo")


def _box(node: Node, place: Place, start: bool, unit: str) -> Markup:
    left, top = place.x - BOX / 2, place.y - TALL / 2
    style = " ".join(c for c, on in (("node", True), ("start", start), ("cut", node.cut)) if on)
    entry = f"if {node.entry}" if node.entry else ""
    return el(
        "g",
        el("title", f"{node.title} {node.note}".strip()),
        el("rect", x=left, y=top, width=BOX, height=TALL, rx=8, cls=style),
        _centred(_cut(entry, LETTERS), place.x, top + 16, "soft"),
        _centred(_cut(node.title, LETTERS - 3), place.x, top + 35),
        _centred(_cut(_where(node, unit), LETTERS), place.x, top + 53, "soft"),
    )


def _centred(text: str, x: float, y: float, cls: str | None = None) -> Markup:
    return el("text", text, x=x, y=y, text_anchor="middle", cls=cls)


def _where(node: Node, unit: str) -> str:
    count = len(node.states)
    times = "" if count == 1 else f"{count} {unit}" if unit else f"× {count}"
    line = f"line {node.line}" if node.line else ""
    end = "not explored further" if node.cut else node.note
    return " · ".join(p for p in (times, line, end) if p)


def _cut(text: str, letters: int) -> str:
    return text if len(text) <= letters else text[: letters - 1] + "…"


def _arrowhead() -> Markup:
    head = el("path", d="M0 0 L8 4 L0 8 z", cls="arrow")
    marker = el(
        "marker",
        head,
        id="vaso-arrow",
        markerWidth=8,
        markerHeight=8,
        refX=8,
        refY=4,
        orient="auto",
        markerUnits="userSpaceOnUse",
    )
    return el("defs", marker)

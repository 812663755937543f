"""Where the boxes of an automaton stand: in layers by their distance from the start."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from vaso.report.automaton import Drawing, Link

NARROWEST, WIDEST, DOT, MARGIN = 120.0, 270.0, 16.0, 14.0
CODE, LETTER, ROW = 7.9, 6.8, 18
NARROW = 28.0
LANE = 16
DEEP = 26
LOW, HIGH = 28, 54


@dataclass(frozen=True, slots=True)
class Place:
    """Layer, centre and size of a box, in pixels."""

    layer: int
    x: float
    y: float
    wide: float
    tall: float

    @property
    def top(self) -> float:
        """Its upper edge."""
        return self.y - self.tall / 2

    @property
    def bottom(self) -> float:
        """Its lower edge."""
        return self.y + self.tall / 2

    @property
    def left(self) -> float:
        """Its left edge."""
        return self.x - self.wide / 2

    @property
    def right(self) -> float:
        """Its right edge."""
        return self.x + self.wide / 2


@dataclass(frozen=True, slots=True)
class Layout:
    """Where everything stands, in pixels.

    Attributes:
        places: Of each node.
        pitch: Distance of the centres of neighbours in a layer.
        lanes: The links that go past a layer, each in a lane of its own on the right.
        bows: The links round below the boxes of a layer, each deeper than the one before.
        width: Of the boxes; the lanes come after it.
        height: Of everything.
    """

    places: list[Place]
    pitch: float
    lanes: list[Link]
    bows: list[Link]
    width: float
    height: float


def make_layout(drawing: Drawing, texts: Sequence[Sequence[tuple[str, str]]]) -> Layout:
    """Lay a drawing out.

    Args:
        drawing: The nodes and links.
        texts: The lines in each box, each with its style.
    """
    layers = _layers(drawing)
    widest = max((measure(*line) for lines in texts for line in lines), default=0.0)
    box = min(WIDEST, max(NARROWEST, widest + 24))
    pitch = box + max([NARROW, *(measure(label) + 24 for label in _side_labels(drawing, layers))])
    rows = _rows(drawing, layers)
    width = max(len(row) - 1 for row in rows) * pitch + box + 2 * MARGIN
    places: dict[int, Place] = {}
    top: float = MARGIN
    for layer, row in enumerate(rows):
        row = _ordered(row, drawing, places)
        left = width / 2 - (len(row) - 1) * pitch / 2
        lines = max((len(texts[n]) for n in row if not drawing.nodes[n].junction), default=0)
        tall = ROW * max(2, lines) + 14 if lines else DOT
        for column, node in enumerate(row):
            size = (DOT, DOT) if drawing.nodes[node].junction else (box, tall)
            places[node] = Place(layer, left + column * pitch, top + tall / 2, *size)
        top += tall + (LOW if _is_chain(drawing, layers) else HIGH)
    ordered = [places[n] for n in range(len(layers))]
    far = [k for k in drawing.links if abs(layers[k.source] - layers[k.target]) > 1]
    bows = [k for k in drawing.links if _is_bow(k, ordered, pitch)]
    height = max(p.bottom for p in ordered) + MARGIN + DEEP + 5 * len(bows)
    return Layout(ordered, pitch, far, bows, width, height)


def measure(text: str, style: str = "soft") -> float:
    """About how wide a text is."""
    return len(text) * (CODE if style == "call" else LETTER)


def _rows(drawing: Drawing, layers: Sequence[int]) -> list[list[int]]:
    rows: list[list[int]] = [[] for _ in range(max(layers) + 1)]
    for node, layer in enumerate(layers):
        rows[layer].append(node)
    return rows


def _ordered(row: Sequence[int], drawing: Drawing, places: Mapping[int, Place]) -> list[int]:
    """The nodes of a layer, each near the nodes above that lead to it."""
    above: dict[int, list[float]] = defaultdict(list)
    for link in drawing.links:
        if link.source in places:
            above[link.target].append(places[link.source].x)
    return sorted(row, key=lambda n: sum(above[n]) / len(above[n]) if above[n] else 0.0)


def _is_bow(link: Link, places: Sequence[Place], pitch: float) -> bool:
    a, b = places[link.source], places[link.target]
    return a.layer == b.layer and abs(a.x - b.x) > pitch + 1


def _layers(drawing: Drawing) -> list[int]:
    distance = {0: 0}
    queue = [0]
    for node in queue:
        for link in drawing.links:
            if link.source == node and link.target not in distance:
                distance[link.target] = distance[node] + 1
                queue.append(link.target)
    return [distance.get(n, 0) for n in range(len(drawing.nodes))]


def _is_chain(drawing: Drawing, layers: Sequence[int]) -> bool:
    """True where there is one box a layer and nothing to read between them."""
    return len(set(layers)) == len(layers) and not any(k.label for k in drawing.links)


def _side_labels(drawing: Drawing, layers: Sequence[int]) -> list[str]:
    """What stands between neighbours in a layer."""
    return [
        k.label
        for k in drawing.links
        if k.source != k.target and layers[k.source] == layers[k.target]
    ]

"""Where the boxes of an automaton stand: in layers by their distance from the start."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from vaso.report.automaton import Drawing, Link

BOX, MARGIN = 252, 14
NARROW, WIDE = 56, 140
LANE, SIDE = 16, 90
DEEP = 26
LOW, HIGH = 28, 58


@dataclass(frozen=True, slots=True)
class Place:
    """Layer, centre and height of a box, in pixels."""

    layer: int
    x: float
    y: float
    tall: float = 0.0

    @property
    def top(self) -> float:
        """Its upper edge."""
        return self.y - self.tall / 2

    @property
    def bottom(self) -> float:
        """Its lower edge."""
        return self.y + self.tall / 2


@dataclass(frozen=True, slots=True)
class Layout:
    """Where everything stands, in pixels.

    Attributes:
        places: Of each node.
        pitch: Distance of the centres of neighbours in a layer.
        lanes: The links that go past a layer, each in a lane of its own on the right.
        width: Of the boxes; the lanes come after it.
        height: Of everything.
    """

    places: list[Place]
    pitch: float
    lanes: list[Link]
    width: float
    height: float


def make_layout(drawing: Drawing, rows: Sequence[int]) -> Layout:
    """Lay a drawing out.

    Args:
        drawing: The nodes and links.
        rows: Lines of text in each box.
    """
    layers = _layers(drawing)
    apart = LOW if _is_chain(drawing, layers) else HIGH
    pitch = BOX + (WIDE if _has_side_labels(drawing, layers) else NARROW)
    members: dict[int, list[int]] = defaultdict(list)
    for node, layer in enumerate(layers):
        members[layer].append(node)
    widest = max(len(row) for row in members.values())
    width = (widest - 1) * pitch + BOX + 2 * MARGIN
    places: list[Place] = [Place(0, 0, 0)] * len(layers)
    top: float = MARGIN
    for layer, row in sorted(members.items()):
        left = width / 2 - (len(row) - 1) * pitch / 2
        tall = 18 * max(2, *(rows[node] for node in row)) + 14
        for column, node in enumerate(row):
            places[node] = Place(layer, left + column * pitch, top + tall / 2, tall)
        top += tall + apart
    lanes = [k for k in drawing.links if abs(layers[k.source] - layers[k.target]) > 1]
    height = max(p.bottom for p in places) + MARGIN + DEEP
    return Layout(places, pitch, lanes, width, height)


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


def _has_side_labels(drawing: Drawing, layers: Sequence[int]) -> bool:
    return any(
        k.label and k.source != k.target and layers[k.source] == layers[k.target]
        for k in drawing.links
    )

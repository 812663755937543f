"""Specifications of small designs: a lift and a buffer.

Sources: De Wulf, Doyen, Maquet & Raskin, Antichains: Alternative Algorithms for LTL Satisfiability
and Model-Checking (TACAS 2008), for the lift; Bloem, Jobstmann, Piterman, Pnueli & Sa'ar, Synthesis
of Reactive(1) Designs (2012), for IBM's generalised buffer.
"""

from __future__ import annotations

import itertools

from vaso.bench.corpus.case import Case, all_of, any_of

__all__ = ["buffer", "lift"]


def lift(floors: int, *, busy: bool = False) -> Case:
    """A lift with a button on each floor, which serves every call and waits on the ground floor.

    Args:
        floors: Their number, at least 2.
        busy: Every button is pressed again and again.
    """
    at, button = [f"f{i}" for i in range(floors)], [f"b{i}" for i in range(floors)]
    parts = [f"G({p} -> !{q})" for p, q in itertools.combinations(at, 2)]
    parts += ["!u", at[0], *(f"!{b}" for b in button), "!up", "G(u <-> !(X u))"]
    parts.append(f"G(u -> {all_of(f'({p} <-> X {p})' for p in at)})")
    for i, here in enumerate(at):
        parts.append(f"G({here} -> X {any_of(at[max(0, i - 1) : i + 2])})")
    parts.append(f"G(!u -> {all_of(f'({b} <-> X {b})' for b in button)})")
    for b, here in zip(button, at, strict=True):
        parts += [f"G(({b} & !{here}) -> X {b})", f"G(({here} & X {here}) -> (up <-> X up))"]
    for low, high in itertools.pairwise(at):
        parts += [f"G(({low} & X {high}) -> up)", f"G(({high} & X {low}) -> !up)"]
    parts.append(f"G(sb <-> {any_of(button)})")
    parked = f"!((!sb) U !((F {at[0]}) & !up))"
    parts += [f"G(({here} & !sb) -> ({here} U {parked}))" for here in at]
    parts += [f"G({b} -> F {here})" for b, here in zip(button, at, strict=True)]
    parts += [f"(G F {b})" for b in button] if busy else []
    name = f"lift {floors}{', busy' * busy}"
    return Case("alaska lift", name, all_of(f"({p})" for p in parts), None if busy else True)


def buffer(senders: int, form: str) -> Case:
    """The generalised buffer: a queue between senders and two receivers, with handshakes.

    Args:
        senders: Their number, at least 2.
        form: ``implication`` (assumptions imply guarantees), ``conjunction`` (of both), or
            ``busy`` (and every sender sends again and again). All are satisfiable.
    """
    world, design = _world(senders), _design(senders)
    if form == "implication":
        text = f"{all_of(world)} -> {all_of(design)}"
    else:
        busy = [f"(G F req{i})" for i in range(senders)] if form == "busy" else []
        text = all_of([*world, *design, *busy])
    return Case("anzu genbuf", f"genbuf {senders}, {form}", text, True)


def _always(text: str) -> str:
    return f"(!((!FALSE) U (!({text}))))"  # as the published files have it


def _often(text: str) -> str:
    return _always(f"TRUE U ({text})")


def _world(senders: int) -> list[str]:
    """What senders, receivers and the queue do."""
    calm = [*(f"!req{i}" for i in range(senders)), "!done0", "!done1", "!full", "empty"]
    rules = [all_of(calm)]
    for i in range(senders):
        rules += [_always(f"!req{i} | ack{i} | X req{i}"), _always(f"!ack{i} | X !req{i}")]
    for j in (0, 1):
        rules += [
            _often(f"(call{j} & done{j}) | (!call{j} & !done{j})"),
            _always(f"call{j} | X !done{j}"),
            _always(f"!call{j} | !done{j} | X done{j}"),
        ]
    kept = "(full <-> X full) & (empty <-> X empty)"
    rules += [_always("!enq | deq | X !empty"), _always("!deq | enq | X !full")]
    return [*rules, _always(f"(enq xor deq) | ({kept})")]


def _design(senders: int) -> list[str]:
    """What the buffer promises."""
    bits = range(max(1, (senders - 1).bit_length()))
    quiet = [f"!ack{i}" for i in range(senders)] + ["!call0", "!call1", "!t0", "t1"]
    rules = [all_of([*quiet, "!enq", "!deq", "!w", *(f"!slc{b}" for b in bits)])]
    for i in range(senders):
        chosen = all_of(f"{'' if i >> b & 1 else '!'}slc{b}" for b in bits)
        rules += [
            _always(f"req{i} | X !req{i} | X !ack{i}"),
            _always(f"ack{i} | req{i} | X !ack{i}"),
            _always(f"!ack{i} | !req{i} | X ack{i}"),
            _always(f"ack{i} | X !ack{i} | X enq"),
            _always(f"(!ack{i} & X ack{i}) {'->' if i == 0 else '<->'} X {chosen}"),
            _often(f"req{i} <-> ack{i}"),
        ]
        rules += [_always(f"!ack{i} | !ack{j}") for j in range(i + 1, senders)]
    starts = any_of(f"(!ack{i} & X ack{i})" for i in range(senders))
    ends = any_of(f"(done{j} & X !done{j})" for j in (0, 1))
    rules += [_always(f"{starts} | X !enq"), _always(f"{ends} | X !deq")]
    return [*rules, *_receivers(), *_queue()]


def _receivers() -> list[str]:
    """Receivers are served in turn; ``t1`` and ``t0`` remember whose turn it is."""
    rules = [_always("!call0 | !call1")]
    for j in (0, 1):
        rules += [_always(f"!call{j} | done{j} | X call{j}"), _always(f"!done{j} | X !call{j}")]
        rules.append(_always(f"!done{j} | X done{j} | X deq"))
    for t1, t0, calls, then in (
        ("!t1", "", "!call0 & call1", "t1 & !t0"),
        ("t1", "", "call0 & !call1", "!t1 & !t0"),
        ("!t1", "", "!call0 & !call1", "!t1 & t0"),
        ("t1", "", "!call0 & !call1", "t1 & t0"),
        ("!t1", "& !t0", "call0 & !call1", "!t1 & !t0"),
        ("t1", "& !t0", "!call0 & call1", "t1 & !t0"),
    ):
        rules.append(_always(f"({t1} {t0} & {calls}) -> X({then})"))
    return [*rules, _always("t1 | !t0 | !call0"), _always("!t1 | !t0 | !call1")]


def _queue() -> list[str]:
    """Nothing into a full queue or out of an empty one, and no entry waits for ever (``w``)."""
    return [
        _always("!full | deq | !enq"),
        _always("!empty | !deq"),
        _always("w | !empty | X !w"),
        _always("w | !deq | X !w"),
        _always("w | empty | deq | X w"),
        _always("!w | deq | X w"),
        _always("!w | !deq | X !w"),
        _often("!w"),
    ]

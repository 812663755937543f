"""Binary counters (Rozier & Vardi, LTL Satisfiability Checking, SPIN 2007, section 4).

``b`` shows the bits of a number, lowest first, one a step; ``a`` marks the lowest. Each turn shows
the next number. The only behaviour, up to what is left open, is a loop of ``n * 2**n`` steps.
"""

from __future__ import annotations

from vaso.bench.corpus.case import Case, all_of, nexts

__all__ = ["counter"]


def counter(bits: int, *, carry: bool, linear: bool) -> Case:
    """A counter.

    Args:
        bits: Their number, at least 2.
        carry: With a third proposition ``c`` for the carry, and without ``U``.
        linear: With nested ``X``, so that the length is linear in ``bits`` and not quadratic.
    """
    rules = _with_carry(bits, linear) if carry else _with_until(bits, linear)
    name = f"counter{'Carry' * carry}{'Linear' * linear}"
    parts = ["a", _marks(bits, linear), _zero(bits, linear), *rules]
    return Case("rozier counters", f"{name} {bits}", all_of(parts), True)


def _marks(bits: int, linear: bool) -> str:
    later = [*["!a"] * (bits - 1), "a"]
    return f"G(a -> {_shown(later, linear, 1)})"


def _zero(bits: int, linear: bool) -> str:
    return _shown(["!b"] * bits, linear, 0)


def _shown(values: list[str], linear: bool, first: int) -> str:
    """That values are shown one after the other, from some step on."""
    if not linear:
        return all_of(nexts(i, value) for i, value in enumerate(values, start=first))
    text = values[-1]
    for value in reversed(values[:-1]):
        text = f"({value} & X {text})"
    return nexts(first, text)


def _with_until(bits: int, linear: bool) -> list[str]:
    kept = f"(!a & (b -> {nexts(bits, 'b')}) & (!b -> {nexts(bits, '!b')}))"
    flipped = f"(b & !a & {nexts(bits, '!b')})"
    if linear:
        rest = f"(!a & !b & X({nexts(bits - 1, 'b')} & ({kept} U a)))"
        return [
            f"G(a & !b -> X({nexts(bits - 1, 'b')} & ({kept} U a)))",
            f"G(a & b -> X({nexts(bits - 1, '!b')} & ({flipped} U (a | {rest}))))",
        ]
    rest = f"(!a & !b & {nexts(bits, 'b')} & X({kept} U a))"
    return [
        f"G(a & !b -> {nexts(bits, 'b')} & X({kept} U a))",
        f"G(a & b -> {nexts(bits, '!b')} & X({flipped} U (a | {rest})))",
    ]


def _with_carry(bits: int, linear: bool) -> list[str]:
    low = [
        f"G(a & !b -> !c & {nexts(bits, 'b')})",
        f"G(a & b -> c & {nexts(bits, '!b')})",
    ]
    if linear:
        kept = f"!c & (b -> {nexts(bits, 'b')}) & (!b -> {nexts(bits, '!b')})"
        added = f"(!b -> !c & {nexts(bits, 'b')}) & (b -> c & {nexts(bits, '!b')})"
        return [*low, f"G(!c & X !a -> X({kept}))", f"G(c -> X({added}))"]
    further = bits + 1
    kept = f"X !c & (X b -> {nexts(further, 'b')}) & (X !b -> {nexts(further, '!b')})"
    added = f"(X !b -> X !c & {nexts(further, 'b')}) & (X b -> X c & {nexts(further, '!b')})"
    return [*low, f"G(!c & X !a -> {kept})", f"G(c -> {added})"]

"""Formulas that programs wrote: long, deep, and no reason to recurse or to be slow."""

import pickle

import pytest

from vaso.errors import FormulaError
from vaso.feasibility import satisfiable
from vaso.ltl import (
    GENERATED,
    WRITTEN,
    depth,
    nnf,
    parse,
    simplify,
    size,
    to_bracketed,
    to_text,
    to_unicode,
)

N = 2_000  # four times what people may write
SHAPES = {
    "to the left": "(" * N + "p" + " & q)" * N,
    "to the right": "(F p & " * N + "q" + ")" * N,
    "next": "X " * N + "p",
    "negations": "! " * N + "p",
    "until": "(" * N + "p" + " U q)" * N,
    "implications": "p -> " * N + "q",
    "equivalences": "G p <-> " * N + "q",
    "many rules": " & ".join(f"G(a{i} -> F b{i})" for i in range(N // 10)),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_reading_and_printing_are_inverse(shape: str) -> None:
    formula = parse(SHAPES[shape], limits=GENERATED)
    assert size(formula) >= N // 10
    for text in (to_text(formula), to_unicode(formula), to_bracketed(formula)):
        assert parse(text, limits=GENERATED) == formula
    assert pickle.loads(pickle.dumps(formula)) == formula


@pytest.mark.parametrize("shape", SHAPES)
def test_normal_forms_do_not_recurse(shape: str) -> None:
    assert depth(nnf(simplify(parse(SHAPES[shape], limits=GENERATED)))) >= 0


@pytest.mark.parametrize("shape", ["to the left", "next", "until", "implications"])
def test_they_are_decided(shape: str) -> None:
    assert satisfiable(SHAPES[shape], timeout=100).sat is True


def test_what_people_write_keeps_its_limits() -> None:
    with pytest.raises(FormulaError, match="at most 500"):
        parse(SHAPES["next"], limits=WRITTEN)
    with pytest.raises(FormulaError, match="at most"):
        parse(SHAPES["to the left"])


def test_generated_formulas_have_limits_too() -> None:
    with pytest.raises(FormulaError, match="at most"):
        parse("p" * (GENERATED.length + 1), limits=GENERATED)


@pytest.mark.parametrize("text", ["; " * 100_000, '"' * 100_000, "(" * 100_000, "1. " * 50_000])
def test_nonsense_is_refused_at_once(text: str) -> None:
    with pytest.raises(FormulaError):
        parse(text, limits=GENERATED)

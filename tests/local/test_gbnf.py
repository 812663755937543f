import random

import pytest
from gbnf_reader import Grammar

from vaso.local import gbnf


def read(root: str) -> Grammar:
    rules = gbnf.Rules()
    rules.add("digit", "[0-9]")
    rules.add("unused", '"x"')
    rules.add("root", root)
    assert "unused" not in str(rules)
    return Grammar.read(str(rules))


@pytest.mark.parametrize("literal", ['a "b" c', "a\\n", "line\n    next", '" "', "[x] | (y)", "é"])
def test_a_text_is_only_itself(literal):
    grammar = read(gbnf.seq(gbnf.text(literal), gbnf.text(literal)))
    assert grammar.matches(literal + literal)
    assert not grammar.matches(literal) and not grammar.matches(literal + "x")
    assert grammar.sample(random.Random(0)) == literal + literal


def test_neighbouring_texts_become_one():
    assert gbnf.seq(gbnf.text("a"), gbnf.text("b"), "digit", gbnf.text("c")) == '"ab" digit "c"'


def test_a_repeated_text_stays_alone():
    grammar = read(gbnf.seq(gbnf.text("a"), gbnf.maybe(gbnf.text("b")), gbnf.text("c")))
    assert grammar.matches("ac") and grammar.matches("abc") and not grammar.matches("c")


def test_options_and_repetitions():
    choice = gbnf.texts(["left", "right", "left"])
    assert choice == '("left" | "right")'
    grammar = read(gbnf.seq(gbnf.repeat(choice, 1, 2), "digit"))
    assert grammar.matches("left1") and grammar.matches("leftright2")
    assert not grammar.matches("1") and not grammar.matches("leftleftleft1")
    both = read(gbnf.repeat(gbnf.seq(choice, choice), 0, 1))
    assert both.matches("") and both.matches("leftright") and not both.matches("left")


def test_a_call():
    assert gbnf.call("f", ["digit", "digit"]) == '"f(" digit ", " digit ")"'
    assert gbnf.call("f", []) == '"f()"'

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ltl_samples import PAPER, formulas

from vaso.errors import FormulaError
from vaso.ltl import ParsedFormula, parse, parse_with_warnings, to_bracketed, to_unicode


@settings(max_examples=1000)
@given(formulas)
def test_the_canonical_text_reads_back_and_never_misleads(formula):
    parsed = parse_with_warnings(str(formula))
    assert parsed.formula == formula
    assert parsed.warnings == ()


@settings(max_examples=1000)
@given(formulas)
def test_the_unicode_text_reads_back(formula):
    assert parse(to_unicode(formula)) == formula


@settings(max_examples=300)
@given(formulas)
def test_the_bracketed_text_reads_back(formula):
    assert parse(to_bracketed(formula)) == formula


FRAGMENTS = [
    *"()[]{}!~&|^<>=-+*/.,;:$`'\\_ \n\tGFXUVRWOHYZSTpx19",
    *["->", "<->", "[]", "<>", "people observed", "GF ", "not", "until", "release", "0.5", "m/s"],
    *[
        "\\neg ",
        "\\mathbf{G}",
        "\\texttt{a b}",
        "□",
        "→",
        "¬",
        "𝒰",
        "LTLSPEC ",
        "TRUE",
        "xor",
        "()",
    ],
]


@settings(max_examples=1500)
@given(st.one_of(st.text(), st.lists(st.sampled_from(FRAGMENTS), max_size=25).map("".join)))
def test_no_text_raises_anything_but_a_formula_error(text):
    try:
        parsed = parse_with_warnings(text)
    except FormulaError as error:
        assert "^" in error.message
    else:
        assert parse(str(parsed.formula)) == parsed.formula


# --------------------------------------------------------------------------------- the paper


@pytest.mark.parametrize(
    ("rule", "canonical"),
    {
        1: "G(people_observed -> X stop)",
        2: "G(obstacle_observed -> X !forward)",
        3: "G(speed < 0.5)",
        4: "(F !people_observed) & !obstacle_observed -> F !stop",
        5: "(F obstacle_observed) -> turn_left | turn_right",
        6: "G(max_altitude < 10)",
        7: "G(velocity_change <= 1)",
        8: "G(linear_velocity <= 1)",
        9: "F(linear_velocity == 0 & altitude == 0)",
        10: "G(altitude == 0 -> linear_velocity == 0)",
        11: "F(linear_velocity > 0)",
    }.items(),
)
def test_rules_of_the_paper(rule, canonical):
    parsed = parse_with_warnings(PAPER[rule])
    assert str(parsed.formula) == canonical
    assert bool(parsed.warnings) == (rule in (4, 5))


@pytest.mark.parametrize(
    ("text", "canonical"),
    [
        (
            "G(!obstacle observed | person observed -> X forward)",
            "G(!obstacle_observed | person_observed -> X forward)",
        ),
        ("G(person observed -> X stop)", "G(person_observed -> X stop)"),
        (
            "G(! (obstacle observed | person observed) -> X forward)",
            "G(!(obstacle_observed | person_observed) -> X forward)",
        ),
        ("G(obstacle_observed -> X not forward)", "G(obstacle_observed -> X !forward)"),
        ("G(people observed → X ¬ forward)", "G(people_observed -> X !forward)"),
        (
            r"$F(\neg \texttt{people\_observed} \wedge \neg \texttt{obstacle\_observed}) "
            r"\rightarrow F(\neg \texttt{stop})$",
            "F(!people_observed & !obstacle_observed) -> F !stop",
        ),
        (r"\mathbf{G}(\texttt{linear\_velocity} < 1),".rstrip(","), "G(linear_velocity < 1)"),
        ("G(max_altitude)", "G max_altitude"),
    ],
)
def test_other_formulas_of_the_paper(text, canonical):
    assert str(parse(text)) == canonical


# ------------------------------------------------------------------------------- precedence


@pytest.mark.parametrize(
    ("text", "reading"),
    [
        ("a -> b -> c", "a -> (b -> c)"),
        ("a <-> b <-> c", "(a <-> b) <-> c"),
        ("a -> b <-> c", "a -> (b <-> c)"),
        ("a | b xor c | d", "((a | b) xor c) | d"),
        ("a | b & c", "a | (b & c)"),
        ("a & b U c", "a & (b U c)"),
        ("a U b V c", "(a U b) V c"),
        ("a S b T c W d", "((a S b) T c) W d"),
        ("F a U b", "(F a) U b"),
        ("! a U b", "!a U b"),
        ("X speed < 1", "X (speed < 1)"),
        ("!speed < 1", "!(speed < 1)"),
        ("a < 1 U b", "(a < 1) U b"),
        ("a - b - 1 < c * 2 + 1", "(a - b - 1 < c * 2 + 1)"),
    ],
)
def test_precedence_is_that_of_nusmv(text, reading):
    assert parse(text) == parse(reading)


# -------------------------------------------------------------------------------- spellings


@pytest.mark.parametrize(
    "text",
    [
        "G(p -> X !q)",
        "[](p => ○ ~q)",
        "[ ] ( p --> X not q )",
        "□(p → ◯ ¬q)",
        "always (p implies next not q)",
        "Globally(p ⇒ next NOT q)",
        r"\Box(p \to \bigcirc \lnot q)",
        r"\mathbf{G}\left(p \Rightarrow \mathbf{X}\, \neg q\right)",
        "𝐆(p ==> 𝐗 ¬q)",
        "G[p -> X{!q}]",
        "LTLSPEC G(p -> X !q);",
        "LTLSPEC NAME safe := G(p -> X !q)",
        "`G(p -> X !q)`.",
        "1. G(p -> X !q)",
        "```\nG(p -> X !q)\n```",
        r"\(G(p -> X !q)\)",
        "“G(p -> X !q)”",
        "G(p() -> X !q())",
        "G(p\n  -> X !q)",
        "G(p == TRUE -> X q = false)",
    ],
)
def test_spellings_of_one_formula(text):
    assert str(parse(text)) == "G(p -> X !q)"


@pytest.mark.parametrize(
    ("text", "canonical"),
    [
        ("<> p", "F p"),
        ("◇p", "F p"),
        ("eventually p", "F p"),
        ("p until q", "p U q"),
        ("p 𝒰 q", "p U q"),
        ("p R q", "p V q"),
        ("p releases q", "p V q"),
        ("p weak until q", "p W q"),
        ("p weak-until q", "p W q"),
        ("once p", "O p"),
        ("historically p", "H p"),
        ("previously p", "Y p"),
        ("yesterday p", "Y p"),
        ("Z p", "Z p"),
        ("p since q", "p S q"),
        ("p triggered q", "p T q"),
        ("p && q || r", "p & q | r"),
        (r"p /\ q \/ r", "p & q | r"),
        ("p ^ q", "p xor q"),
        ("p ⊕ q", "p xor q"),
        ("p <=> q", "p <-> q"),
        ("p iff q", "p <-> q"),
        ("⊤ & ⊥", "TRUE & FALSE"),
        ("True | false", "TRUE | FALSE"),
        ("x =< 1", "x <= 1"),
        ("x ≤ 1", "x <= 1"),
        ("x ≥ 1", "x >= 1"),
        ("x = 1", "x == 1"),
        ("x /= 1", "x != 1"),
        ("x ≠ 1", "x != 1"),
        ("x > -1", "x > -1"),
        ("-x < .5", "0 - x < 0.5"),
        ("x < 1e-3", "x < 0.001"),
        ("GF p", "G F p"),
        ("FG p -> GF q", "F G p -> G F q"),
        ("GX(p)", "G X p"),
        ("XX p", "X X p"),
        ("XX !p", "X X !p"),
        ("G!p", "G !p"),
    ],
)
def test_operators(text, canonical):
    assert str(parse(text)) == canonical


@pytest.mark.parametrize(
    "name",
    [
        *["door_observed", "not_moving", "until_door", "forward", "origin", "x", "f1", "g", "u"],
        *["Gp", "GFp", "GO", "release", "released", "nextcommand", "trueish", "android", "s", "m"],
    ],
)
def test_names_that_contain_operators_are_names(name):
    assert parse(f"G({name} -> X !{name})").operand.left.name == name


@pytest.mark.parametrize(
    ("text", "canonical"),
    [
        ("G(people observed -> X turn left)", "G(people_observed -> X turn_left)"),
        ("G(person-observed -> X stop)", "G(person_observed -> X stop)"),
        ("G(stop and turn left)", "G(stop & turn_left)"),
        ("G(p -> X release)", "G(p -> X release)"),
        ("alarm triggered -> X stop", "alarm_triggered -> X stop"),
        ("release release release", "release V release"),
        ("X GO and p", "(X GO) & p"),
    ],
)
def test_names_of_several_words(text, canonical):
    assert str(parse(text)) == canonical


@pytest.mark.parametrize(
    ("text", "canonical"),
    [
        ("altitude - 1 < 3", "altitude - 1 < 3"),
        ("altitude-1 < 3", "altitude - 1 < 3"),
        ("0 < speed() < 0.5", "0 < speed & speed < 0.5"),
        ("!0 < speed < 1", "!(0 < speed & speed < 1)"),
        ("speed < 0.5 m/s", "speed < 0.5"),
        ("speed < 0.5m/s", "speed < 0.5"),
        ("altitude < 10 m & p", "altitude < 10 & p"),
        ("a < 2 m/s^2", "a < 2"),
        ("(a + b) * 2 < c / 2", "(a + b) * 2 < c / 2"),
        ("a - (b - c) < 1", "a - (b - c) < 1"),
        ("(speed) < (0.5)", "speed < 0.5"),
    ],
)
def test_numbers(text, canonical):
    assert str(parse(text)) == canonical


# --------------------------------------------------------------------------------- warnings


@pytest.mark.parametrize(
    ("text", "reading", "meant"),
    [
        (
            "F !p & !q -> F !stop",
            "((F !p) & !q) -> (F !stop)",
            "F(!p & !q) -> F !stop",
        ),
        ("F p & q & r", "((F p) & q) & r", "F(p & q & r)"),
        ("F o -> l | r", "(F o) -> (l | r)", "F o -> F(l | r)"),
        ("G p -> X q", "(G p) -> (X q)", "G(p -> X q)"),
        ("G p & q -> X r", "((G p) & q) -> (X r)", "G(p & q -> X r)"),
        ("G(a -> X b | c)", "G(a -> ((X b) | c))", "G(a -> X(b | c))"),
        ("a & F b & c", "(a & (F b)) & c", "a & F(b & c)"),
        ("!F p & q", "(!(F p)) & q", "!F(p & q)"),
        ("G F p | q", "(G(F p)) | q", "G F(p | q)"),
        ("a U b U c", "(a U b) U c", "a U (b U c)"),
        ("a -> b <-> c", "a -> (b <-> c)", "(a -> b) <-> c"),
    ],
)
def test_misleading_formulas_are_warned_about(text, reading, meant):
    (warning,) = parse_with_warnings(text).warnings
    assert f'is read as "{reading}"' in warning
    assert f'if "{meant}" is meant' in warning
    assert parse_with_warnings(meant).warnings == ()


@pytest.mark.parametrize(
    "text",
    [
        *["G(a -> X b)", "F p -> F q", "G F p", "G F p -> G F q", "(F p) & q", "F(p) & q"],
        *[
            "F p & G q",
            "p & X q",
            "!a | b -> X c",
            "G p -> F q",
            "G(X a -> b)",
            "a U b",
            "a -> b -> c",
        ],
    ],
)
def test_plain_formulas_are_not(text):
    assert parse_with_warnings(text).warnings == ()


def test_other_warnings():
    (hyphen,) = parse_with_warnings("speed-limit < 3").warnings
    assert 'single name "speed_limit"' in hyphen
    (unit,) = parse_with_warnings("heading < 90 deg").warnings
    assert "not converted" in unit


def test_the_parsed_formula_keeps_the_text():
    parsed = parse_with_warnings(" G  p ;")
    assert parsed == ParsedFormula(parse("G p"), " G  p ;", ())


# ----------------------------------------------------------------------------------- errors


@pytest.mark.parametrize(
    ("text", "column", "parts"),
    [
        ("", 1, ["empty"]),
        ("  ", 1, ["empty"]),
        ("G(a &&& b)", 7, ['unexpected "&"', "follow one another"]),
        ("G(a & b", 2, ["never closed", 'matching ")"']),
        ("G((a) & b", 2, ["never closed"]),
        ("G a)", 4, ["closes no bracket"]),
        ("G(a]", 4, ['"]" does not close "("']),
        ("a -> ", 5, ["ends too early", "a proposition"]),
        ("G", 2, ["ends too early"]),
        ("G()", 3, ['unexpected ")"']),
        ("g(p)", 1, ["is a name here", "capital letters: G"]),
        ("f (p)", 1, ["is a name here", "capital letters: F"]),
        ("g people observed", 1, ["not an operator of LTL", "capital letters"]),
        ("if people observed then stop", 1, ["not an operator of LTL"]),
        ("AG p", 1, ["CTL", 'write "G"']),
        ("AG(p)", 1, ["CTL"]),
        ("turn_left(90)", 10, ["call with arguments"]),
        ("abs(v) < 1", 4, ["call with arguments", "-1 < x & x < 1"]),
        ("G(10)", 2, ["10 is a number"]),
        ("p & 1", 5, ["1 is a number"]),
        ("G(x + 1)", 2, ["this is a number"]),
        ("(a & b) < 1", 1, ["only numbers can be compared"]),
        ("x & x < 3", 5, ["both as true/false and as a number"]),
        ("speed < 10 km", 12, ["units are m, m/s"]),
        ("speed < 10km", 11, ["glued"]),
        ("a <> b", 3, ['write "!="']),
        ("G[0,10] p", 4, ["F[0,10] is not LTL"]),
        ("a @ b", 3, ["unknown character"]),
        ("speed < 1e999", 9, ["too large"]),
        (r"\foo p", 1, ["unknown LaTeX command"]),
        ("(a) b", 5, ["an operator is missing"]),
        ("G LTLSPEC", 3, ["is reserved"]),
        ("a\nb", 1, ['unexpected "b"']),
    ],
)
def test_errors_say_where_what_and_how(text, column, parts):
    with pytest.raises(FormulaError) as caught:
        parse(text)
    error = caught.value
    assert error.column == column
    *_, shown, caret = error.message.split("\n")
    assert caret.index("^") == column + 3
    assert shown[4:] in text
    for part in parts:
        assert part in str(error)
    assert "$END" not in str(error) and "LPAR" not in str(error)


def test_errors_name_the_file_and_the_line():
    with pytest.raises(FormulaError) as caught:
        parse("G(p ->\n  X & q)", source="drive/SKILL.md", line=12)
    assert caught.value.where == "drive/SKILL.md:13:5"
    assert str(caught.value).splitlines()[1:3] == ["      X & q)", "        ^"]


@pytest.mark.parametrize(
    "text",
    [
        "(" * 10_000 + "p" + ")" * 10_000,
        "!" * 60_000 + "p",
        "a & " * 10_000 + "a",
        "a -> " * 10_000 + "a",
        "x < " + "1 + " * 10_000 + "1",
        "p" * 100_000,
        "! (" * 20_000,
    ],
)
def test_huge_formulas_are_refused_quickly(text):
    started = time.monotonic()
    with pytest.raises(FormulaError, match=r"at most|never closed"):
        parse(text)
    assert time.monotonic() - started < 5


def test_formulas_may_be_nested_500_deep():
    formula = parse("!" * 500 + "p")
    assert parse(str(formula)) == formula


def test_long_formulas_parse_quickly():
    text = " & ".join(["G(people_observed & speed < 0.5 -> X !forward)"] * 110)
    assert len(text) > 5_000
    started = time.monotonic()
    parse(text)
    assert time.monotonic() - started < 2

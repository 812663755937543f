import pytest
from hypothesis import given
from hypothesis import strategies as st

from vaso.optimizers.adalflow_parts import TolerantParser

CODE = "if a < 1 && b:\n    stop()\n"


def proposal(reply):
    return TolerantParser().call(reply).proposed_variable


@pytest.mark.parametrize(
    "reply",
    [
        f"<response><reasoning>r</reasoning><method>m</method>"
        f"<proposed_variable>{CODE}</proposed_variable></response>",
        f"<response><proposed_variable><![CDATA[{CODE}]]></proposed_variable></response>",
        f"<response><proposed_variable>\n```python\n{CODE}```\n</proposed_variable></response>",
        "<response><proposed_variable>if a &lt; 1 &amp;&amp; b:\n    stop()</proposed_variable>"
        "</response>",
        f"Sure!\n<proposed_variable>{CODE}</proposed_variable> I hope it helps",
        f"<response><proposed_variable>{CODE}",
        f"<proposed_variable>{CODE}</response>",
    ],
)
def test_finds_the_proposal(reply):
    assert proposal(reply) == CODE.rstrip()


@pytest.mark.parametrize(
    "reply",
    [
        "",
        "no tags at all",
        "<response></response>",
        "<response><reasoning>x</reasoning></response>",
        "<response><proposed_variable>  \n </proposed_variable></response>",
        "<response><proposed_variable/></response>",
        "while True:\n    stop()",
    ],
)
def test_a_reply_without_a_proposal_is_none(reply):
    assert proposal(reply) is None


def test_keeps_relative_indentation_and_formulas():
    text = "<proposed_variable>\n    G(a -> X b)\n      & F(c < 1)\n</proposed_variable>"
    assert proposal(text) == "G(a -> X b)\n  & F(c < 1)"


@given(
    st.text(alphabet=st.sampled_from("<>/&![]`\n abCDATAresponseproposed_variable"), max_size=200)
)
def test_never_raises(reply):
    found = proposal(reply)
    assert found is None or found.strip()


@given(st.lists(st.sampled_from(["x < y", "a && b", "  z()", "if q:", "&lt;"]), min_size=1))
def test_code_survives(lines):
    code = "\n".join(["a < b & c", *lines])
    assert proposal(f"<response><proposed_variable>{code}</proposed_variable></response>") == code

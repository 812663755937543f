import stat
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smv_samples import BAD_SPECS, HARD, HARD_SPEC, LIGHT, UNSOUND, formulas, graphs

from vaso.errors import VerifierError
from vaso.ltl import parse, to_nusmv
from vaso.verifiers.engine import SMVEngine
from vaso.verifiers.nusmv_engine import NuSMVEngine
from vaso.verifiers.pynusmv_engine import PyNuSMVEngine

ENGINE = NuSMVEngine()
EASY = "G (n <= 2)"


def verdicts(answers):
    return [answer.holds for answer in answers]


def test_it_is_an_engine():
    assert isinstance(ENGINE, SMVEngine)
    assert ENGINE.check(LIGHT, []) == []


@pytest.mark.parametrize("per_spec", [False, True])
def test_verdicts_and_traces(per_spec):
    engine = NuSMVEngine(per_spec=per_spec)
    answers = engine.check(LIGHT, [EASY, "G F n = 1", "q", "F go"])
    assert verdicts(answers) == [True, False, None, False]
    trace = answers[3].trace
    assert {tuple(step.values) for step in trace.steps} == {("go", "n")}
    assert all(step.values["go"] == "FALSE" for step in trace.steps)


def test_traces_only_on_demand():
    (answer,) = ENGINE.check(LIGHT, ["F go"], traces=False)
    assert answer.holds is False
    assert answer.trace is None


def agree(graph, specs):
    texts = [to_nusmv(formula, names=str) for formula in specs]
    answers = ENGINE.check(graph.model, texts)
    assert verdicts(answers) == verdicts(PyNuSMVEngine().check(graph.model, texts, traces=False))
    for formula, answer in zip(specs, answers, strict=True):
        if not answer.holds:
            assert graph.is_violated_by(formula, answer.trace)


@settings(deadline=None, max_examples=100)
@given(graphs(), st.lists(formulas, min_size=1, max_size=4))
def test_the_two_engines_agree_and_traces_are_real(graph, specs):
    agree(graph, specs)


@pytest.mark.slow
@settings(deadline=None, max_examples=1000)
@given(graphs(), st.lists(formulas, min_size=1, max_size=8))
def test_the_two_engines_agree_for_long(graph, specs):
    agree(graph, specs)


def test_a_loop_that_only_the_hidden_variables_tell():
    # Every state looks like the last one, but p may fail only once: the loop is not at the start.
    model = "MODULE main\nVAR p : boolean; s : 0..1;\nASSIGN init(s) := 0; next(s) := {0, 1};\n"
    formula = parse("!(F (p & X (!p & X (p & X (!p & X G p)))))")
    (answer,) = ENGINE.check(model, [to_nusmv(formula, names=str)])
    loop = answer.trace.steps[answer.trace.loop_start :]
    assert all(step.values["p"] == "TRUE" for step in loop)
    assert len(answer.trace.steps) > len(loop)


@pytest.mark.parametrize(("model", "word"), UNSOUND)
def test_a_model_that_proves_everything_or_nothing(model, word):
    for answer in ENGINE.check(model, ["x", "TRUE"]):
        assert answer.holds is None
        assert word in answer.reason


@pytest.mark.parametrize("spec", [*BAD_SPECS, "go & " * 20_000 + "go"])
def test_a_bad_formula_is_undecided_and_harms_no_other(spec):
    answers = ENGINE.check(LIGHT, [EASY, spec, "F go"])
    assert verdicts(answers) == [True, None, False]
    assert answers[1].reason


@pytest.mark.parametrize("per_spec", [False, True])
def test_a_time_out_keeps_the_answers_so_far(per_spec):
    started = time.monotonic()
    answers = NuSMVEngine(per_spec=per_spec).check(HARD, ["G (p -> p)", HARD_SPEC], timeout=1)
    assert time.monotonic() - started < 3
    assert verdicts(answers) == [True, None]
    assert "time-out" in answers[1].reason


def test_strong_fairness_gets_verdicts_without_traces():
    fair, wrong = ENGINE.check(LIGHT + "COMPASSION (TRUE, go)\n", ["G F go", "G go"])
    assert verdicts([fair, wrong]) == [True, False]
    assert "COMPASSION" in wrong.reason


def fake_program(folder, script):
    path = folder / "NuSMV"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


@pytest.mark.parametrize(
    "script",
    [
        "exit 0",
        "exit 1",
        "cat > /dev/null",
        "kill -11 $$",
        "echo '-- specification G FALSE  is true'",
        "echo 'everything is true'",
        "sed -n 's/^echo //p'",  # our marks come back, but no verdict
        "sed -n 's/^echo //p; s/^check_fsm/No deadlock state exists/p'",
        r"sed -n 's/^echo //p; s/^check_ltlspec.*/-- specification x  is true/p'",
        r"sed -n 's/^echo //p; s/^check_ltlspec.*/-- specification x  is false/p'",
    ],
)
def test_output_that_is_not_a_verdict_is_never_a_pass(tmp_path, script):
    engine = NuSMVEngine(fake_program(tmp_path, script))
    for answer in engine.check(LIGHT, [EASY, "F go"], timeout=5):
        assert answer.holds is None
        assert answer.reason


def test_no_program(tmp_path, monkeypatch):
    with pytest.raises(VerifierError, match="no program"):
        NuSMVEngine(tmp_path / "NuSMV")
    monkeypatch.setattr("sys.executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(VerifierError, match="make setup"):
        NuSMVEngine()

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smv_samples import BAD_SPECS, HARD, HARD_SPEC, LIGHT, LONG, UNSOUND, formulas, graphs

from vaso.ltl import holds, to_nusmv
from vaso.verifiers import _pynusmv_pool
from vaso.verifiers.engine import SMVEngine
from vaso.verifiers.pynusmv_engine import PyNuSMVEngine

ENGINE = PyNuSMVEngine()
EASY = "G (n <= 2)"


def to_spec(formula):
    return to_nusmv(formula, names=str)


def verdicts(answers):
    return [answer.holds for answer in answers]


def test_it_is_an_engine():
    assert isinstance(ENGINE, SMVEngine)
    assert ENGINE.check(LIGHT, []) == []


def test_verdicts_and_traces():
    answers = ENGINE.check(LIGHT, [EASY, "G F n = 1", "F go"])
    assert verdicts(answers) == [True, False, False]
    assert answers[0].trace is None
    trace = answers[2].trace
    assert {tuple(step.values) for step in trace.steps} == {("go", "n")}
    assert all(step.values["go"] == "FALSE" for step in trace.steps)
    assert 0 <= trace.loop_start < len(trace.steps)


def test_traces_only_on_demand():
    (answer,) = ENGINE.check(LIGHT, ["F go"], traces=False)
    assert answer.holds is False
    assert answer.trace is None


@settings(deadline=None, max_examples=80)
@given(graphs(), st.lists(formulas, min_size=1, max_size=4))
def test_random_models_against_explicit_lassos(graph, specs):
    answers = ENGINE.check(graph.model, [to_spec(formula) for formula in specs])
    for formula, answer in zip(specs, answers, strict=True):
        if answer.holds:
            for path, start in graph.lassos(3):
                assert holds(formula, [graph.label(node) for node in path], start)
        else:
            assert answer.holds is False, answer.reason
            assert graph.is_violated_by(formula, answer.trace)


@pytest.mark.parametrize(("model", "word"), UNSOUND)
def test_a_model_that_proves_everything_or_nothing(model, word):
    for answer in ENGINE.check(model, ["x", "TRUE"]):
        assert answer.holds is None
        assert word in answer.reason


@pytest.mark.parametrize("spec", BAD_SPECS)
def test_a_bad_formula_is_undecided_and_harms_no_other(spec):
    answers = ENGINE.check(LIGHT, [EASY, spec, "F go", spec])
    assert verdicts(answers) == [True, None, False, None]
    assert answers[1].reason
    assert answers[2].trace


def test_line_breaks_in_a_formula():
    assert verdicts(ENGINE.check(LIGHT, ["G (n <= 2\n  & TRUE)"])) == [True]


def test_a_huge_formula():
    nested = "(" * 2000 + "go" + ")" * 2000
    broad = " & ".join(["(go | n = 1)"] * 5000)
    assert verdicts(ENGINE.check(LIGHT, [nested, broad])) == [False, False]


def test_strong_fairness_gets_verdicts_without_traces():
    model = LIGHT + "COMPASSION (TRUE, go)\n"
    fair, wrong = ENGINE.check(model, ["G F go", "G go"])
    assert fair.holds is True
    assert wrong.holds is False
    assert "COMPASSION" in wrong.reason


def test_weak_fairness_is_respected_by_traces():
    (answer,) = ENGINE.check(LIGHT + "JUSTICE go\n", ["G n = 0"])
    loop = answer.trace.steps[answer.trace.loop_start :]
    assert any(step.values["go"] == "TRUE" for step in loop)


def test_a_time_out_keeps_the_other_answers():
    started = time.monotonic()
    answers = ENGINE.check(HARD, ["G (p -> p)", HARD_SPEC, "G p", HARD_SPEC], timeout=3)
    assert time.monotonic() - started < 5
    assert verdicts(answers) == [True, None, False, None]
    assert "time-out" in answers[1].reason
    assert verdicts(ENGINE.check(LIGHT, [EASY])) == [True]


def test_a_time_out_during_a_trace_keeps_the_verdict():
    answers = ENGINE.check(LONG, ["F G n = 7", "TRUE"], timeout=12)
    assert verdicts(answers) == [False, True]
    assert answers[0].trace is None
    assert "no trace: time-out" in answers[0].reason


def test_a_time_out_while_loading():
    model = HARD + "TRANS next(a) * a = next(b) * b & a * b = 0ud18_131071;\n"
    started = time.monotonic()
    (answer,) = ENGINE.check(model, ["G p"], timeout=1)
    assert time.monotonic() - started < 3
    assert answer.holds is None
    assert "time-out" in answer.reason


def test_too_little_memory_is_no_verdict():
    started = time.monotonic()
    answer, _ = PyNuSMVEngine(memory_mb=16).check(HARD, [HARD_SPEC, "G p"])
    assert time.monotonic() - started < 5
    assert answer.holds is None
    assert answer.reason
    assert verdicts(ENGINE.check(LIGHT, [EASY])) == [True]


def exists(pid):
    return Path(f"/proc/{pid}").exists()


def busy_child():
    """Wait for the worker's child that is at work, and return worker and child."""
    deadline = time.monotonic() + 10
    while time.monotonic() < deadline:
        for worker in _pynusmv_pool.pool._all:
            for child in Path(f"/proc/{worker.pid}/task/{worker.pid}/children").read_text().split():
                return worker.pid, int(child)
        time.sleep(0.02)
    raise AssertionError("no check is running")


@pytest.mark.parametrize("victim", ["worker", "child"])
def test_a_killed_process_costs_one_formula(victim):
    ENGINE.check(LIGHT, [EASY])
    result = []
    thread = threading.Thread(
        target=lambda: result.extend(ENGINE.check(HARD, [HARD_SPEC, "G p"], timeout=20))
    )
    thread.start()
    time.sleep(0.3)
    worker, child = busy_child()
    os.kill(worker if victim == "worker" else child, signal.SIGKILL)
    thread.join(10)
    assert verdicts(result) == [None, False]
    assert "SIGKILL" in result[0].reason or "-9" in result[0].reason
    deadline = time.monotonic() + 5
    while exists(child) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not exists(child)


def test_threads_share_the_workers():
    engine = PyNuSMVEngine(workers=2)
    with ThreadPoolExecutor(6) as threads:
        jobs = [threads.submit(engine.check, LIGHT, [EASY, "F go"]) for _ in range(24)]
        assert all(verdicts(job.result()) == [True, False] for job in jobs)
    assert len(_pynusmv_pool.pool._all) <= _pynusmv_pool.pool.capacity


def test_no_free_worker_is_a_time_out(monkeypatch):
    monkeypatch.setattr(_pynusmv_pool, "pool", _pynusmv_pool.WorkerPool())
    slow = threading.Thread(target=ENGINE.check, args=(HARD, [HARD_SPEC]), kwargs={"timeout": 4})
    slow.start()
    time.sleep(1.5)
    (answer,) = ENGINE.check(LIGHT, [EASY], timeout=0.3)
    slow.join()
    assert answer.holds is None
    assert "no worker" in answer.reason
    _pynusmv_pool.pool.close()


def test_a_forked_process_has_its_own_workers():
    ENGINE.check(LIGHT, [EASY])
    child = os.fork()
    if child == 0:
        good = not _pynusmv_pool.pool._all and verdicts(ENGINE.check(LIGHT, [EASY])) == [True]
        _pynusmv_pool.pool.close()
        os._exit(0 if good else 1)
    assert os.waitpid(child, 0)[1] == 0
    assert verdicts(ENGINE.check(LIGHT, [EASY])) == [True]


def test_no_process_outlives_the_program():
    script = (
        "from vaso.verifiers.pynusmv_engine import PyNuSMVEngine\n"
        "from vaso.verifiers import _pynusmv_pool\n"
        "PyNuSMVEngine().check('MODULE main VAR x : boolean;', ['G x'])\n"
        "print(_pynusmv_pool.pool._all[0].pid)\n"
    )
    out = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert out.stderr == ""
    assert not exists(int(out.stdout))


def test_nothing_is_printed(capfd):
    ENGINE.check(LIGHT, [EASY, "F go", "q"])
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_memory_does_not_grow():
    def worker_memory():
        pages = [Path(f"/proc/{w.pid}/statm").read_text() for w in _pynusmv_pool.pool._all]
        return sum(int(text.split()[1]) * 4096 for text in pages)

    ENGINE.check(LIGHT, [EASY, "F go"])
    before = worker_memory()
    for _ in range(1000):
        ENGINE.check(LIGHT, [EASY, "F go"])
    assert worker_memory() < before + 5_000_000


def child_of_the_worker():
    (worker,) = _pynusmv_pool.pool._idle[-1:]
    (child,) = Path(f"/proc/{worker.pid}/task/{worker.pid}/children").read_text().split()
    return int(child)


def test_one_model_leaves_nothing_for_the_next():
    """The same names mean something else in each model; one child answers them all."""
    flags = "MODULE main VAR go : boolean; n : boolean; ASSIGN init(go) := TRUE; next(go) := go;\n"
    numbers = "MODULE main VAR go : 0..3; m : boolean; DEFINE n := go = 2; ASSIGN init(go) := 0;\n"
    expected = {LIGHT: [True, False], flags: [True, False], numbers: [False, False]}
    specs = {
        LIGHT: [EASY, "F go"],
        flags: ["G go", "G n"],
        numbers: ["F n", "G m"],
    }
    ENGINE.check(LIGHT, [EASY])
    child = child_of_the_worker()
    for model in [LIGHT, flags, numbers, flags, LIGHT, numbers] * 3:
        answers = ENGINE.check(model, specs[model], traces=False)
        assert verdicts(answers) == expected[model]
    assert child_of_the_worker() == child


def test_a_child_is_replaced_after_some_models_and_after_an_error():
    ENGINE.check(LIGHT, [EASY])
    child = child_of_the_worker()
    for _ in range(200):
        assert verdicts(ENGINE.check(LIGHT, [EASY, "F go"], traces=False)) == [True, False]
    fresh = child_of_the_worker()
    assert fresh != child
    assert verdicts(ENGINE.check(LIGHT, ["(", "G q", EASY])) == [None, None, True]
    assert child_of_the_worker() != fresh


def test_a_child_that_dies_between_two_requests_costs_nothing():
    ENGINE.check(LIGHT, [EASY])
    child = child_of_the_worker()
    os.kill(child, signal.SIGKILL)
    while "Z" not in Path(f"/proc/{child}/stat").read_text().split()[2]:
        time.sleep(0.01)
    assert verdicts(ENGINE.check(LIGHT, [EASY, "F go"])) == [True, False]

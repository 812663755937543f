"""The benchmark compares like with like: same systems, same formulas, same verdicts."""

from vaso.bench.machine import describe_machine
from vaso.bench.verify import BASELINE, measure, workloads


def test_engines_agree_on_the_workloads_and_ratios_refer_to_the_baseline():
    reactive, _, hundred, _ = workloads()
    assert len(hundred.system.states) > 100
    for load in (reactive, hundred):
        rows = measure(load, repeats=1)
        decided = [r for r in rows if r.seconds is not None]
        assert rows[0].engine == BASELINE and rows[0].ratio == 1.0
        assert len(decided) >= 3
        assert {r.verdicts for r in decided} == {rows[0].verdicts}
        assert set(rows[0].verdicts) == {"pass"}
    assert all(r.seconds is not None for r in rows), "the lasso evaluator covers trajectories"


def test_the_machine_is_named():
    assert "cores" in describe_machine() and "Python" in describe_machine()

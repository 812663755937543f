import pytest
from rich.console import Console

from vaso.comparison import Comparison, Row

BIG = {
    "safety_before": 0.75,
    "safety": 0.875,
    "completion": 0.912,
    "steps": 10,
    "accepted": 3,
    "loss_calls": 123,
    "memo_hits": 7,
    "lm_calls": 456,
    "tokens": 1_234_567,
    "cost": 12.3456,
    "seconds": 1234.5,
    "safety_unseen": 0.6667,
    "stop_reason": "the budget of 10 steps is spent",
}


@pytest.fixture(scope="module")
def crowded(found):
    """Many optimizers, large numbers, long names and messages."""
    names = ["repair", "adalflow", "adalflow-trainer", "a name that is far too long for a table"]
    rows = [
        Row(skill="drive", optimizer=name, seed=seed, **{**BIG, "tokens": 10 ** (4 + seed)})
        for name in names
        for seed in range(3)
    ]
    rows.append(Row(skill="drive", optimizer="gepa", seed=0, error="no answer " * 30, workers=2))
    return found.model_copy(
        update={"rows": tuple(rows), "runs": tuple(("x", n) for n in range(20))}
    )


def test_the_table_says_what_matters(found):
    lines = str(found).splitlines()
    assert lines[0] == "drive: 1 task, 5 unseen, safety 75% at the start"
    (repair,) = [line.split() for line in lines if line.startswith("repair ")]
    assert repair[:7] == ["repair", "✓", "2/2", "100%", "100%", "100%", "1"]
    deviations = lines[[line.split()[:1] for line in lines].index(["repair"]) + 1].split()
    assert deviations[:3] == ["±0%", "±0%", "±0%"]
    text = " ".join(str(found).split())
    assert "gives up, seeds 0, 1: not verified: gives-up has nothing more to propose" in text
    assert "fails, seeds 0, 1: ✗ failed: it failed 3 times" in text
    assert "mean ± standard deviation over 2 seeds" in text and "Python 3." in text
    assert "model" not in lines[1] and "tokens" not in str(found)  # no model was asked


@pytest.mark.parametrize("which", ["found", "crowded"])
def test_it_fits_80_columns_and_nothing_is_cut(which, request):
    comparison = request.getfixturevalue(which)
    lines = str(comparison).splitlines()
    assert max(map(len, lines)) <= 80
    assert not any("…" in line for line in lines)


def test_a_crowded_table_shows_every_column(crowded):
    text = " ".join(str(crowded).split())
    for part in ("tokens", "cost", "±0%", "$12.3", "1234", "370k", "interrupted"):
        assert part in text, part
    assert "2 runs at a time, so times do not compare" in text
    assert text.count("no answer") == 30


def test_one_seed_has_no_standard_deviations(found):
    rows = tuple(row for row in found.rows if row.seed == 0)
    text = str(found.model_copy(update={"rows": rows}))
    assert "±" not in text and "one seed" in text


def test_several_seeds_of_which_one_run_counts(found):
    rows = [row.model_copy(update={"error": "no answer"}) for row in found.rows[1:2]]
    text = str(found.model_copy(update={"rows": (found.rows[0], *rows)}))
    assert "±–" in text and "✗ 1/2" in text


def test_nothing_yet(found):
    empty = found.model_copy(update={"rows": ()})
    assert "interrupted: 0 of 6 runs" in str(empty)
    assert "0 of 6 runs" in empty._repr_html_() and empty.svg()
    assert not empty and empty.summary() == {} and empty.to_csv().count("\n") == 1


def test_it_prints_itself(found, capsys):
    Console().print(found)
    assert "repair" in capsys.readouterr().out
    assert repr(found) == "Comparison('drive', repair, gives up, fails, 6 runs)"


def test_it_is_true_only_if_all_is_verified(found):
    good = found.rows[:2]
    assert found.model_copy(update={"rows": good, "runs": found.runs[:2]})
    assert not found.model_copy(update={"rows": good, "runs": found.runs[:3]})
    assert isinstance(found, Comparison) and not found

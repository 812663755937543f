"""What an optimizer has verified is known to the next run."""

from pathlib import Path

from vaso import load_skill
from vaso.comparison import compare
from vaso.modules.symbolic import SymbolicPlanner
from vaso.optimizers import Case, Parameters, SkillLoss

DRIVE = load_skill("drive", version="initial")


def kept(folder: Path) -> int:
    return len(list(folder.rglob("*.memo")))


def test_a_second_loss_gets_the_same_from_the_memo(tmp_path, monkeypatch):
    monkeypatch.setenv("VASO_CACHE", str(tmp_path))
    monkeypatch.setattr("vaso.memo.keys.code_digest", lambda: "the code")
    case = Case("Move forward for 5 meters.")
    values = [SkillLoss(DRIVE, SymbolicPlanner())(Parameters(DRIVE), case) for _ in range(2)]
    assert [v.result.from_memo for v in values] == [False, True]
    assert values[0].score == values[1].score < 1
    assert values[0].completion == values[1].completion
    assert str(values[0].gradient) == str(values[1].gradient)
    assert values[0].result == values[1].result


def test_a_comparison_measures_and_keeps_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("VASO_CACHE", str(tmp_path))
    monkeypatch.setattr("vaso.memo.keys.code_digest", lambda: "the code")
    assert compare("drive", optimizers=["repair"], tasks=["go ahead"], unseen=False)
    assert kept(tmp_path) == 0

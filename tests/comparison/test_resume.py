import json
from pathlib import Path

import pytest
from compared import GOOD, TASKS, Scripted
from comparison_model import Model
from openai_server import Status

from vaso.comparison import Comparison, compare
from vaso.errors import OptimizerError, VasoError

CLUMSY = "while True:\n    forward()\n"


def comparable(found):
    return [row.model_dump(exclude={"seconds"}) for row in found.rows]


def options(**more):
    return {"tasks": TASKS, "unseen": False, **more}


def test_finished_runs_are_not_made_again_and_others_are(tmp_path):
    calls = []

    class Counting(Scripted):
        def propose(self, state):
            calls.append(state.seed)
            yield from super().propose(state)

    good = Counting([GOOD])
    first = compare("drive", optimizers=[good], out=tmp_path, **options())
    assert calls == [0] and first
    calls.clear()
    more = {"scripted": good, "other": Scripted([CLUMSY, GOOD])}
    again = compare("drive", optimizers=more, seeds=2, out=tmp_path, resume=True, **options())
    assert calls == [1]
    assert again.rows[:1] == first.rows and len(again.rows) == again.planned == 4 and again
    assert Comparison.read(tmp_path) == again


def test_an_interrupted_run_goes_on_where_it_was(tmp_path):
    script = [CLUMSY, CLUMSY, GOOD]
    whole = compare("drive", optimizers=[Scripted(script)], **options())
    stopped = compare(
        "drive",
        optimizers=[Scripted([CLUMSY, "interrupt"])],
        seeds=2,
        out=tmp_path,
        **options(),
    )
    assert stopped.interrupted and [row.steps for row in stopped.rows] == [1]
    assert Comparison.read(tmp_path).interrupted
    resumed = compare(
        "drive",
        optimizers=[Scripted([CLUMSY, GOOD])],
        seeds=1,
        out=tmp_path,
        resume=True,
        **options(),
    )
    assert resumed and resumed.rows[0].steps == whole.rows[0].steps == 3
    assert resumed.rows[0].curve == whole.rows[0].curve


def test_what_a_model_answered_is_not_asked_again(server, tmp_path):
    """The third request fails for good: the run is resumed and asks from there on."""
    model = Model(wrong=3)
    server.script = [model, model, Status(401, "no key")]
    server.default = model
    more = options(lm=server.lm(), optimizers="loop", out=tmp_path)
    failed = compare("drive", **more)
    assert "no key" in failed.rows[0].error and len(server.requests) == 3
    resumed = compare("drive", resume=True, **more)
    assert resumed.rows[0].verified and resumed.rows[0].error == ""
    assert len(server.requests) == 3 + 2  # one more that is wrong, then the good one
    prompts = server.prompts
    assert len(set(prompts[:2] + prompts[3:])) == 4


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"budget": 3}, "budget"),
        ({"tasks": ["go back"]}, "seen"),
        ({"lm": "edits"}, "model"),
        ({"level": "trace"}, "level"),
        ({"trainable": ["plan_template"]}, "trainable"),
    ],
)
def test_a_folder_of_another_comparison(found, change, named):
    folder = Path(found.out)
    before = (folder / "comparison.json").read_bytes()
    same = {"tasks": TASKS, "budget": 4}
    with pytest.raises(OptimizerError, match=named) as caught:
        compare("drive", optimizers="repair", out=folder, resume=True, **{**same, **change})
    assert "another comparison" in str(caught.value)
    assert (folder / "comparison.json").read_bytes() == before


def test_a_damaged_file(tmp_path):
    (tmp_path / "comparison.json").write_text(json.dumps({"rows": 3}))
    with pytest.raises(VasoError, match="cannot be read"):
        compare("drive", optimizers="repair", out=tmp_path, resume=True, **options())


def test_a_folder_that_cannot_be_written(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OptimizerError, match="cannot be written"):
        compare("drive", optimizers="repair", out=tmp_path / "file", **options())


def test_a_disk_that_fills_up_does_not_end_the_comparison(tmp_path, monkeypatch):
    from vaso.comparison import folder

    def full(self, comparison, write=folder.Folder.write):
        if comparison.rows:
            raise OptimizerError("the output folder cannot be written: no space left")
        write(self, comparison)

    monkeypatch.setattr(folder.Folder, "write", full)
    found = compare("drive", optimizers=[Scripted([GOOD])], out=tmp_path, **options())
    assert found and "no space left" in found.problem and "no space left" in str(found)


def test_what_an_earlier_comparison_left_is_not_gone_on_from(tmp_path):
    """A run that was killed before it began has the folder of a run with another budget."""
    clumsy = {"a": Scripted([CLUMSY]), "b": Scripted([CLUMSY])}
    compare("drive", optimizers=clumsy, out=tmp_path, **options(budget=1))
    stopped = {"a": Scripted(["interrupt"]), "b": Scripted([GOOD])}
    compare("drive", optimizers=stopped, out=tmp_path, **options(budget=3))
    good = {"a": Scripted([GOOD]), "b": Scripted([GOOD])}
    found = compare("drive", optimizers=good, out=tmp_path, resume=True, **options(budget=3))
    assert found and [row.steps for row in found.rows] == [1, 1]

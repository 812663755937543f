from openai_server import OpenAIServer, Status


def test_the_plan_is_all_that_is_printed(vaso):
    found = vaso("plan", "drive", "Move forward 5 meters, then turn left by 90 degrees.")
    assert found.code == 0
    compile(found.out, "plan", "exec")
    assert "legs = [(5.0, 90.0)]" in found.out


def test_json(vaso):
    found = vaso("plan", "find-object", "Find a backpack near the hallway.", "--json").json
    assert found["planner"] == "symbolic"
    assert 'TARGET = "backpack"' in found["plan"]


def test_what_the_plan_has_nothing_of_is_said(vaso):
    found = vaso("plan", "drive", "fly to the moon")
    assert found.code == 0
    compile(found.out, "plan", "exec")
    assert 'not used of the task: "fly to the moon"' in found.err
    assert "legs = [(3.0, 0.0)]" in found.err


def test_a_task_that_is_used_whole_needs_no_word(vaso):
    assert vaso("plan", "drive", "Go 2 meters, then turn right.").err == ""


def test_places(vaso):
    found = vaso("plan", "drive", "Go to the kitchen door", "--place", "kitchen door=3.5", "--json")
    assert "legs = [(3.5, 0.0)]" in found.json["plan"]
    assert found.json["unused"] == []
    wrong = vaso("plan", "drive", "Go to the door", "--place", "door")
    assert wrong.code == 2 and "doorway=4" in wrong.err


def test_out(vaso, tmp_path):
    path = tmp_path / "sub" / "plan.py"
    found = vaso("plan", "drive", "go 2 meters", "--out", path)
    assert (found.code, found.out) == (0, "")
    assert "legs = [(2.0, 0.0)]" in path.read_text()


def test_out_that_cannot_be_written(vaso, tmp_path):
    (tmp_path / "file").write_text("")
    found = vaso("plan", "drive", "go", "--out", tmp_path / "file" / "plan.py")
    assert found.code == 2
    assert "cannot be written" in found.err


def test_a_model_writes_the_plan(vaso, monkeypatch, no_cache):
    reply = "[[ ## plan ## ]]\nwhile True:\n    stop()\n\n[[ ## completed ## ]]"
    with OpenAIServer([reply]) as server:
        monkeypatch.setenv("VASO_API_BASE", server.url)
        found = vaso("plan", "drive", "wait here", "--lm", "openai/test")
    assert (found.code, found.out) == (0, "while True:\n    stop()\n")
    assert "wait here" in server.prompts[0]


def test_a_model_that_refuses(vaso, monkeypatch, no_cache):
    with OpenAIServer(default=Status(401)) as server:
        monkeypatch.setenv("VASO_API_BASE", server.url)
        found = vaso("plan", "drive", "go", "--lm", "openai/none")
    assert found.code == 2
    assert "does not answer" in found.err

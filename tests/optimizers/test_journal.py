import threading

import pytest

from vaso.errors import OptimizerError
from vaso.optimizers.journal import Answer, Journal, request_key
from vaso.optimizers.once import Once


def answer(key, text):
    return Answer(key=key, outputs=[text], usage={"prompt_tokens": 3}, cost=0.01)


def test_answers_are_served_in_order_and_once(tmp_path):
    path = tmp_path / "answers.jsonl"
    journal = Journal(path)
    for key, text in [("a", "1"), ("b", "2"), ("a", "3")]:
        journal.add(answer(key, text))
    assert journal.find("a") is None, "a run does not answer itself"
    again = Journal(path, resume=True)
    assert [again.find("a").outputs, again.find("a").outputs, again.find("a")] == [
        ["1"],
        ["3"],
        None,
    ]
    assert again.find("b") == answer("b", "2")


def test_what_led_to_the_checkpoint_is_skipped(tmp_path):
    path = tmp_path / "answers.jsonl"
    journal = Journal(path)
    for text in "123":
        journal.add(answer("a", text))
    again = Journal(path, resume=True)
    again.skip(2)
    assert again.find("a").outputs == ["3"] and again.find("a") is None
    again.add(answer("a", "4"))
    assert len(again) == 4


def test_a_new_run_starts_empty(tmp_path):
    path = tmp_path / "answers.jsonl"
    Journal(path).add(answer("a", "1"))
    assert len(Journal(path)) == 0 and path.read_text() == ""


@pytest.mark.parametrize("torn", ['{"key": "b", "outp', "\x00\x00", "{}\n[]\n"])
def test_a_line_that_was_torn_by_a_kill_is_ignored(tmp_path, torn):
    path = tmp_path / "answers.jsonl"
    Journal(path).add(answer("a", "1"))
    with path.open("a") as file:
        file.write(torn)
    again = Journal(path, resume=True)
    again.add(answer("c", "3"))
    last = Journal(path, resume=True)
    assert len(last) == 2 and last.find("c").outputs == ["3"] and last.find("a") is not None


def test_odd_answers_are_not_worth_the_run(tmp_path):
    journal = Journal(tmp_path / "answers.jsonl")
    journal.add(Answer(key="a", outputs=["lone surrogate \ud800"]))
    journal.add(Answer(key="a", outputs=[{"text": "x", "tool_calls": [{"id": 1}]}]))
    journal.path.unlink()
    journal.path.mkdir()
    journal.add(answer("a", "on a disk that is gone"))
    assert len(journal) <= 2


def test_a_journal_that_cannot_be_written(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OptimizerError, match="journal"):
        Journal(tmp_path / "file" / "answers.jsonl")


def test_keys_differ_where_answers_may():
    base = request_key("m", "hi", None, {"temperature": 0.0})
    assert base == request_key("m", "hi", None, {"temperature": 0.0, "api_key": "x", "n": None})
    others = [
        request_key("n", "hi", None, {"temperature": 0.0}),
        request_key("m", "ho", None, {"temperature": 0.0}),
        request_key("m", "hi", None, {"temperature": 0.1}),
        request_key("m", "hi", None, {"temperature": 0.0, "rollout_id": 1}),
        request_key("m", None, [{"role": "user", "content": "hi"}], {"temperature": 0.0}),
    ]
    assert len({base, *others}) == 6


# -- Once -----------------------------------------------------------------------------------------


def test_a_value_is_made_once_however_many_threads_ask():
    once, made, gate = Once(), [], threading.Barrier(8)

    def make():
        made.append(1)
        return len(made)

    def ask():
        gate.wait()
        return once.get("key", make)

    threads = [threading.Thread(target=ask) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert made == [1] and "key" in once and once.get("key", make) == 1


def test_what_raises_is_tried_again():
    once = Once()
    with pytest.raises(ZeroDivisionError):
        once.get("key", lambda: 1 / 0)
    assert "key" not in once and once.get("key", lambda: 5) == 5

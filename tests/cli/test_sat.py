import io
import subprocess
import sys

import pytest


def test_one_json_line_a_formula(vaso):
    found = vaso("sat", "--json", "G(a -> X b)", "F a & G !a")
    assert [(o["formula"], o["sat"]) for o in found.lines] == [
        ("G(a -> X b)", True),
        ("F a & G !a", False),
    ]
    assert all(set(o) == {"formula", "sat", "seconds"} for o in found.lines)
    assert all(isinstance(o["seconds"], float) for o in found.lines)
    assert found.code == 1
    assert found.err == ""


def test_satisfiable_formulas_exit_0(vaso):
    assert vaso("sat", "--json", "F p", "G(speed < 0.5)").code == 0


def test_a_malformed_formula_is_a_line_and_the_others_are_answered(vaso):
    found = vaso("sat", "--json", "F p", "G(", "p & !p", "a U")
    assert [o["sat"] for o in found.lines] == [True, None, False, None]
    assert [("error" in o) for o in found.lines] == [False, True, False, True]
    assert "never closed" in found.lines[1]["error"]
    assert found.code == 2


def test_file_skips_blank_lines_and_comments(vaso, tmp_path):
    file = tmp_path / "formulas"
    file.write_bytes(b"# two formulas\n\nF p\n  G !p  \r\n\xff\n")
    found = vaso("sat", "--json", "--file", file)
    assert [o["formula"] for o in found.lines] == ["F p", "G !p", "\ufffd"]
    assert found.code == 2


def test_missing_file_and_nothing_to_do(vaso, tmp_path):
    missing = vaso("sat", "--file", tmp_path / "none")
    assert missing.code == 2 and "cannot be read" in missing.err
    assert vaso("sat").code == 2


@pytest.mark.parametrize("options", [[], ["--together"]])
def test_a_file_without_formulas_holds_nothing(vaso, tmp_path, options):
    file = tmp_path / "empty.ltl"
    file.write_text("# nothing yet\n")
    found = vaso("sat", "--file", file, *options)
    assert found.code == 2 and "no formula" in found.err


def test_standard_input(vaso, monkeypatch):
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"F p\np & !p\n")))
    assert [o["sat"] for o in vaso("sat", "--json", "--file", "-").lines] == [True, False]


def test_answers_come_while_standard_input_is_open():
    command = [
        sys.executable,
        "-c",
        "from vaso.cli import main; main()",
        "sat",
        "--json",
        "--file",
        "-",
    ]
    with subprocess.Popen(command, stdin=-1, stdout=-1, text=True) as process:
        process.stdin.write("F p\n")
        process.stdin.flush()
        assert '"sat": true' in process.stdout.readline()
        process.stdin.close()
        assert process.wait(30) == 0


def test_the_core_of_an_unsatisfiable_formula(vaso):
    found = vaso("sat", "--json", "--core", "F a & G !a & G b")
    assert sorted(found.lines[0]["core"]) == ["F a", "G !a"]
    text = vaso("sat", "F a & G !a & G b")
    assert "UNSAT" in text.out and "in conflict: F a G !a" in text.words


def test_together(vaso):
    assert vaso("sat", "F a", "G !a").code == 0
    found = vaso("sat", "--together", "--json", "--core", "F a", "G !a", "G b")
    assert len(found.lines) == 1
    assert found.lines[0]["sat"] is False
    assert found.lines[0]["core"] == ["F a", "G !a"]


def test_a_time_limit_of_zero_is_not_an_answer(vaso):
    found = vaso("sat", "--json", "--timeout", "0", "G(a -> X b)")
    assert found.lines[0]["sat"] is None
    assert found.code == 3


@pytest.mark.parametrize("formula", ["(" * 5000, "!" * 100_000 + "p", "", "\0", "p" * 10_000])
def test_strange_formulas_never_give_a_traceback(vaso, formula):
    found = vaso("sat", "--json", formula)
    assert found.code in (0, 2, 3)
    assert len(found.lines) == 1
    assert "Traceback" not in found.err


def test_formulas_of_benchmark_collections_are_read(vaso, tmp_path):
    published = "( G  (((p) =>  ( X  ( ~  (q)))) & ( ~  (( ~  ( False )) U  (r)))))"
    until = "(" * 1_500 + "p0" + "".join(f" U p{i})" for i in range(1_500))
    file = tmp_path / "formulas"
    file.write_text(f"{published}\n{until}\n{'X ' * 3_000} (p & !p)\n")
    found = vaso("sat", "--json", "--file", file)
    assert [o["sat"] for o in found.lines] == [True, True, False]


def test_a_set_of_rules_that_no_model_checker_likes(vaso):
    links = [f"F G(a{i} <-> a{i + 1})" for i in range(30)]
    found = vaso("sat", "--json", "--together", "--core", "F G(a30 <-> !a0)", "G F b", *links)
    assert found.lines[0]["sat"] is False
    assert len(found.lines[0]["core"]) == 31

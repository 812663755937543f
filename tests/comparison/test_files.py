import csv
import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from compared import TASKS
from html_check import check

from vaso.comparison import COLUMNS, Comparison
from vaso.errors import VasoError
from vaso.skill_file import load_skill

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def out(found):
    return Path(found.out)


def test_a_folder_for_each_run_and_the_files_of_the_comparison(found, out):
    files = {p.name for p in out.iterdir()}
    assert files == {
        "comparison.json",
        "comparison.csv",
        "comparison.svg",
        "report.html",
        *(f"{name}-{seed}" for name in ("repair", "gives-up", "fails") for seed in (0, 1)),
    }
    assert {row.folder for row in found.rows} == {f for f in files if "." not in f}
    for row in found.rows:
        assert "VASO optimization of drive" in (out / row.folder / "report.html").read_text()
    skill = load_skill(out / "repair-0" / "SKILL.md")
    assert skill.plan_template == found.rows[0].texts["plan_template"]


def test_csv_reads_back(found, out):
    assert (out / "comparison.csv").read_text() == found.to_csv()
    rows = list(csv.DictReader(found.to_csv().splitlines()))
    assert list(rows[0]) == list(COLUMNS) and len(rows) == 6
    assert [(r["optimizer"], int(r["seed"])) for r in rows] == [
        (r.optimizer, r.seed) for r in found.rows
    ]
    for text, row in zip(rows, found.rows, strict=True):
        assert text["verified"] == str(row.verified).lower()
        assert float(text["safety"]) == row.safety
        assert float(text["seconds"]) == row.seconds
        assert int(text["loss_calls"]) == row.loss_calls
        assert text["error"] == row.error and text["machine"] == row.machine
    assert rows[4]["safety_unseen"] == rows[4]["verified_unseen"] == ""


def test_json_reads_back_and_says_on_what_it_was_measured(found, out):
    text = (out / "comparison.json").read_text()
    data = json.loads(text)
    assert data == json.loads(json.dumps(found.to_json()))
    assert Comparison.read(out) == Comparison.read(out / "comparison.json") == found
    assert data["setup"]["seen"] == TASKS and data["setup"]["budget"]["steps"] == 4
    machine = data["machine"]
    assert machine["cores"] >= 1 and machine["python"].startswith("3.")
    assert machine["packages"]["dspy"] and machine["started"].endswith("+00:00")
    assert data["columns"]["loss_calls"] == COLUMNS["loss_calls"].meaning
    assert data["summary"]["repair"]["verified"] == 2
    assert data["summary"]["repair"]["statistics"]["safety"] == {"mean": 1.0, "sd": 0.0, "n": 2}


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"setup": 7}', "\x00"])
def test_a_file_that_is_no_comparison(tmp_path, text):
    (tmp_path / "comparison.json").write_text(text)
    with pytest.raises(VasoError, match="cannot be read"):
        Comparison.read(tmp_path)
    with pytest.raises(VasoError):
        Comparison.read(tmp_path / "none")


def test_the_plot_has_a_line_for_each_optimizer_that_has_come_to_an_end(found, out):
    root = ElementTree.fromstring((out / "comparison.svg").read_text())
    texts = [t.text for t in root.iter(f"{SVG}text")]
    assert "repair" in texts and "gives up" in texts and "fails" not in texts
    assert "loss calls" in texts and "drive" in root.find(f"{SVG}title").text
    assert "repair: from 75% to 100% in 2 loss calls" in root.find(f"{SVG}desc").text


def test_the_report_is_one_file_that_links_to_those_of_the_runs(found, out):
    page = (out / "report.html").read_text()
    checked = check(page)
    for text in (
        "repair",
        "gives up",
        "the optimizer broke",
        "2 of 2",
        "0 of 2",
        "+        stop()",
    ):
        assert text.replace("+        ", "") in checked.text
    assert "<script" not in page and "http://" not in page.replace("http://www.w3.org/2000/svg", "")
    for row in found.rows:
        assert f'href="{row.folder}/report.html"' in page
    assert found.machine.description in page and "dspy 3." in page
    assert all(column.meaning in checked.text for column in COLUMNS.values())


def test_the_report_can_be_read_in_a_browser(out, open_page):
    opened = open_page(out / "report.html")
    opened.unfold()
    for width, scheme in ((400, "light"), (1400, "dark")):
        opened.look_like(width, scheme)
        assert opened.flaws() == {}, (width, scheme)
        assert opened.is_shown(".vaso-plot") and opened.is_shown("table.numbers")
    assert opened.messages == [] and opened.requests == []
    opened.page.get_by_role("link", name="repair").first.click()
    opened.page.wait_for_url("**/repair-0/report.html")


def test_in_a_notebook_there_are_no_links_into_the_folder(found):
    html = found._repr_html_()
    assert "href=" not in html and "2 of 2" in html and not html.startswith("<!DOCTYPE")
    check(html)


def test_names_are_escaped(found):
    row = found.rows[0].model_copy(update={"optimizer": "<b>", "error": "<i>", "diff": "+<u>"})
    html = found.model_copy(update={"rows": (row,)})._repr_html_()
    assert not any(tag in html for tag in ("<b>", "<i>", "<u>"))

"""What docs/completion.md says is so."""

import re
from pathlib import Path

import pytest
import yaml
from pydantic import BaseModel

from vaso.simulation.tasks.flight import FlightClause
from vaso.simulation.tasks.things import ThingClause
from vaso.simulation.tasks.way import WayClause

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "completion.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.M | re.S)
BLOCKS = [(found[1], found[2]) for found in BLOCK.finditer(PAGE)]
CLAUSES = (*WayClause.__args__, *ThingClause.__args__, *FlightClause.__args__)


def test_the_example_prints_what_the_page_shows(capsys):
    [code] = [text for language, text in BLOCKS if language == "python"]
    [shown] = [text for language, text in BLOCKS if language == "text"]
    exec(compile(code, "docs/completion.md", "exec"), {"__name__": "docs"})
    assert capsys.readouterr().out == shown


def test_the_predicate_is_the_shipped_one():
    [text] = [text for language, text in BLOCKS if language == "yaml"]
    shipped = yaml.safe_load((ROOT / "vaso/skills/drive/completion.yaml").read_text("utf-8"))
    assert yaml.safe_load(text) == [shipped["tasks"][1]]


@pytest.mark.parametrize("clause", CLAUSES)
def test_every_clause_is_in_the_table(clause: type[BaseModel]):
    assert f"`{clause.model_fields['kind'].default}" in PAGE

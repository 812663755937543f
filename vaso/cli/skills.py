"""``vaso skills``: the shipped skill library."""

from __future__ import annotations

from vaso.cli.common import JsonOption, console, emit


def skills(as_json: JsonOption = False) -> None:
    """List the shipped skills."""
    from vaso.skill import shipped_skills
    from vaso.skill_file import load_skill

    found = [load_skill(name) for name in shipped_skills()]
    if as_json:
        emit(
            [
                {
                    "name": s.name,
                    "platform": s.platform,
                    "description": s.description,
                    "rules": [r.text for r in s.rules],
                }
                for s in found
            ]
        )
        return
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("skill", no_wrap=True)
    table.add_column("robot")
    table.add_column("rules", justify="right")
    table.add_column("what it does", overflow="fold")
    for skill in found:
        what = " ".join(skill.description.split()).split(". ")[0]
        table.add_row(skill.name, skill.platform, str(len(skill.rules)), what)
    console().print(table)

"""Skill files: reading and writing SKILL.md, the shipped library, task prompts."""

from vaso.skill_file.library import load_skill
from vaso.skill_file.reader import read_skills
from vaso.skill_file.tasks import Tasks, load_tasks
from vaso.skill_file.writer import save_skill, write_skill

__all__ = ["Tasks", "load_skill", "load_tasks", "read_skills", "save_skill", "write_skill"]

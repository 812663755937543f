"""The shipped skill library: one folder a skill, with its SKILL.md in it."""

"""Verifying a plan against a skill: compile, check every rule, explain what fails."""

from vaso.verification.verifying import verify

__all__ = ["verify"]

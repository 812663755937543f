"""Views for the terminal: a certificate that was written, and what a recheck found."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.text import Text

from vaso.certificates.result import Certification, Change, Recheck
from vaso.report.terminal import verification_view

__all__ = ["certification_view", "recheck_view"]


def certification_view(found: Certification) -> Group:
    """What was verified, and where the certificate is."""
    if found:
        told = Text("✓ CERTIFIED", "bold green").append(
            f"   {found.path}", style="default not bold"
        )
    else:
        told = Text("✗ NOT CERTIFIED", "bold red").append(
            f"   {found.refusal}", style="default not bold"
        )
    return Group(verification_view(found.result), told)


def recheck_view(found: Recheck) -> Group:
    """What changed since the certificate was made, and what verifies now."""
    parts: list[RenderableType] = [verification_view(found.result), _head(found)]
    parts += [_line("✗ ", "bold red", change) for change in found.changes]
    parts += [_line("· ", "yellow", remark) for remark in found.remarks]
    return Group(*parts)


def _head(found: Recheck) -> Text:
    now = "every rule holds now" if found.verified else "not every rule holds now"
    if found:
        text = Text("✓ AS CERTIFIED", "bold green")
    elif found.changes:
        text = Text("✗ CHANGED", "bold red")
    else:
        text = Text("✗ NOT VERIFIED", "bold red")
    return text.append(f"   {found.skill}, {now}", style="default not bold")


def _line(mark: str, style: str, change: Change) -> Text:
    return Text(mark, style).append(change.text, style="default not bold")

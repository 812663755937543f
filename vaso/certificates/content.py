"""What a certificate says: hashes of everything that a verdict rests on, and the verdicts.

A certificate is a flat map from names to texts, so that it fits into the ``metadata`` of a skill
file. The same input gives the same certificate: there is no date in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from vaso.certificates.hashing import digest, platform_hash, platform_name, versions
from vaso.dynamics.result import BetweenSamples
from vaso.skill import Rule, Skill
from vaso.skill_file.front_matter import CERTIFICATE, is_certificate
from vaso.verdict import SpecResult, Verdict, VerificationResult

__all__ = ["FORMAT", "SEAL", "certificate", "content", "sealed", "stored_in"]

FORMAT = "1"
SEAL = f"{CERTIFICATE}-digest"


def stored_in(skill: Skill) -> dict[str, str]:
    """The certificate that a skill carries; empty where it carries none."""
    entries = skill.metadata.get("metadata", {})
    return {key: value for key, value in entries.items() if is_certificate(key, value)}


def certificate(skill: Skill, text: str, result: VerificationResult) -> dict[str, str]:
    """The certificate of a verified skill.

    Args:
        skill: The skill.
        text: Its file without a certificate.
        result: What verifying its plan template gave.
    """
    found = {f"{CERTIFICATE}{name}": value for name, value in _verdicts(result)}
    entries = content(skill, text) | found
    return {**entries, SEAL: sealed(entries)}


def sealed(entries: Mapping[str, str]) -> str:
    """The digest over all other entries of a certificate."""
    return digest(*(t for pair in entries.items() if pair[0] != SEAL for t in pair))


def content(skill: Skill, text: str) -> dict[str, str]:
    """What is in the file, by parts: the whole text, each rule, the code, the platform."""
    return {f"{CERTIFICATE}{name}": value for name, value in _content(skill, text)}


def _content(skill: Skill, text: str) -> Iterator[tuple[str, str]]:
    yield "", FORMAT
    yield "-text", digest(text)
    contract = [part for r in (*skill.rules, *skill.assumptions) for part in (r.role, r.text)]
    yield "-contract", digest(*contract)
    yield from _numbered("rule", skill.rules)
    yield from _numbered("assumption", skill.assumptions)
    yield "-labelling-code", digest(skill.labelling_code)
    yield "-plan-template", digest(skill.plan_template)
    yield "-platform", f"{platform_name(skill.platform)}; {platform_hash(skill.platform)}"


def _numbered(kind: str, rules: Sequence[Rule]) -> Iterator[tuple[str, str]]:
    for number, rule in enumerate(rules, start=1):
        yield f"-{kind}-{number}", f"{rule.role}; {digest(rule.text)}; {rule}"


def _verdicts(result: VerificationResult) -> Iterator[tuple[str, str]]:
    """What was found out: the verdict on each rule with what it rests on, and by what."""
    between: dict[str, BetweenSamples] = {b.spec: b for b in result.between}
    for number, spec in enumerate(result.specs, start=1):
        yield f"-verdict-{number}", _verdict(spec)
        if spec.spec in between and between[spec.spec].verdict is not Verdict.UNSUPPORTED:
            yield f"-between-{number}", _between(between[spec.spec])
    yield "-verdict", result.verdict.value
    yield "-labels", _labels(result)
    yield "-engines", versions(spec.engine for spec in result.specs)


def _labels(result: VerificationResult) -> str:
    """What is known about the labels, without sizes that another version may count otherwise."""
    if result.labels is not None and result.labels.agree:
        return "agree with the platform in every state of the plan"
    return result.label_line


def _verdict(spec: SpecResult) -> str:
    told = [spec.verdict.value]
    told += [f"assuming {text}" for text in spec.assumptions]
    told += [f"vacuous: {spec.vacuous}"] if spec.vacuous else []
    told += [f"why: {spec.reason}"] if spec.reason else []
    return "; ".join(told)


def _between(found: BetweenSamples) -> str:
    return "; ".join(filter(None, (found.verdict.value, found.ranges or found.reason)))

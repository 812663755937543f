"""Certificates: what was verified, in the file that was verified. See ``docs/certificates.md``."""

from vaso.certificates.certify import certify, recheck, stale
from vaso.certificates.result import Certification, Change, Recheck

__all__ = ["Certification", "Change", "Recheck", "certify", "recheck", "stale"]

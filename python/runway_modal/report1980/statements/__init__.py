"""The report's statements, each measured; in the report's order."""

from .mats import MATS
from .model import MODEL
from .spalls import SPALLS
from .statement import Finding, Statement
from .theory import THEORY

#: Section numbers sort as they read, as far as V.
STATEMENTS = tuple(sorted(MATS + THEORY + MODEL + SPALLS, key=lambda each: each.section))

__all__ = ["STATEMENTS", "Finding", "Statement"]

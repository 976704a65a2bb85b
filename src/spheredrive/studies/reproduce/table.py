"""A row of the comparison: what the thesis says, what comes out here, and the verdict, computed from a stated tolerance."""

from __future__ import annotations

from typing import NamedTuple

from spheredrive.studies.reproduce.errata import ERRATA, number


class Row(NamedTuple):
    """One claim of the thesis and what became of it.

    id         short name, "fig-2.7" or "eq-2.48"; claims on the same figure add a word
    claim      what the thesis says, in words
    thesis     its value
    here       the value worked out here
    agrees     whether ``here`` meets ``thesis`` by ``rule``
    rule       how that is decided, and where the tolerance comes from
    erratum    key of the erratum that explains a difference
    open       what the text leaves open, so that the verdict holds under the assumption named; empty where it decides
    """

    id: str
    claim: str
    thesis: str
    here: str
    agrees: bool
    rule: str
    erratum: str = ""
    open: str = ""

    @property
    def verdict(self) -> str:
        """ "agrees" or "differs"."""
        return "agrees" if self.agrees else "differs"

    @property
    def why(self) -> str:
        """The rule; the erratum where the two differ; what the text leaves open."""
        parts = [self.rule]
        if not self.agrees and self.erratum:
            parts.append(f"{number(self.erratum)}: {ERRATA[self.erratum]}")
        elif not self.agrees and not self.open:
            parts.append("No erratum explains the difference.")
        if self.open:
            parts.append(f"The text alone cannot decide this: {self.open}")
        return " ".join(parts)

    def as_dict(self) -> dict[str, str]:
        """The keys of ``reproduce --json``."""
        return {
            "id": self.id,
            "claim": self.claim,
            "thesis": self.thesis,
            "here": self.here,
            "verdict": self.verdict,
            "why": self.why,
        }


def rounds_to(value: float, printed: str) -> bool:
    """Whether ``value`` could have been printed as ``printed``: it lies within half a unit of the last digit shown."""
    decimals = len(printed.partition(".")[2])
    return abs(value - float(printed)) <= 0.5 * 10**-decimals * (1 + 1e-9)


def percent(share: float, digits: int = 3) -> str:
    """A share as "12.3 %"."""
    return f"{100 * share:.{digits}g} %"


def signed(number: float, digits: int = 1) -> str:
    """A number with its sign, "−3.3" or "+3.5"."""
    return f"{number:+.{digits}f}".replace("-", "−")


def vector(numbers, digits: int = 4) -> str:
    """Numbers as "(−0.9380, 0.3127)"."""
    return "(" + ", ".join(f"{x:.{digits}f}" for x in numbers).replace("-", "−") + ")"


def span(low: float, high: float, digits: int = 3) -> str:
    """Two numbers as "0.754 … 1.270"."""
    return f"{low:.{digits}f} … {high:.{digits}f}"

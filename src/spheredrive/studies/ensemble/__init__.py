"""Ensembles: many machines as they are really made, each run through the same motion with contacts that give way and slip."""

from spheredrive.studies.ensemble.runs import ensemble, ensemble_text
from spheredrive.studies.ensemble.spread import Spread, varied_design, varied_designs

__all__ = ["Spread", "ensemble", "ensemble_text", "varied_design", "varied_designs"]

"""Sensitivity: how a metric answers to small changes of a parameter, and which parameter its scatter comes from."""

from spheredrive.studies.sensitivity.local import Gradient, gradient, study_of
from spheredrive.studies.sensitivity.sobol import SobolIndices, sobol_indices

__all__ = ["Gradient", "SobolIndices", "gradient", "sobol_indices", "study_of"]

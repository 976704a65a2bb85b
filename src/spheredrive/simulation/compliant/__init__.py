"""Runs of the compliant model: its seat, its method, its engine."""

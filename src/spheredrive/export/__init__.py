"""The machine for other programs, and how far their answers are from ours."""

"""Optimize: the designs of a study that no other beats in every goal, by evolution and polishing."""

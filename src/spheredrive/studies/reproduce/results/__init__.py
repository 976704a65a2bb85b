"""The numbers behind the figures and rows, each worked out once and kept."""

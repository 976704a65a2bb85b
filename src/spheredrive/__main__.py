"""``python -m spheredrive``."""

from spheredrive.cli import main

main()

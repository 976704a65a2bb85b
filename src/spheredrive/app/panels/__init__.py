"""The panel beside the picture, a tab a file: controls that leave work for the session, and text that it writes."""

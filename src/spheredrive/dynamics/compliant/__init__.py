"""The compliant machine, model.md 5c: every roller a contact of its own that slips, opens and closes."""

"""Everything an engineer reads of a vibration at constant speeds, with findings."""

"""The motion by frequency: lines, orders of the wheels, meetings with natural frequencies, speeds to avoid."""

"""The motion that the shapes of turning wheels make of a linear system, exactly: steady, over time, for many machines."""

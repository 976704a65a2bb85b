"""Motion in the time domain: a design and what drives it in, labelled results out.

``simulate.simulate`` is the door; ``rolling_run`` runs the rolling model, ``dataset`` names what came of it.
"""

"""A design as a MuJoCo model: every roller a body on a hinge of its own, and a run of it as arrays like ours.

MuJoCo is an extra: ``pip install "spheredrive[mujoco]"``. It is imported when a model is made, not before.
"""

"""The machine in three dimensions: bodies, places and poses over time as plain arrays, and a page that draws them offline.

``bodies.machine`` gives the bodies of a design, ``track`` their poses over time, ``page.scene_html`` an animated page in one
file. Nothing here draws for the browser app, which takes the same arrays.
"""

from spheredrive.scene.bodies import Machine, machine
from spheredrive.scene.page import scene_html
from spheredrive.scene.track import Track, track_of_run, track_of_speeds

__all__ = ["Machine", "Track", "machine", "scene_html", "track_of_run", "track_of_speeds"]

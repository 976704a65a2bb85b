"""The documentation site: ``make docs``. Nothing is fetched while it is built, and its pages ask nobody for anything."""

import sys
from pathlib import Path

import spheredrive

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

project = "spheredrive"
author = "the authors of spheredrive"
version = release = spheredrive.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",
    "sphinx_gallery.gen_gallery",
    "commands",
    "docstrings",
    "tables",
]
exclude_patterns = ["_build", "**.py", "gallery/*.ipynb", "gallery/*.json"]
suppress_warnings = ["config.cache"]

myst_enable_extensions = ["dollarmath", "amsmath", "deflist"]
myst_heading_anchors = 3

# From the package "sphinx-mathjax-offline", whose files lie beside the pages. Formulas in letters stay as they are written.
mathjax3_config = {"options": {"enableMenu": False}, "chtml": {"scale": 0.95}}

autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_preserve_defaults = True
autodoc_typehints = "none"
add_module_names = False
python_maximum_signature_line_length = 100
toc_object_entries_show_parents = "hide"
add_function_parentheses = False
# "--json" is two hyphens.
smartquotes = False

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "gallery_style.reading_order",
    "reset_modules": ("matplotlib", "gallery_style.house_figures"),
    "image_srcset": ["2x"],
    "thumbnail_size": (480, 300),
    "min_reported_time": 1e9,
    "show_signature": False,
    "notebook_extensions": set(),
    "download_all_examples": False,
    "remove_config_comments": True,
    "write_computation_times": False,
    "abort_on_example_error": True,
}

html_theme = "pydata_sphinx_theme"
html_title = "spheredrive"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_scaled_image_link = False
html_show_sourcelink = False
html_show_sphinx = False
html_sidebars = {"start": [], "matlab": [], "architecture": [], "thesis/README": []}
html_theme_options = {
    "logo": {"text": "spheredrive"},
    "navbar_align": "left",
    "header_links_before_dropdown": 8,
    "navbar_end": ["theme-switcher"],
    "footer_start": [],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "show_toc_level": 2,
    "show_prev_next": False,
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}

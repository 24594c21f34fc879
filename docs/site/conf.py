"""Settings of the site that scripts/docs builds: Sphinx and MyST from Debian, nothing from a network."""
import os
import pathlib
import re

project = "phasescan"
author = "the phasescan authors"
copyright = "the phasescan authors, Apache-2.0"
release = re.search(r"project\(phasescan VERSION (\S+)", pathlib.Path(os.environ["PHASESCAN_ROOT"], "CMakeLists.txt").read_text())[1]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence"]
html_theme = "alabaster"
html_theme_options = {"page_width": "1500px", "body_max_width": "1200px", "sidebar_width": "260px", "description": "2-D scan matching and SLAM for cheap spinning lidars"}
html_sidebars = {"**": ["about.html", "searchbox.html", "navigation.html"]}
html_show_sourcelink = False
html_copy_source = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_google_docstring = False

"""The docs site: `sphinx-build -nW docs site` (why Sphinx: docs/decisions/0018-docs-site.md)."""

import sys
from importlib.metadata import version as version_of
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent / "_ext"), str(Path(__file__).parents[1])]

project = "Tangible Images"
author = "the authors of Tangible Images"
version = release = version_of("tangible-images")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.viewcode", "docstrings", "generated"]
exclude_patterns = ["_build", "_ext"]
html_static_path = ["_ext/static"]
myst_heading_anchors = 4
myst_enable_extensions = ["deflist"]

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_default_options = {"members": True, "exclude-members": "model_config, version, __init__, __new__"}
add_module_names = False

html_theme = "alabaster"
html_theme_options = {
    "description": "Feel any picture: on a force device, a 3-D print, swell paper, or in your browser.",
    "fixed_sidebar": True,
    "page_width": "76rem",
    "sidebar_width": "16rem",
    "font_family": "system-ui, sans-serif",
    "head_font_family": "system-ui, sans-serif",
    "show_powered_by": False,
}
html_sidebars = {"**": ["about.html", "searchfield.html", "navigation.html"]}
html_copy_source = False

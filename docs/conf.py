"""How the documentation is built: ``.ci/docs`` does it, without a network."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import asperity

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "extensions"))
os.environ["ASPERITY_EXAMPLES"] = str(HERE.parent / "examples")  # cells run in folders of their own

project, author, language = "asperity", "The asperity developers", "en"
project_copyright = "the asperity developers, BSD-3-Clause"
release = version = asperity.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",  # source beside each name of the reference, without a network
    "numpydoc",
    "myst_nb",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "written_pages",  # these four stand in extensions/
    "forked_cells",
    "mathml",
    "reading_order",
]
if "READTHEDOCS" in os.environ:  # everywhere else pages are built without a network
    extensions.append("sphinx.ext.intersphinx")
    intersphinx_mapping = {
        "python": ("https://docs.python.org/3", None),
        "numpy": ("https://numpy.org/doc/stable", None),
        "scipy": ("https://docs.scipy.org/doc/scipy", None),
        "xarray": ("https://docs.xarray.dev/en/stable", None),
    }
exclude_patterns = ["_build", "generated/gallery/*.ipynb", "generated/gallery/*.py", "generated/parts/*"]
default_role = "literal"
smartquotes = False
templates_path = ["_templates"]
nitpicky = True
suppress_warnings = ["config.cache"]

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath", "attrs_inline"]
myst_heading_anchors = 3

nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 600
nb_execution_show_tb = True
nb_merge_streams = True
nb_output_stderr = "remove"  # progress; warnings on the physics stand in results
nb_number_source_lines = False

autosummary_generate = ["generated/api.rst"]
autodoc_typehints = "none"
python_maximum_signature_line_length = 90  # longer ones have a line for each parameter
toc_object_entries_show_parents = "hide"  # names of a class are long enough without its own
autodoc_member_order = "bysource"
numpydoc_show_class_members = False

sphinx_gallery_conf = {
    "examples_dirs": ["../examples"],
    "gallery_dirs": ["generated/gallery"],
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
    "capture_repr": (),
    "thumbnail_size": (640, 400),
    "min_reported_time": 1,
    "within_subsection_order": "FileNameSortKey",
    "remove_config_comments": True,
    "parallel": True,
}

html_theme = "pydata_sphinx_theme"
html_title = f"asperity {release}"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["asperity.css"]
html_js_files = ["copy.js"]
html_favicon = "_static/logo.svg"
html_copy_source = html_show_sourcelink = False
html_theme_options = {
    "logo": {
        "text": f"asperity {release}",
        "image_light": "_static/logo.svg",
        "image_dark": "_static/logo.svg",
        "alt_text": "asperity",
    },
    "navbar_align": "left",
    "header_links_before_dropdown": 9,
    "navigation_with_keys": False,
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_sidebars = {"index": []}

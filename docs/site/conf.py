# SPDX-License-Identifier: Apache-2.0
"""How Sphinx makes the site; script/docs starts it."""

import os
import re
import sys
from pathlib import Path

from docutils import nodes
from sphinx.domains.cpp import CPPDomain
from sphinx.ext.napoleon import GoogleDocstring

ROOT = Path(os.environ["STANDOFF_SOURCE_DIR"])
sys.path.insert(0, str(ROOT / "python"))

project = "standoff"
author = "the authors of standoff"
copyright = "the authors of standoff, Apache-2.0"
release = re.search(r'STANDOFF_VERSION "(.*)"', (ROOT / "include/standoff/version.h").read_text())[1]
version = release

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["parts"]
language = "en"
smartquotes_action = "qe"  # -- stays what it is: options begin so

# Notebooks are shown with the outputs that they were saved with; tests run them.
nb_execution_mode = "off"
myst_heading_anchors = 6
myst_enable_extensions = ["colon_fence", "attrs_inline"]
suppress_warnings = [
    "myst.header",  # pages begin with a comment where a script writes them
    "misc.highlighting_failure",
]

# The reference of the package is made without its compiled part.
autodoc_mock_imports = ["standoff._core"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True}
autoclass_content = "class"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
cpp_index_common_prefix = ["standoff::"]
cpp_maximum_signature_line_length = 88
add_module_names = False
napoleon_numpy_docstring = False
napoleon_use_param = False  # "a, b: text" names two parameters
napoleon_use_rtype = False
napoleon_use_ivar = True
default_role = "py:obj"  # `field` in a docstring: a link where there is such a thing, else code
highlight_language = "text"

html_theme = "furo"
html_favicon = "static/icon.svg"
html_title = f"standoff {release}"
html_static_path = [str(ROOT / "docs/site/static")]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}

# Other people's names, for which there are no pages here.
nitpick_ignore_regex = [
    ("cpp:identifier", r"std(::.*)?|uint\d+_t|size_t|CUstream_st|CUstream_st\*|collision(::.*)?"),
    ("cpp:identifier", r"ptrdiff_t|ElementIterator<.*>"),
    ("py:class", r"np\..*|numpy.*|PathLike|Progress|os\.PathLike|collections\..*|SignMethod"),
]


def parse_sections(self, parse=GoogleDocstring._parse):
    """A property's docstring is like a method's. Napoleon takes "Half-width of the band: ..." for a type, and knows no Raises."""
    if self._what in ("attribute", "data", "property"):
        self._what = "method"
    parse(self)


GoogleDocstring._parse = parse_sections


def objects_to_find(self, objects=CPPDomain.get_objects):
    """The search finds functions and types, not each parameter of each function."""
    return [found for found in objects(self) if found[2] != "functionParam"]


CPPDomain.get_objects = objects_to_find


def resolve(app, env, node, content):
    """`name` that names nothing of the package is code: an argument, a value."""
    if node.get("reftype") == "obj" and node.get("refdomain") == "py":
        return content
    return None


def name_outputs(app, doctree):
    """What a notebook's cell draws has no words of its own for those who do not see it."""
    for image in doctree.findall(nodes.image):
        if not image.get("alt") and isinstance(image.parent, nodes.container):
            image["alt"] = "the picture that the code above makes"


def setup(app):
    app.connect("doctree-read", name_outputs)
    app.connect("missing-reference", resolve)

"""Drawings as SVG: inside a page, where colours follow the reader's screen, and as files of their own."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from io import StringIO
from typing import Any, ClassVar

from matplotlib import rc_context
from matplotlib.backends.backend_mixed import MixedModeRenderer
from matplotlib.backends.backend_svg import FigureCanvasSVG, RendererSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties

from asperity.reporting.style import COLOURS, RC, is_narrow
from asperity.reporting.ticks import one_tick_each

POINTS = FigureCanvasSVG.fixed_dpi
"""Points per inch."""
IMAGE_DPI = 110
"""Dots per inch of the images in a drawing."""
MOST_WORDS = 10_000
"""Words whose sizes are known, at most."""
LONG = 1500
"""Letters of a path beyond which tenths of a point will do: it is drawn by its density."""
_FONTS = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"
_NAMES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'


@dataclass(frozen=True)
class Drawing:
    """A figure that has been drawn."""

    box: str  # its viewBox, in points
    body: str  # its elements, in the colours of the style

    def for_page(self, title: str, colours: Mapping[str, str] = COLOURS) -> str:
        """Element of a page: `colours` become the CSS variables of `colour_variables`; nothing is loaded."""
        numbers = {colour: f"var(--c{index})" for index, colour in enumerate(colours)}

        def coloured(tag: re.Match[str]) -> str:  # tags only: the words of a label stay as they are
            return re.sub("#[0-9a-f]{6}", lambda m: numbers.get(m[0], m[0]), tag[0])

        body = re.sub("<[^<>]*#[^<>]*>", coloured, self.body).replace("xlink:href", "href")
        return f'<svg role="img" aria-label="{escape(title)}" viewBox="{self.box}">{body}</svg>'

    def for_file(self, title: str) -> str:
        """Document of its own, dark on white, as word processors and drawing programs read it."""
        width, height = self.box.split()[2:]
        return (
            f'<?xml version="1.0" encoding="utf-8"?>\n<svg {_NAMES} width="{width}pt" height="{height}pt" '
            f'viewBox="{self.box}" font-family="{_FONTS}">\n<title>{escape(title)}</title>\n'
            f'<rect width="100%" height="100%" fill="white"/>\n{self.body}\n</svg>\n'
        )


class _Renderer(RendererSVG):
    """Measures words once, for all drawings."""

    sizes: ClassVar[dict[tuple[str, int, object], Any]] = {}

    def get_text_width_height_descent(self, s: str, prop: FontProperties, ismath: Any) -> Any:
        key = s, hash(prop), ismath
        if key not in self.sizes:
            if len(self.sizes) > MOST_WORDS:
                self.sizes.clear()
            measured: Any = super()
            self.sizes[key] = measured.get_text_width_height_descent(s, prop, ismath)
        return self.sizes[key]


class _Canvas(FigureCanvasSVG):
    """Lays figures out with what draws them."""

    def get_renderer(self) -> _Renderer:
        return _Renderer(1.0, 1.0, StringIO())  # type: ignore[no-untyped-call]


def drawing_of(figure: Figure, name: str) -> Drawing:
    """Draw a figure; identifiers in it get the prefix `name`, which is its own in a page."""
    figure.set_canvas(_Canvas(figure))
    figure.dpi, text = POINTS, StringIO()
    coarser = {"path.simplify_threshold": 0.5} if is_narrow() else {}  # half a page needs fewer points
    with rc_context(RC | coarser), one_tick_each(figure):
        engine = figure.get_layout_engine()
        if engine is not None:  # lay out once; `savefig` would draw everything twice
            with warnings.catch_warnings():  # names may be longer than a narrow page is wide
                warnings.filterwarnings("ignore", "constrained_layout not applied", UserWarning)
                engine.execute(figure)
            figure.set_layout_engine("none")
        width, height = figure.get_size_inches()
        vectors = _Renderer(POINTS * width, POINTS * height, text, image_dpi=IMAGE_DPI)  # type: ignore[no-untyped-call]
        renderer: Any = MixedModeRenderer(figure, width, height, IMAGE_DPI, vectors)  # type: ignore[no-untyped-call]
        figure.draw(renderer)
        renderer.finalize()
    head, inner = text.getvalue().partition("<svg")[2].split(">", 1)
    box = re.search(r'viewBox="([^"]*)"', head)
    inner = (
        re.sub(r"<metadata>.*?</metadata>", "", inner, flags=re.DOTALL)
        .removesuffix("\n")
        .rpartition("</svg>")[0]
    )
    return Drawing(box[1] if box else "", _slim(inner, name))


def _slim(body: str, name: str) -> str:
    """Elements of a drawing in fewer letters: without groups and names that nothing asks for."""
    # numbered as they appear: matplotlib's names hold digits that differ from one drawing to the next
    found = dict.fromkeys(re.findall(r'(?:url\(|href=")#([^")]+)', body))
    used = {identifier: f"{name}-{n}" for n, identifier in enumerate(found)}
    kept: list[str] = []
    open_groups: list[bool] = []
    for piece in re.split(r"(<[^<>]+>)", body):
        if not piece.startswith("<"):
            kept.append(piece if piece.strip() else "")  # the words of a label stay as they are
            continue
        tag = _slim_tag(piece, used)
        if tag == "</g>":
            tag = tag if open_groups.pop() else ""
        elif tag == "<g/>":
            tag = ""
        elif tag == "<g>" or tag.startswith("<g "):
            open_groups.append(tag != "<g>")
            tag = tag if tag != "<g>" else ""
        kept.append(tag)
    return "".join(kept)


def _slim_tag(tag: str, used: Mapping[str, str]) -> str:
    if ' id="' in tag:
        tag = re.sub(r' id="([^"]*)"', lambda m: f' id="{used[m[1]]}"' if m[1] in used else "", tag)
    if "#" in tag:
        tag = re.sub(r'(url\(|href=")#([^")]+)', lambda m: f"{m[1]}#{used[m[2]]}", tag)
    if "font-family" in tag:
        tag = re.sub(r"font-family: [^;\"]*;? ?", "", tag)  # that of the page
    if "." in tag:
        tag = (_BEYOND_TENTHS if len(tag) > LONG else _BEYOND_HUNDREDTHS).sub("", tag)
    if ' style="' in tag:
        tag = re.sub(
            r' style="([^"]*)"', lambda m: ' style="' + m[1].replace(": ", ":").replace("; ", ";") + '"', tag
        )
    return re.sub(r' d="([^"]*)"', lambda m: f' d="{tight(m[1])}"', tag) if ' d="' in tag else tag


_BEYOND_TENTHS, _BEYOND_HUNDREDTHS = re.compile(r"(?<=\d\.\d)\d+"), re.compile(r"(?<=\d\.\d\d)\d+")
"""Digits of a point that are left out; a hundredth is finer than any screen."""


def share_styles(page: str) -> str:
    """Put the styles of all drawings of a page into its style sheet, each once; few differ."""
    names: dict[str, str] = {}

    def named(style: re.Match[str]) -> str:
        return f' class="{names.setdefault(style[1], f"s{len(names)}")}"'

    def shared(drawing: re.Match[str]) -> str:
        return re.sub(r' style="([^"]*)"', named, drawing[0])

    page = re.sub(r'<svg role="img".*?</svg>', shared, page, flags=re.DOTALL)
    sheet = "\n".join(f".{name}{{{style}}}" for style, name in names.items())
    return page.replace("</style>", f"{sheet}\n</style>", 1)


def tight(path: str) -> str:
    """Path of an SVG element in fewer letters: a pair of numbers behind another is a line by itself."""
    path = re.sub(r"\s*([A-Za-z])\s*", r"\1", path.strip())
    return path if re.search("[^MLz0-9. -]", path) else re.sub(r"(?<=\d)L", " ", path)


def colour_variables(dark: bool, colours: Mapping[str, str] = COLOURS) -> str:
    """CSS declarations of the colours that a drawing in a page refers to."""
    return "".join(
        f"--c{index}:{other if dark else colour};" for index, (colour, other) in enumerate(colours.items())
    )

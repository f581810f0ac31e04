"""Panels of curves and dots as one SVG, written by hand so that nothing needs installing.

Colours are those of the program's light theme and the Okabe-Ito set. Widths of text are estimated
(no font is read), generously, so that neighbours never touch.
"""

import math
from dataclasses import dataclass, field
from xml.sax.saxutils import escape, quoteattr

GROUND, PAPER, INK, QUIET, GRID = "#F4F6F8", "#FFFFFF", "#1B1F26", "#55606E", "#E4E8ED"
FONT = "Inter, 'DejaVu Sans', Arial, sans-serif"
TITLE_PX, BODY_PX, SMALL_PX = 22, 15, 13
PANEL_W, PANEL_H = 470, 300
LEFT, RIGHT, ABOVE, BELOW = 100, 22, 46, 62  # of a panel, outside its axes
MARGIN = 24


@dataclass
class Curve:
    points: list  # (x, y)
    colour: str
    dash: str = ""
    width: float = 2.0
    marks: bool = False


@dataclass
class Dots:
    points: list
    colour: str
    opacity: float = 0.35


@dataclass
class Axis:
    label: str
    low: float
    high: float
    log: bool = False
    extra_ticks: dict = field(default_factory=dict)  # value: text, on top of the usual ones

    def share(self, value):
        """0 at the low end, 1 at the high end."""
        if self.log:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def ticks(self):
        ticks = {v: number(v) for v in (self._decades() if self.log else self._round_steps())}
        return {**ticks, **self.extra_ticks}

    def _decades(self):
        first = math.ceil(math.log10(self.low) - 1e-9)
        last = math.floor(math.log10(self.high) + 1e-9)
        return [10.0 ** e for e in range(first, last + 1)]

    def _round_steps(self, at_most=6):
        smallest = (self.high - self.low) / at_most
        size = 10.0 ** math.floor(math.log10(smallest))
        step = next(size * m for m in (1, 2, 2.5, 5, 10) if size * m >= smallest)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [i * step for i in range(first, last + 1)]


@dataclass
class Panel:
    title: str
    x: Axis
    y: Axis
    curves: list = field(default_factory=list)
    dots: list = field(default_factory=list)
    level: tuple = ()  # (y, text): a dashed line across


@dataclass
class LegendEntry:
    text: str
    colour: str
    dash: str = ""
    width: float = 2.6
    dot: bool = False


def number(value):
    """1,000 and 0.1 rather than 1e3 and 0.1000."""
    if value == 0:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    text = f"{value:,.{digits}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def linear_axis(label, values, low=0.0):
    """From `low` to a little above the greatest value."""
    high = max(values)
    return Axis(label, low, low + 1.06 * (high - low) if high > low else low + 1.0)


def log_axis(label, values):
    """Around the values that are above zero, from 1 or 3 of a decade to 1 or 3 of one."""
    positive = [v for v in values if v > 0] or [1.0]
    bounds = [m * 10.0 ** e for e in range(-9, 12) for m in (1, 3)]
    low = max(b for b in bounds if b <= min(positive))
    return Axis(label, low, min(b for b in bounds if b > max(max(positive), 3 * low)), log=True)


def text_width(text, px):
    return 0.6 * px * len(text)


def _text(x, y, text, px, colour=INK, anchor="start", weight=400, turned=False):
    turn = f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
    return (f'<text x="{x:.1f}" y="{y:.1f}" font-size="{px}" font-weight="{weight}" '
            f'fill="{colour}" text-anchor="{anchor}"{turn}>{escape(text)}</text>')


def _line(x1, y1, x2, y2, colour, width=1.0, dash=""):
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    return (f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" '
            f'stroke-width="{width}"{dashed}/>')


def _panel(panel, left, top):
    """The panel whose axes' upper left corner is at (left, top)."""
    right, bottom = left + PANEL_W, top + PANEL_H
    def px(x):
        return left + PANEL_W * panel.x.share(x)
    def py(y):
        return bottom - PANEL_H * panel.y.share(y)

    parts = [f'<rect x="{left}" y="{top}" width="{PANEL_W}" height="{PANEL_H}" fill="{PAPER}"/>',
             _text(left, top - 14, panel.title, BODY_PX, weight=600)]
    for value, text in panel.x.ticks().items():
        parts.append(_line(px(value), top, px(value), bottom, GRID))
        parts.append(_line(px(value), bottom, px(value), bottom + 5, QUIET))
        parts.append(_text(px(value), bottom + 20, text, SMALL_PX, QUIET, "middle"))
    for value, text in panel.y.ticks().items():
        parts.append(_line(left, py(value), right, py(value), GRID))
        parts.append(_line(left - 5, py(value), left, py(value), QUIET))
        parts.append(_text(left - 9, py(value) + 4.5, text, SMALL_PX, QUIET, "end"))
    parts.append(_text((left + right) / 2, bottom + 44, panel.x.label, BODY_PX, INK, "middle"))
    parts.append(_text(left - 84, (top + bottom) / 2, panel.y.label, BODY_PX, INK, "middle",
                       turned=True))
    for dots in panel.dots:
        # One path for all; dots that would fall on each other to a third of a pixel are drawn once.
        places = sorted({(round(3 * px(x)), round(3 * py(y))) for x, y in dots.points})
        drawn = "".join(f"M{x / 3:.1f} {y / 3:.1f}h0" for x, y in places)
        parts.append(f'<path d="{drawn}" fill="none" stroke="{dots.colour}" stroke-width="3.2" '
                     f'stroke-linecap="round" stroke-opacity="{dots.opacity}"/>')
    if panel.level and panel.y.low <= panel.level[0] <= panel.y.high:
        y = py(panel.level[0])
        parts.append(_line(left, y, right, y, INK, 1.2, "2 4"))
        above = y - 6 if y - top > 24 else y + 18
        parts.append(_text(left + 8, above, panel.level[1], SMALL_PX, INK))
    for curve in panel.curves:
        if not curve.points:
            continue
        drawn = "M" + "L".join(f"{px(x):.1f} {py(y):.1f}" for x, y in curve.points)
        dashed = f' stroke-dasharray="{curve.dash}"' if curve.dash else ""
        parts.append(f'<path d="{drawn}" fill="none" stroke="{curve.colour}" '
                     f'stroke-width="{curve.width}" stroke-linejoin="round"{dashed}/>')
        if curve.marks:
            parts += [f'<circle cx="{px(x):.1f}" cy="{py(y):.1f}" r="3.6" fill="{curve.colour}" '
                      f'stroke="{PAPER}" stroke-width="1"/>' for x, y in curve.points]
    parts.append(f'<path d="M{left} {top}V{bottom}H{right}" fill="none" stroke="{QUIET}" '
                 'stroke-width="1.2"/>')
    return parts


def _legend(entries, top, width):
    """Entries left to right, in columns where they need more than a row; drawn, and the height."""
    parts, x, y = [], float(MARGIN), top
    widths = [46 + text_width(entry.text, SMALL_PX) + 18 for entry in entries]
    if sum(widths) > width - 2 * MARGIN:
        widths = [max(widths)] * len(entries)
    for entry, needed in zip(entries, widths):
        if x > MARGIN and x + needed > width - MARGIN:
            x, y = float(MARGIN), y + 24
        if entry.dot:
            parts.append(f'<circle cx="{x + 18:.1f}" cy="{y:.1f}" r="4" fill="{entry.colour}" '
                         'fill-opacity="0.6"/>')
        else:
            parts.append(_line(x, y, x + 36, y, entry.colour, entry.width, entry.dash))
        parts.append(_text(x + 44, y + 4.5, entry.text, SMALL_PX))
        x += needed
    return parts, y + 24 - top


def svg(title, notes, legend, panels, columns=2):
    """The whole picture. `notes`: lines below the title; panels fill row by row."""
    rows = math.ceil(len(panels) / columns)
    width = 2 * MARGIN + columns * (LEFT + PANEL_W + RIGHT)
    top = MARGIN + 24
    body = [_text(MARGIN, top, title, TITLE_PX, weight=600)]
    for note in notes:
        top += 22
        body.append(_text(MARGIN, top, note, SMALL_PX, QUIET))
    top += 28
    drawn, legend_height = _legend(legend, top, width)
    body += drawn
    top += legend_height
    for i, panel in enumerate(panels):
        column, row = i % columns, i // columns
        body += _panel(panel, MARGIN + column * (LEFT + PANEL_W + RIGHT) + LEFT,
                       top + row * (ABOVE + PANEL_H + BELOW) + ABOVE)
    height = top + rows * (ABOVE + PANEL_H + BELOW) + MARGIN // 2
    return "\n".join([
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family={quoteattr(FONT)}>',
        f"<title>{escape(title)}</title>",
        f'<rect width="{width}" height="{height}" fill="{GROUND}"/>', *body, "</svg>", ""])

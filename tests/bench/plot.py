"""Log-log plots as SVG text: panels side by side, a line for each series, and a legend."""

import math

WIDTH, HEIGHT = 380, 320  # of a panel's inside
LEFT, RIGHT, TOP, BOTTOM = 64, 24, 40, 56
INK, GRID, COLOURS = "#1f2933", "#d9dee3", ["#0b63a5", "#c2410c", "#15803d"]
SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


class Panel:
    """Beside every series a dashed line from its first point shows growth in proportion."""

    def __init__(self, title):
        self.title = title
        self.series = []

    def add(self, name, points):
        """`points`: pairs of positive numbers, in order."""
        self.series.append((name, points))


def draw(panels, x_label):
    width = len(panels) * (LEFT + WIDTH + RIGHT)
    height = TOP + HEIGHT + BOTTOM
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
             f'height="{height}" font-family="sans-serif" font-size="12" fill="{INK}">',
             f'<rect width="{width}" height="{height}" fill="#ffffff"/>']
    for number, panel in enumerate(panels):
        parts.append(f'<g transform="translate({number * (LEFT + WIDTH + RIGHT) + LEFT} {TOP})">')
        parts += panel_parts(panel, x_label)
        parts.append("</g>")
    parts.append("</svg>")
    return "\n".join(parts) + "\n"


class Axis:
    """From `first` to `last`, logarithms, on `pixels` from `start`."""

    def __init__(self, first, last, start, pixels):
        self.first = first
        self.last = last
        self.start = start
        self.pixels = pixels

    def at(self, value):
        return self.start + self.pixels * (math.log10(value) - self.first) / (self.last - self.first)

    def decades(self):
        return range(math.ceil(self.first), math.floor(self.last) + 1)


def panel_parts(panel, x_label):
    xs = [math.log10(x) for _, series in panel.series for x, _ in series]
    ys = [math.log10(y) for _, series in panel.series for _, y in series]
    x = Axis(min(xs) - 0.2, max(xs) + 0.2, 0, WIDTH)
    y = Axis(math.floor(min(ys)), max(math.ceil(max(ys)), math.floor(min(ys)) + 1), HEIGHT, -HEIGHT)
    yield f'<text x="0" y="-16" font-size="14" font-weight="bold">{panel.title}</text>'
    for e in x.decades():
        at = x.at(10.0**e)
        yield line([(at, 0), (at, HEIGHT)], GRID)
        yield text(at, HEIGHT + 18, power(e), "middle")
    for e in y.decades():
        at = y.at(10.0**e)
        yield line([(0, at), (WIDTH, at)], GRID)
        yield text(-8, at + 4, power(e), "end")
    yield text(WIDTH / 2, HEIGHT + 40, x_label, "middle")
    for (_, series), colour in zip(panel.series, COLOURS):
        at = [(x.at(a), y.at(b)) for a, b in series]
        (x0, y0), x1 = series[0], min(series[-1][0], series[0][0] * 10**y.last / series[0][1])
        yield line([at[0], (x.at(x1), y.at(y0 * x1 / x0))], colour, 'stroke-dasharray="3 4" opacity="0.6"')
        yield line(at, colour, 'stroke-width="2"')
        for a, b in at:
            yield f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3.5" fill="{colour}"/>'
    yield from legend(panel)


def legend(panel):
    """In the upper left, where growing lines never are."""
    for row, ((name, _), colour) in enumerate(zip(panel.series, COLOURS)):
        yield line([(12, 18 + 18 * row), (34, 18 + 18 * row)], colour, 'stroke-width="2"')
        yield text(40, 22 + 18 * row, name)
    row = len(panel.series)
    yield line([(12, 18 + 18 * row), (34, 18 + 18 * row)], INK, 'stroke-dasharray="3 4" opacity="0.6"')
    yield text(40, 22 + 18 * row, "in proportion")


def power(exponent):
    return f"{10.0**exponent:g}" if -3 <= exponent <= 2 else "10" + str(exponent).translate(SUPERSCRIPTS)


def text(x, y, words, anchor="start"):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}</text>'


def line(points, colour, more=""):
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="{colour}" {more}/>'

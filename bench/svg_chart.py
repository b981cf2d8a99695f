"""Charts as SVG: a page with two logarithmic axes and the marks that go on it. Written by hand, so that a checkout
draws them with Python alone. For contact_chart.py and field_chart.py."""
import math
import sys


class Chart:
    """`x` and `y` are the ends of the axes, both logarithmic; `margins` are left, right, top, bottom [px]."""

    def __init__(self, title, about, size, margins, x, y):
        self.width, self.height = size
        self.left, right, self.top, bottom = margins
        self.right, self.bottom = self.width - right, self.height - bottom
        self._x, self._y = [math.log10(v) for v in x], [math.log10(v) for v in y]
        self._out = [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
            f'viewBox="0 0 {self.width} {self.height}" font-family="DejaVu Sans, sans-serif" font-size="12">',
            f'<rect width="{self.width}" height="{self.height}" fill="white"/>',
            f'<text x="{self.left}" y="24" font-size="16">{title}</text>',
            f'<text x="{self.left}" y="42" fill="#555">{about}</text>',
        ]

    def px(self, x):
        return self.left + (math.log10(x) - self._x[0]) / (self._x[1] - self._x[0]) * (self.right - self.left)

    def py(self, y):
        return self.bottom - (math.log10(y) - self._y[0]) / (self._y[1] - self._y[0]) * (self.bottom - self.top)

    def add(self, element):
        self._out.append(element)

    def text(self, x, y, words, attributes=""):
        self.add(f'<text x="{x:.1f}" y="{y:.1f}"{" " if attributes else ""}{attributes}>{words}</text>')

    def line(self, x1, y1, x2, y2, attributes):
        self.add(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" {attributes}/>')

    def circle(self, x, y, radius, attributes, title=None):
        end = f"><title>{title}</title></circle>" if title else "/>"
        self.add(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" {attributes}{end}')

    def path(self, points, attributes):
        """Through points [px]."""
        along = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.add(f'<polyline points="{along}" fill="none" {attributes}/>')

    def axes(self, x_ticks, x_name, y_ticks, y_name):
        """Grid lines and their labels, {value: label}, and the names of the axes."""
        for value, label in x_ticks.items():
            self.line(self.px(value), self.top, self.px(value), self.bottom, 'stroke="#ddd"')
            self.text(self.px(value), self.bottom + 18, label, 'text-anchor="middle"')
        for value, label in y_ticks.items():
            self.line(self.left, self.py(value), self.right, self.py(value), 'stroke="#ddd"')
            self.text(self.left - 8, self.py(value) + 4, label, 'text-anchor="end"')
        self.text((self.left + self.right) / 2, self.height - 22, x_name, 'text-anchor="middle"')
        middle = (self.top + self.bottom) / 2
        self.text(22, middle, y_name, f'text-anchor="middle" transform="rotate(-90 22 {middle})"')

    def svg(self):
        return "\n".join(self._out) + "\n</svg>\n"


def decades(low, high):
    """The exponents of the powers of ten that hold low and high between them."""
    return math.floor(math.log10(low)), math.ceil(math.log10(high))


def run(arguments, script, bench, read, draw):
    """The program of a chart: ROWS.csv in, OUT.svg out; `read` gives what `draw` makes an SVG of, empty without rows."""
    if len(arguments) != 2:
        print(f"usage: {script} ROWS.csv OUT.svg", file=sys.stderr)
        return 2
    found = read(arguments[0])
    if not found:
        print(f"{arguments[0]}: no rows of {bench} in it", file=sys.stderr)
        return 2
    with open(arguments[1], "w") as out:
        out.write(draw(found))
    return 0

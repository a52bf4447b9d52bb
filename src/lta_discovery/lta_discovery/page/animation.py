"""
Draw a prediction before and after as an animated SVG, for a first look at a result.

A piece of a held-out flight is flown in 3-D beside what the vehicle file predicts from the same
start and commands. Then the missing effect is named, and the prediction with it takes its place.
The file needs no script, so it plays wherever pictures are shown.
"""

from collections.abc import Callable, Sequence
from html import escape
from typing import Final, final, NamedTuple

from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import StudyResult
from lta_discovery.page.flight_views import StudyFlightView
from lta_discovery.page.formatting import (
    format_effect,
    format_estimate,
    format_quantity,
    join_words,
)
from lta_model.mass_properties import half_axes
from lta_model.vehicle import Vehicle
from lta_report.palette import DARK, ESTIMATE, GRID, INK, PAPER, SOFT, TRUTH, WALL
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NAME: Final = 'animation.svg'
WIDTH, HEIGHT = 880.0, 450.0  # px
SCENE: Final = (300.0, 240.0, 290.0)  # px: middle across and down, largest distance from it
CHART: Final = (630.0, 265.0, 210.0, 120.0)  # px: left, top, width, height
POINTS: Final = 48  # of each line
RODS: Final = 12  # between measurement and prediction
LOOP: Final = 16.0  # s
FRAME: Final = 0.5  # s
# Seconds at which the parts of the story begin
FLY, MISS, NAMED, SNAP, END = 0.5, 6.5, 8.5, 10.5, 12.0
AZIMUTH, SWAY, ELEVATION = np.radians((-50.0, 22.0, 24.0))  # of the camera
TILE: Final = 1.0  # m; of the ground
FRAMES: Final = np.arange(0.0, LOOP + 0.5 * FRAME, FRAME)


@final
class PredictedPiece(NamedTuple):
    """A piece of flight with its predictions before and after."""

    seconds: float  # duration [s]
    # Positions, z up, shape (n, 3) [m]
    measured: Array
    before: Array
    after: Array
    hull: tuple[float, float]  # diameter and height of the hull; zeros without one [m]


def select_piece(
    views: Sequence[StudyFlightView], hull: tuple[float, float]
) -> PredictedPiece | None:
    """Return the full-length piece with the median error before; None without any."""
    pieces = []
    for view in (each for each in views if each.shown):
        flight = view.study_flight.flight
        for k, index in enumerate(flight.index):
            inside = flight.replay.cut.inside[k]
            measured = flight.replay.flight.position[index[inside]]
            both = view.before.position[k, inside], view.after.position[k, inside]
            if len(measured) > 1 and all(np.isfinite(each).all() for each in (measured, *both)):
                seconds = float(np.ptp(view.before.time[k, inside]))
                pieces.append(PredictedPiece(seconds, measured, *both, hull))
    longest = max((each.seconds for each in pieces), default=0.0)
    full = [each for each in pieces if each.seconds > 0.95 * longest]
    full.sort(key=lambda each: float(np.linalg.norm(each.before[-1] - each.measured[-1])))
    return full[len(full) // 2] if full else None


def draw_animation(
    finding: StudyResult, views: Sequence[StudyFlightView], vehicle: Vehicle
) -> str:
    """Return the animation of a finding as an SVG file; empty if it asserts no gain."""
    conclusion = draw_conclusion(finding)
    if not conclusion.asserted or conclusion.gain is None or conclusion.rivals:
        return ''
    x, y, z = half_axes(vehicle.file.hull)
    piece = select_piece(views, (x + y, 2.0 * z))
    return '' if piece is None else draw_piece(finding, piece)


def draw_piece(finding: StudyResult, piece: PredictedPiece) -> str:
    """Return the animation of one piece."""
    scene = _Scene(piece)
    words = _list_captions(finding, piece)
    still = [*words[1][2], *words[-1][2]]
    body = [
        _style(),
        f'<title>{escape(" ".join(still))}</title>',
        f'<rect class="paper" width="{WIDTH:.0f}" height="{HEIGHT:.0f}"/>',
        f'<g class="moving">{"".join([*scene.draw_moving(), *_draw_captions(words)])}</g>',
        f'<g class="still">{"".join([*scene.draw_still(), *_draw_text(still)])}</g>',
        *_draw_legend(),
    ]
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:.0f} {HEIGHT:.0f}" '
        f'role="img">{"".join(body)}</svg>\n'
    )


@final
class _Scene:
    """The flight in 3-D and the chart of its error, at each frame."""

    def __init__(self, piece: PredictedPiece) -> None:
        steps = np.linspace(0, len(piece.measured) - 1, POINTS).round().astype(int)
        self._piece = piece
        self._lines = tuple(each[steps] for each in (piece.measured, piece.before, piece.after))
        everything = np.concatenate(self._lines)
        self._middle = 0.5 * (everything.min(axis=0) + everything.max(axis=0))
        self._floor = everything[:, 2].min() - 0.5 * piece.hull[1] - 0.35
        reach = np.linalg.norm(everything - self._middle, axis=1).max() + 0.5 * piece.hull[0]
        self._scale = SCENE[2] / reach
        before, after = (np.linalg.norm(each - self._lines[0], axis=1) for each in self._lines[1:])
        self._errors = before, after
        # Share of the piece that has been flown, and share of the change to the new model
        self._flown = np.clip((FRAMES - FLY) / (MISS - FLY), 0.0, 1.0)
        self._changed = _ease(np.clip((FRAMES - SNAP) / (END - SNAP), 0.0, 1.0))

    def draw_moving(self) -> list[str]:
        """Return the animated elements."""
        measured, before, after = self._lines

        def predict(k: int) -> Array:
            share = self._changed[k]
            mixed: Array = (1.0 - share) * before + share * after
            return mixed

        def cut(line: Callable[[int], Array]) -> list[Array]:
            return [_cut(line(k), part) for k, part in enumerate(self._flown)]

        flights = cut(lambda _k: measured), cut(predict)
        shadows = [_drop(line, self._floor) for line in flights[0]]
        tiles = self._list_tiles()
        grid = [np.concatenate([self._project(tile, k) for tile in tiles]) for k in self._frames]
        rods = [
            np.concatenate(
                [
                    self._project(np.stack([flights[0][k][j], flights[1][k][j]]), k)
                    for j in np.linspace(0, POINTS - 1, RODS + 1).round().astype(int)[1:]
                ]
            )
            for k in self._frames
        ]
        sight = self._project_lines(flights[0])
        guess = self._project_lines(flights[1])
        predicted = [each[-1] for each in guess]
        return [
            _animate_path('grid', [_pairs(each) for each in grid]),
            _animate_path('shadow', [_chain(each) for each in self._project_lines(shadows)]),
            _animate_path('rod', [_pairs(each) for each in rods]),
            _animate_path('measured', [_chain(each) for each in sight]),
            _animate_path('before', [_chain(each) for each in guess], _fade(SNAP, END, out=True)),
            _animate_path('after', [_chain(each) for each in guess], _fade(SNAP, END)),
            self._draw_hull('hull', [each[-1] for each in sight]),
            self._draw_hull('ghost before', predicted, _fade(SNAP, END, out=True)),
            self._draw_hull('ghost after', predicted, _fade(SNAP, END)),
            *self._draw_chart(moving=True),
        ]

    def draw_still(self) -> list[str]:
        """Return the elements for people who want no motion."""
        points = [self._project(line, 0) for line in self._lines]
        tiles = np.concatenate([self._project(tile, 0) for tile in self._list_tiles()])
        return [
            f'<path class="grid" d="{_pairs(tiles)}"/>',
            *(
                f'<path class="{kind}" d="{_chain(line)}"/>'
                for kind, line in zip(('measured', 'before', 'after'), points, strict=True)
            ),
            *self._draw_chart(moving=False),
        ]

    @property
    def _frames(self) -> range:
        return range(len(FRAMES))

    def _project_lines(self, lines: Sequence[Array]) -> list[Array]:
        return [self._project(line, k) for k, line in enumerate(lines)]

    def _project(self, places: Array, frame: int) -> Array:
        """Return places [m] in pixels at a frame, shape (n, 2), seen without perspective."""
        azimuth = AZIMUTH + SWAY * np.sin(2.0 * np.pi * FRAMES[frame] / LOOP)
        x, y, z = (places - self._middle).T * self._scale
        across = x * np.cos(azimuth) - y * np.sin(azimuth)
        away = x * np.sin(azimuth) + y * np.cos(azimuth)
        down = -z * np.cos(ELEVATION) - away * np.sin(ELEVATION)
        return np.column_stack([SCENE[0] + across, SCENE[1] + down])

    def _list_tiles(self) -> list[Array]:
        """Return the lines of the ground, each by its two ends."""
        reach = np.ceil(SCENE[2] / self._scale / TILE) * TILE
        x, y = np.round(self._middle[:2] / TILE) * TILE
        at = np.arange(-reach, reach + 0.5 * TILE, TILE)
        return [
            np.array([[*one, self._floor], [*other, self._floor]])
            for k in at
            for one, other in (
                ((x + k, y - reach), (x + k, y + reach)),
                ((x - reach, y + k), (x + reach, y + k)),
            )
        ]

    def _draw_hull(self, kind: str, places: Sequence[Array], also: str = '') -> str:
        """Return the outline of the hull, moved along the projected places."""
        across, high = (0.5 * size * self._scale for size in self._piece.hull)
        tall = float(np.hypot(high * np.cos(ELEVATION), across * np.sin(ELEVATION)))
        values = ';'.join(f'{x:.1f} {y:.1f}' for x, y in places)
        return (
            f'<ellipse class="{kind}" rx="{across:.1f}" ry="{tall:.1f}"><animateTransform '
            f'attributeName="transform" type="translate" {_timing(values)}/>{also}</ellipse>'
        )

    def _draw_chart(self, *, moving: bool) -> list[str]:
        """Return the chart of both errors over time."""
        left, top, width, height = CHART
        largest = max(float(each.max()) for each in self._errors)
        unit, factor = ('cm', 100.0) if largest < 1.0 else ('m', 1.0)
        across = left + width * np.linspace(0.0, 1.0, POINTS)
        lines = [
            np.column_stack([across, top + height * (1.0 - each / largest)])
            for each in self._errors
        ]
        parts = [
            f'<path class="axis" d="M{left} {top}V{top + height}H{left + width}"/>',
            f'<text class="soft" x="{left}" y="{top - 10}">position error [{unit}]</text>',
            f'<text class="soft end" x="{left - 6}" y="{top + 5}">{factor * largest:.0f}</text>',
            f'<text class="soft end" x="{left - 6}" y="{top + height + 4}">0</text>',
            f'<text class="soft end" x="{left + width}" y="{top + height + 18}">'
            f'{self._piece.seconds:.0f} s</text>',
        ]
        if not moving:
            return parts + [
                f'<path class="{kind}" d="{_chain(line)}"/>'
                for kind, line in zip(('before', 'after'), lines, strict=True)
            ]
        grown = [_chain(_cut(lines[0], part)) for part in self._flown]
        settled = [_chain((1.0 - share) * lines[0] + share * lines[1]) for share in self._changed]
        return [
            *parts,
            _animate_path('before', grown, _fade(SNAP, END, least=0.35, out=True)),
            _animate_path('after', settled, _fade(SNAP, END)),
        ]


def _ease(share: Array) -> Array:
    """Return a share that starts and ends slowly."""
    return share * share * (3.0 - 2.0 * share)


def _cut(line: Array, share: float) -> Array:
    """Return a line as far as it has been flown; the rest stays at its end."""
    at = np.minimum(np.arange(len(line)), share * (len(line) - 1))
    low = np.floor(at).astype(int)
    high = np.minimum(low + 1, len(line) - 1)
    part = (at - low)[:, None]
    out: Array = (1.0 - part) * line[low] + part * line[high]
    return out


def _drop(line: Array, floor: float) -> Array:
    """Return the shadow of a line on the floor."""
    return np.column_stack([line[:, :2], np.full(len(line), floor)])


def _chain(places: Array) -> str:
    """Return the path through places [px]."""
    return 'M' + 'L'.join(f'{x:.1f} {y:.1f}' for x, y in places)


def _pairs(places: Array) -> str:
    """Return a path of separate lines, each between two places [px]."""
    return ''.join(
        f'M{a:.1f} {b:.1f}L{c:.1f} {d:.1f}' for (a, b), (c, d) in places.reshape(-1, 2, 2)
    )


def _timing(values: str) -> str:
    return f'values="{values}" dur="{LOOP:g}s" repeatCount="indefinite"'


def _animate_path(kind: str, values: Sequence[str], also: str = '') -> str:
    return (
        f'<path class="{kind}" d="{values[-1]}"><animate attributeName="d" '
        f'{_timing(";".join(values))}/>{also}</path>'
    )


def _fade(begin: float, end: float, *, least: float = 0.0, out: bool = False) -> str:
    """Return an animation that shows an element from then on, or fades it `out`."""
    first, last = (1.0, least) if out else (least, 1.0)
    return (
        '<animate attributeName="opacity" '
        f'keyTimes="0;{begin / LOOP:.4f};{end / LOOP:.4f};1" '
        f'{_timing(f"{first:g};{first:g};{last:g};{last:g}")}/>'
    )


def _show(begin: float, end: float) -> str:
    """Return an animation that shows an element between two times."""
    times = (0.0, begin, min(begin + 0.4, end), max(end - 0.2, begin), end, LOOP)
    opacities = (0, 0, 1, 1, 0, 0) if end < LOOP else (0, 0, 1, 1, 1, 1)
    keys = ';'.join(f'{each / LOOP:.4f}' for each in times)
    return (
        f'<animate attributeName="opacity" keyTimes="{keys}" '
        f'{_timing(";".join(map(str, opacities)))}/>'
    )


def _list_captions(
    finding: StudyResult, piece: PredictedPiece
) -> list[tuple[float, float, list[str]]]:
    """Return what is said, with the seconds between which it is shown."""
    before, after = (
        format_quantity(float(np.linalg.norm(each[-1] - piece.measured[-1])), 'm', 2)
        for each in (piece.before, piece.after)
    )
    names = join_words([format_effect(one) for one in finding.effects])
    values = [format_estimate(each) for one in finding.effects for each in one.parameters]
    them = 'it' if len(values) == 1 else 'them'
    missing = [f'The model lacks {names}: {join_words(values)}']
    return [
        (0.0, MISS, ['A flight, and what the model predicts']),
        (MISS, NAMED, [f'After {piece.seconds:.0f} s it is {before} off']),
        (NAMED, SNAP, missing),
        (SNAP, LOOP, [*missing, f'With {them}: {after} off']),
    ]


def _draw_captions(captions: Sequence[tuple[float, float, list[str]]]) -> list[str]:
    return [
        f'<g opacity="0">{"".join(_draw_text(lines))}{_show(begin, end)}</g>'
        for begin, end, lines in captions
    ]


def _draw_text(lines: Sequence[str]) -> list[str]:
    return [
        f'<text class="caption" x="{WIDTH - 40:.0f}" y="{56 + 32 * k}">{escape(line)}</text>'
        for k, line in enumerate(lines)
    ]


def _draw_legend() -> list[str]:
    names = (('measured', 'measured'), ('before', 'vehicle file'), ('after', 'with the effect'))
    return [
        f'<path class="{kind}" d="M{24 + 150 * k} {HEIGHT - 22:.0f}h26"/>'
        f'<text class="soft" x="{58 + 150 * k}" y="{HEIGHT - 18:.0f}">{word}</text>'
        for k, (kind, word) in enumerate(names)
    ]


def _style() -> str:
    """Return the styles in both themes; without motion for those who ask for none."""
    rules = {
        '.paper': f'fill:{PAPER}',
        'path': 'fill:none;stroke-linecap:round;stroke-linejoin:round',
        '.grid': f'stroke:{GRID};stroke-width:1',
        '.axis': f'stroke:{SOFT};stroke-width:1',
        '.shadow': f'stroke:{GRID};stroke-width:5',
        '.rod': f'stroke:{ESTIMATE};stroke-width:1;opacity:.6',
        '.measured': f'stroke:{WALL};stroke-width:6',
        '.before': f'stroke:{ESTIMATE};stroke-width:2.5',
        '.after': f'stroke:{TRUTH};stroke-width:2.5',
        '.hull': f'fill:{WALL};fill-opacity:.3;stroke:{WALL};stroke-width:2',
        '.ghost': 'fill:none;stroke-width:1.5;stroke-dasharray:5 4',
        'text': 'font-family:system-ui,sans-serif',
        '.caption': f'fill:{INK};font-size:20px;font-weight:600;text-anchor:end',
        '.soft': f'fill:{SOFT};font-size:13px',
        '.end': 'text-anchor:end',
        '.still': 'display:none',
    }
    light = ''.join(f'{name}{{{rule}}}' for name, rule in rules.items())
    dark = light
    for colour in (PAPER, GRID, SOFT, ESTIMATE, WALL, TRUTH, INK):
        dark = dark.replace(colour, DARK[colour])
    calm = '.moving{display:none}.still{display:inline}'
    return (
        f'<style>{light}@media (prefers-color-scheme:dark){{{dark}}}'
        f'@media (prefers-reduced-motion:reduce){{{calm}}}</style>'
    )

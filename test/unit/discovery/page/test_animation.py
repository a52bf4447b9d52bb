"""The animation shows the piece that it was given, and the numbers of its ends."""

from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

from lta_discovery.finding import NamedEffect, ParameterEstimate
from lta_discovery.page import animation
from lta_discovery.page.animation import draw_piece, PredictedPiece
import numpy as np
import pytest

SVG = '{http://www.w3.org/2000/svg}'
LINE = np.column_stack([np.linspace(0.0, 3.0, 101), np.zeros(101), np.ones(101)])
# The model of the file ends 0.5 m to the left, the one with the effect 4 mm below
BEFORE = LINE + np.outer(np.linspace(0.0, 1.0, 101) ** 2, [0.0, 0.5, 0.0])
AFTER = LINE - np.outer(np.linspace(0.0, 1.0, 101), [0.0, 0.0, 0.004])
PIECE = PredictedPiece(5.0, LINE, BEFORE, AFTER, (0.7, 0.4))
EFFECT = NamedEffect(
    'linear_drag',
    ('linear_drag.surge',),
    (ParameterEstimate('surge', 'N s/m', 0.0, 0.046, (0.045, 0.047), True),),
    376.0,
)


@pytest.fixture(scope='module')
def root() -> ElementTree.Element:
    finding: Any = SimpleNamespace(effects=(EFFECT,))
    return ElementTree.fromstring(draw_piece(finding, PIECE))


def _list_values(root: ElementTree.Element, kind: str, tag: str = 'path') -> list[list[str]]:
    """Return the values of the animated shapes of a class."""
    moving = next(g for g in root.iter(f'{SVG}g') if g.get('class') == 'moving')
    shapes = [each for each in moving.iter(f'{SVG}{tag}') if each.get('class') == kind]
    return [next(iter(shape)).get('values', '').split(';') for shape in shapes]


def _read_path(text: str) -> np.ndarray:
    return np.array([[float(n) for n in pair.split()] for pair in text[1:].split('L')])


def test_the_captions_tell_the_ends_of_the_lines(root: ElementTree.Element) -> None:
    said = [text.text for text in root.iter(f'{SVG}text') if text.get('class') == 'caption']
    assert 'After 5 s it is 50 cm off' in said
    assert 'With it: 4 mm off' in said
    assert any(
        'linear drag (surge)' in line and '0.046' in line and 'N s/m' in line
        for line in map(str, said)
    )


def test_the_prediction_leaves_the_track_and_returns_to_it(root: ElementTree.Element) -> None:
    (measured,), (before, _), (after, _) = (
        _list_values(root, kind) for kind in ('measured', 'before', 'after')
    )
    assert before == after  # they differ in colour
    missed, ended = animation.FRAMES.searchsorted([animation.MISS, animation.END])
    scale = animation.SCENE[2] / _reach()
    track, file, new = (
        _read_path(each)[-1] for each in (measured[missed], before[missed], after[ended])
    )
    assert 0.4 * 0.5 * scale < np.linalg.norm(file - track) <= 0.5 * scale
    assert np.linalg.norm(new - _read_path(measured[ended])[-1]) <= 0.005 * scale


def _reach() -> float:
    """Return the largest distance from the middle of all lines, and half a hull. [m]"""
    middle = np.array([1.5, 0.25, 0.998])
    ends = np.array([[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [3.0, 0.5, 1.0], [3.0, 0.0, 0.996]])
    return float(np.linalg.norm(ends - middle, axis=1).max()) + 0.35


def test_all_shapes_stay_in_the_picture_and_can_be_interpolated(root: ElementTree.Element) -> None:
    for kind in ('measured', 'before', 'after', 'shadow'):
        for values in _list_values(root, kind):
            lines = np.stack([_read_path(each) for each in values])  # equal numbers of points
            assert len(lines) == len(animation.FRAMES)
            assert lines.min() > 0.0
            assert (lines < (animation.WIDTH, animation.HEIGHT)).all()


def test_the_error_of_the_chart_is_that_of_the_lines(root: ElementTree.Element) -> None:
    left, top, width, height = animation.CHART
    file = _read_path(_list_values(root, 'before')[1][-1])
    new = _read_path(_list_values(root, 'after')[1][-1])
    assert file[[0, -1]] == pytest.approx(
        np.array([[left, top + height], [left + width, top]]), abs=0.1
    )
    # 4 mm of 50 cm, and the square of the share of the time for the file
    assert new[-1] == pytest.approx([left + width, top + height * (1.0 - 0.008)], abs=0.1)
    share = (file[24, 0] - left) / width
    assert file[24, 1] == pytest.approx(top + height * (1.0 - share**2), abs=1.0)


def test_times_of_fades_rise_from_0_to_1(root: ElementTree.Element) -> None:
    keys = [each.get('keyTimes') for each in root.iter(f'{SVG}animate')]
    times = [[float(t) for t in each.split(';')] for each in keys if each is not None]
    assert len(times) >= 8
    for each in times:
        assert each[0] == 0.0
        assert each[-1] == 1.0
        assert each == sorted(each)

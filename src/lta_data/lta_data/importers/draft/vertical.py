"""Find which way is up: gravity, the tilt of a rotorcraft, names, heights."""

from typing import Final, final, NamedTuple

from lta_data.data_quality.motion import PoseSeries, VectorSeries
from lta_data.data_quality.motion_scales import fit_tilt, TILT
from lta_data.importers.draft.attitude_readings import MotionEvidence
from lta_data.importers.draft.choices import DraftChoices
from lta_data.importers.log_table import Numbers
import numpy as np
from scipy.spatial.transform import Rotation

Axes = str | list[str]
DOWN: Final = ['x', '-y', '-z']
LOW: Final = 0.05  # heights beyond it say where the floor is [m]
UP_BY_NAME: Final = {
    'ned': (-1, 'the names north, east, down'), 'latlonalt': (1, 'altitudes count up'),
}  # fmt: skip
CONFLICT: Final = 'world.up'


@final
class VerticalAxes(NamedTuple):
    """World and body axes as in a mapping, and why."""

    world: Axes
    body: Axes
    reason: str


def find_axes(
    evidence: MotionEvidence, turn: Rotation | None, axis_names: str, choices: DraftChoices
) -> VerticalAxes:
    """
    Return the axes of a log.

    Parameters
    ----------
    evidence : MotionEvidence
        In SI units, in the axes of the log.
    turn : Rotation or None
        From body to world, both of the log.
    axis_names : str
        Letters in the names of the position's columns, such as 'ned'.
    choices : DraftChoices
        For the question that remains.

    """
    if turn is None:
        return _find_without_attitude(evidence, axis_names, choices)
    level = np.abs(turn.as_matrix()[:, range(3), range(3)]).mean(axis=0)
    # The body axis that stays along its world axis while the vehicle yaws
    if level[1] > 0.9 and level[2] < 0.85:
        choices.add_reason('axes', [], 'Y_UP', 'the y axis of the body stays along that of the '
                           'world while the vehicle turns')  # fmt: skip
        return VerticalAxes('Y_UP', 'Y_UP', 'y up')
    same = float(np.mean(turn.as_matrix()[:, 2, 2])) > 0.0
    floats = choices.vehicle is not None and choices.vehicle.floats
    sign, why = _vote_up(evidence, turn, axis_names, None if floats else same)
    usual = choices.settled.get(CONFLICT, '')
    if not sign and usual:
        sign, why = (1 if usual == 'up' else -1), f'z {usual}, as messages of ROS have it'
    if not sign:
        options = [('up', 'z of the world points up'), ('down', 'z of the world points down')]
        answer = choices.decide(CONFLICT, options, why)
        sign, why = (1 if answer == 'up' else -1), choices.explain(CONFLICT)
    sign = {'up': 1, 'down': -1}.get(choices.override(CONFLICT, ''), sign)
    down: Axes = 'NED' if axis_names == 'ned' else DOWN
    body_up = sign if same else -sign
    axes = VerticalAxes('ENU' if sign > 0 else down, 'FLU' if body_up > 0 else 'FRD', why)
    choices.add_reason('axes: world', [], _format_axes(axes.world), why)
    relation = 'is along' if same else 'is opposite to'
    choices.add_reason('axes: body', [], _format_axes(axes.body),
                       f'z of the body {relation} z of the world')  # fmt: skip
    return axes


def _format_axes(axes: Axes) -> str:
    return axes if isinstance(axes, str) else f'[{", ".join(axes)}] (z down)'


def _vote_up(
    evidence: MotionEvidence, turn: Rotation, axis_names: str, same: bool | None
) -> tuple[int, str]:
    """
    Return whether z of the world points up (1) or down (-1), and why; 0 if nothing says it.

    `same`: whether z of the body is along that of the world; None if its tilt says nothing.
    """
    if evidence.acceleration is not None:
        pull = turn.apply(np.nan_to_num(evidence.acceleration)).mean(axis=0)
        size = float(np.linalg.norm(pull))
        if size > 3.0 and abs(pull[2]) > 0.7 * size:
            word = 'up' if pull[2] > 0.0 else 'down'
            return (1 if pull[2] > 0.0 else -1), (
                f'the accelerometer feels {abs(pull[2]):.3g} m/s2 along '
                f'{"+" if pull[2] > 0 else "-"}z at rest, so z points {word}'
            )
    if by_name := UP_BY_NAME.get(axis_names):
        return by_name
    by_height, why = _judge_heights(evidence.position)
    by_tilt, share = (0, 0.0) if same is None else _judge_tilt(evidence, turn, same)
    if by_tilt and by_height and by_tilt != by_height:
        return 0, f'{why}, but the vehicle accelerates against its tilt; both readings fit.'
    if by_tilt:
        return by_tilt, (
            f'the vehicle accelerates towards its tilt ({100 * share:.0f} % explained)'
            + (f'; {why}' if by_height else '')
        )
    if by_height:
        return by_height, why
    return 0, f'No accelerometer is there, and {_describe_heights(evidence.position)}.'


def _judge_heights(position: Numbers | None) -> tuple[int, str]:
    """Return which way is up if the floor is at zero."""
    if position is None:
        return 0, ''
    low, high = np.nanpercentile(position[:, 2], [2.0, 98.0])
    if low > -LOW and high > LOW:
        return 1, f'z is {low:.3g} to {high:.3g} m, and the floor is at zero'
    if high < LOW and low < -LOW:
        return -1, f'z is {low:.3g} to {high:.3g} m, and the floor is at zero'
    return 0, ''


def _describe_heights(position: Numbers | None) -> str:
    """Return why heights do not say which way is up."""
    if position is None:
        return 'no position shows where the floor is'
    low, high = np.nanpercentile(position[:, 2], [2.0, 98.0])
    return f'z is {low:.3g} to {high:.3g} m, on both sides of zero or next to it'


def _judge_tilt(evidence: MotionEvidence, turn: Rotation, same: bool) -> tuple[int, float]:
    """Return which way is up if a rotorcraft accelerates where its rotors push it."""
    if evidence.position is None:
        return 0, 0.0
    good = np.asarray(np.isfinite(evidence.position).all(axis=1))
    count = min(len(turn), len(evidence.seconds))
    later = np.diff(evidence.seconds, prepend=-np.inf) > 0.0
    rows = np.flatnonzero(good[:count] & later[:count])
    time = evidence.seconds[rows]
    pose = PoseSeries('', True, VectorSeries('', time, evidence.position[rows]),
                      VectorSeries('', time, turn[rows].as_quat()), None, None)  # fmt: skip
    fit = fit_tilt(pose)
    if abs(fit.cosine) < TILT:
        return 0, 0.0
    body_up = 1 if fit.cosine > 0.0 else -1
    return (body_up if same else -body_up), fit.cosine**2


def _find_without_attitude(
    evidence: MotionEvidence, axis_names: str, choices: DraftChoices
) -> VerticalAxes:
    """Return the axes by gravity in the body, and by heights in the world."""
    body: Axes = 'FLU'
    if evidence.acceleration is not None:
        felt = np.nanmedian(evidence.acceleration, axis=0)
        body = 'FRD' if felt[2] < 0.0 else 'FLU'
        choices.add_reason('axes: body', [], body, f'gravity at rest: {felt[2]:.3g} m/s2 along z')
    world: Axes = 'ENU'
    if evidence.position is not None:
        sign, why = UP_BY_NAME.get(axis_names) or _judge_heights(evidence.position)
        if not sign:
            options = [('up', 'z points up'), ('down', 'z points down')]
            why = f'No attitude is there, and {_describe_heights(evidence.position)}.'
            answer = choices.decide(CONFLICT, options, why)
            sign, why = (1 if answer == 'up' else -1), choices.explain(CONFLICT)
        sign = {'up': 1, 'down': -1}.get(choices.override(CONFLICT, ''), sign)
        down: Axes = 'NED' if axis_names == 'ned' else DOWN
        world = 'ENU' if sign > 0 else down
        choices.add_reason('axes: world', [], _format_axes(world), why)
    return VerticalAxes(world, body, '')

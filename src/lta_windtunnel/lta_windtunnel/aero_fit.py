# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Fit drag, rotor columns and coupling to a raw sweep, and collect its warnings.

    F = D1 v + D2 v^2,   D1, D2 >= 0

The fit of a drag minimises the squared relative errors (non-negative least squares, Lawson and
Hanson 1974), so that the slow points, at which a drone flies, count as much as the fast ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass
import math
from typing import Final, final

from lta_config.errors import BadInput
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_model import mass_properties
from lta_windtunnel import reduce
from lta_windtunnel.sweep_table import AXES, Axis, SweepPoint, TunnelSweep
from lta_windtunnel.thrust_allocation import linearity_ratio, transform_wrench
from lta_windtunnel.tunnel import INCIDENCES
from lta_windtunnel.tunnel_model import HULL_PATCH, QUARTER_TURN
import numpy as np
from scipy.optimize import nnls

TURN_AXIS: Final[dict[Axis, int]] = {'roll': 0, 'pitch': 1, 'yaw': 2}
ALONG: Final[dict[Axis, int]] = {'surge': 0, 'sway': 1, 'heave': 2}
# Equal after a quarter turn
SYMMETRIC_AXES: Final[dict[Axis, Axis]] = {'sway': 'surge', 'pitch': 'roll'}
MIN_SIDE_FORCE: Final = 0.05  # of the drag: smallest side force that is reported
MAX_MESH_CHANGE: Final = 0.1  # of the drag: largest change on a coarser mesh without a warning
MAX_JOINT_ERROR: Final = 0.05  # largest error of a fit through steady and transient points
# Spins are solved as steady rotation, but a flying hull oscillates about its attitude
UNSTEADY: Final = (
    'the damping of small fast oscillations is underestimated, because the flow was solved '
    'for a steady rotation'
)


@final
@dataclass(frozen=True, slots=True)
class DragFit:
    """Drag along or about one axis."""

    # N s/m and N s2/m2 along, N m s and N m s2 about an axis
    linear: float
    quadratic: float
    error: float  # largest relative error of the points [1]
    exponent: float  # exponent of a power law through the points; NaN for one point [1]

    def drag_at(self, speed: float) -> float:
        """Return the drag at a speed. [N or N m]."""
        return self.linear * speed + self.quadratic * speed**2


def fit_drag(speeds: Sequence[float], drags: Sequence[float]) -> DragFit:
    """
    Fit linear and quadratic drag to points of speed (m/s or rad/s) and drag (N or N m).

    Raise `BadInput` if a speed or a drag is not positive.
    """
    v, f = np.array(speeds, dtype=float), np.array(drags, dtype=float)
    if len(v) == 0 or len(v) != len(f) or not (np.all(v > 0.0) and np.all(f > 0.0)):
        raise BadInput(
            f'Cannot fit a drag curve to the drags {f.tolist()} at the speeds '
            f'{v.tolist()}: all must be positive. Inspect the flow at the speeds with zero '
            'or negative drag.'
        )
    # Divided by the drag, each row's target is 1: the errors are relative.
    matrix = np.column_stack((v / f, v**2 / f))
    if len(v) == 1:
        matrix[:, 0] = 0.0  # one point cannot determine two terms; use the quadratic one
    (linear, quadratic), _ = nnls(matrix, np.ones(len(v)))
    error = float(np.max(np.abs(matrix @ (linear, quadratic) - 1.0)))
    # Slope in logarithms: 1 for linear, 2 for quadratic drag
    exponent = float(np.polyfit(np.log(v), np.log(f), 1)[0]) if len(v) > 1 else float('nan')
    return DragFit(float(linear), float(quadratic), error, exponent)


def opposing_drag(axis: Axis, points: Sequence[SweepPoint]) -> list[float]:
    """Return the drag along or about an axis, positive where it opposes the motion. [N or N m]."""
    if axis in ALONG:
        # The vehicle moves along +axis, so that drag is negative
        return [-point.force[ALONG[axis]] for point in points]
    return [-point.moment[TURN_AXIS[axis]] for point in points]


def fit_drag_by_axis(sweep: TunnelSweep) -> dict[Axis, DragFit]:
    """Return the drag fit of each axis, from estimates by hand where no flow was solved."""
    fits: dict[Axis, DragFit] = {}
    for axis in AXES:
        fits[axis] = _fit_points(axis, select_fit_points(sweep, axis))
    return fits


def _fit_points(axis: Axis, points: Sequence[SweepPoint]) -> DragFit:
    return fit_drag([point.speed for point in points], opposing_drag(axis, points))


def select_fit_points(sweep: TunnelSweep, axis: Axis) -> Sequence[SweepPoint]:
    """
    Return the points for the fit of an axis.

    The slow point of a reference sweep comes from the steady model, whose wake does not shed. It
    is left out if no drag fit matches both points.
    """
    points = select_axis_points(sweep, axis)
    # Only reference sweeps mix steady (slow) and transient (fast) points
    if sweep.fidelity != 'reference' or not select_solved_points(sweep, axis) or axis in TURN_AXIS:
        return points
    return points if _fit_points(axis, points).error <= MAX_JOINT_ERROR else points[-1:]


def select_solved_points(sweep: TunnelSweep, axis: Axis) -> Sequence[SweepPoint]:
    """Return the solved points of an axis, or of the axis equivalent by symmetry; else none."""
    like = SYMMETRIC_AXES.get(axis)
    if axis in sweep.axes or like is None or QUARTER_TURN.tolist() not in list(sweep.symmetries):
        return sweep.axes.get(axis, ())
    return [_rotate_point(point) for point in sweep.axes.get(like, ())]


def _rotate_point(point: SweepPoint) -> SweepPoint:
    """Rotate a point of a motion along or about x to the same motion along or about y."""
    # A quarter turn about z maps x to y
    wrench = transform_wrench(np.array([*point.force, *point.moment]), QUARTER_TURN).tolist()
    return point.model_copy(update={'force': wrench[:3], 'moment': wrench[3:]})


def select_axis_points(sweep: TunnelSweep, axis: Axis) -> Sequence[SweepPoint]:
    """Return the solved points of an axis, or else the estimates by hand."""
    points = select_solved_points(sweep, axis) or sweep.by_hand.get(axis)
    if not points:
        raise BadInput(
            f'The wind tunnel results of {sweep.name} have no values for {axis}; run lta '
            'cfd again.'
        )
    return points


def collect_warnings(sweep: TunnelSweep) -> list[str]:
    """Return warnings for users of the fitted coefficients."""
    warnings: list[str] = []
    for axis in AXES:
        points = select_solved_points(sweep, axis)
        if not points:
            if sweep.fidelity != 'analytic':
                warnings.append(f'{axis}: analytic estimate, no flow was solved')
            continue
        ratio = ratio_to_estimate(sweep, axis)
        if not reduce.is_near_estimate(ratio, 1.0):
            warnings.append(
                f'{axis}: the drag is {ratio:.2f} times the analytic estimate; check the flow'
            )
        coarser = mesh_share(sweep, axis)
        if coarser is not None and abs(coarser) > MAX_MESH_CHANGE:
            warnings.append(
                f'{axis}: on a coarser mesh, the drag changes by {100 * coarser:+.0f} %'
            )
    if any(axis in sweep.axes for axis in TURN_AXIS):
        warnings.append(f'roll, pitch, yaw: {UNSTEADY}')
    if sweep.fidelity == 'preview':
        warnings.append(
            'steady flow model: for a sphere, its drag is correct at 0.2 m/s and up to 30 '
            '% low at 2 m/s'
        )
    tops = [
        select_solved_points(sweep, axis)[-1].speed
        for axis in ALONG
        if select_solved_points(sweep, axis)
    ]
    if sweep.fidelity == 'reference' and tops:
        # A reference solves two speeds; the faster one bounds the range of the fit
        warnings.append(f'drag above {min(tops):g} m/s is extrapolated')
        warnings += [
            _format_omission_warning(sweep, axis) for axis in ALONG if _is_unjoined(sweep, axis)
        ]
    for pattern in sweep.blows:
        share = linearity_ratio(sweep, pattern)
        if share is not None and abs(share - 1.0) > 0.05:
            warnings.append(
                f'{pattern}: force and moment are not proportional to the thrust: at '
                f'partial thrust, they are {share:.2f} times the expected values'
            )
    warnings += [f'{name}: refused: {reason}' for name, reason in sweep.refused.items()]
    return warnings


def _is_unjoined(sweep: TunnelSweep, axis: Axis) -> bool:
    return len(select_fit_points(sweep, axis)) < len(select_axis_points(sweep, axis))


def _format_omission_warning(sweep: TunnelSweep, axis: Axis) -> str:
    """Return the warning about a slow reference point that is left out."""
    slow = select_axis_points(sweep, axis)[0]
    share = opposing_drag(axis, [slow])[0] / _fit_points(
        axis, select_fit_points(sweep, axis)
    ).drag_at(slow.speed)
    return (
        f'{axis}: the drag of the steady flow at {slow.speed:g} m/s differs by '
        f'{100 * (share - 1):+.0f} % from the fit to the transient flow, so it is left out '
        'of the fit'
    )


def middle_speed_point(sweep: TunnelSweep, axis: Axis) -> SweepPoint:
    """Return the middle speed of an axis."""
    points = select_axis_points(sweep, axis)
    return points[len(points) // 2]


def ratio_to_estimate(sweep: TunnelSweep, axis: Axis) -> float:
    """Return the drag at the middle speed over the estimate by hand. [1]."""
    middle = middle_speed_point(sweep, axis)
    return opposing_drag(axis, [middle])[0] / interpolate_estimate(sweep, axis, middle.speed)


def mesh_share(sweep: TunnelSweep, axis: Axis) -> float | None:
    """Return the relative change of the drag on a coarser mesh; None if none was solved. [1]."""
    coarse = sweep.coarse.get(axis)
    fine = [point for point in sweep.axes.get(axis, ()) if coarse and point.speed == coarse.speed]
    if coarse is None or not fine:
        return None
    return opposing_drag(axis, [coarse])[0] / opposing_drag(axis, fine)[0] - 1.0


def hull_share(sweep: TunnelSweep, axis: Axis) -> float | None:
    """Return the hull's share of the drag at the middle speed; None by hand. [1]."""
    parts = middle_speed_point(sweep, axis).parts
    return parts[HULL_PATCH] / sum(parts.values()) if parts else None


def sum_processor_time(sweep: TunnelSweep) -> float:
    """Return the processor time of all flows, without meshes. [s]."""
    points = [point for axis in sweep.axes.values() for point in axis]
    points += [*sweep.coarse.values(), *sweep.inclined.values()]
    evidence = [each.evidence for each in points]
    evidence += [each.evidence for each in sweep.blows.values()]
    return sum(each.seconds for each in evidence)


def interpolate_estimate(sweep: TunnelSweep, axis: Axis, speed: float) -> float:
    """Interpolate the estimate by hand for an axis at a speed [N or N m]."""
    points = sweep.by_hand[axis]
    # Drag is close to a power law, which is a straight line in logarithms
    speeds = np.log([point.speed for point in points])
    return math.exp(float(np.interp(math.log(speed), speeds, np.log(opposing_drag(axis, points)))))


def describe_side_loads(sweep: TunnelSweep) -> dict[str, str]:
    """Return force and moment of each direction at its middle speed, unless negligible."""
    loads: dict[str, str] = {}
    for axis, k in ALONG.items():
        points = select_solved_points(sweep, axis)
        if not points:
            continue
        point = points[len(points) // 2]
        drag = abs(point.force[k])
        sides = [each for j, each in enumerate(point.force) if j != k]
        if math.hypot(*sides) > MIN_SIDE_FORCE * drag:
            force = ', '.join(f'{each:.3g}' for each in point.force)
            moment = ', '.join(f'{each:.3g}' for each in point.moment)
            loads[axis] = f'at {point.speed:g} m/s force ({force}) N, moment ({moment}) N m'
    return loads


@final
@dataclass(frozen=True, slots=True)
class InclinedFlow:
    """Forces and moment at one incidence, each beside what the model flies."""

    incidence: float  # deg
    point: SweepPoint
    by_axis: tuple[float, float]  # drag by axis along body x and z [N]
    munk: float  # moment of attached flow about body y [N m]
    normal: float  # force along body z beyond the drag by axis [N]
    lift_slope: float  # of that force's coefficient, on the hull's shadow from above [1/rad]

    @property
    def lost(self) -> float:
        """Return the missing share of the Munk moment [1]."""
        return 1.0 - self.point.moment[1] / self.munk


def compare_inclined_flows(sweep: TunnelSweep) -> list[InclinedFlow]:
    """Return the flows of a sweep with the nose up, by incidence; level flight has no moment."""
    fits = fit_drag_by_axis(sweep)
    along, _, upright, *_ = mass_properties.added_mass(
        load_vehicle_file(sweep.vehicle).hull, sweep.density
    )
    comparisons = []
    for name, point in sweep.inclined.items():
        angle = math.radians(INCIDENCES[name])
        c, s = math.cos(angle), math.sin(angle)
        forward, down = point.speed * c, point.speed * s
        by_axis = (-fits['surge'].drag_at(forward), fits['heave'].drag_at(down))
        normal = point.force[2] - by_axis[1]
        pressure = 0.5 * sweep.density * point.speed**2
        comparisons.append(
            InclinedFlow(
                INCIDENCES[name],
                point,
                by_axis,
                # -(v x A v) about y, for v = (forward, 0, -down)
                (along - upright) * forward * down,
                normal,
                normal / (pressure * sweep.frontal[2] * angle),
            )
        )
    return sorted(comparisons, key=lambda flow: flow.incidence)

"""Build the tables of a sweep and of the validation."""

from collections.abc import Sequence
import math

from lta_report.report import TextTable
from lta_windtunnel.aero_fit import (
    fit_drag_by_axis,
    hull_share,
    mesh_share,
    middle_speed_point,
    ratio_to_estimate,
    select_fit_points,
    select_solved_points,
)
from lta_windtunnel.incidence import compare_inclined_flows
from lta_windtunnel.sweep_table import TunnelSweep
from lta_windtunnel.thrust_allocation import linearity_ratio, sum_columns
from lta_windtunnel.validation import SphereComparison


def build_drag_table(sweep: TunnelSweep) -> TextTable:
    """Return the table of linear and quadratic drag of each axis, with quality measures."""
    rows = []
    for axis, fit in fit_drag_by_axis(sweep).items():
        points = select_fit_points(sweep, axis)
        middle = middle_speed_point(sweep, axis)
        rows.append([
            axis, f'{fit.linear:.2g}', f'{fit.quadratic:.3g}', f'{100 * fit.error:.1f}',
            '' if math.isnan(fit.exponent) else f'{fit.exponent:.2f}',
            f'{100 * max(p.evidence.spread for p in points):.1f}',
            f'{middle.evidence.cells}' if select_solved_points(sweep, axis) else 'estimate',
            _format_percent(mesh_share(sweep, axis), '+.0f'),
            _format_percent(hull_share(sweep, axis), '.0f'),
            f'{ratio_to_estimate(sweep, axis):.2f}',
        ])  # fmt: skip
    heads = [
        'axis', 'D1', 'D2', 'fit error [%]', 'exponent', 'spread [%]', 'cells', 'mesh [%]',
        'hull [%]', 'ratio to estimate',
    ]  # fmt: skip
    note = (
        'D1 (linear drag) in N s/m and N m s, D2 (quadratic drag) in N s2/m2 and N m s2, '
        'about the hull centre. Fit error: at the worst point. At the middle speed: mesh, '
        'additional drag on a coarser mesh; hull, share of the hull in the drag; ratio to '
        'estimate, drag divided by the analytic estimate.'
    )
    return TextTable('Drag', heads, rows, note)


def _format_percent(share: float | None, form: str) -> str:
    return '' if share is None else f'{100 * share:{form}}'


def _format_thousandths(value: float, digits: int) -> str:
    return f'{round(1e3 * value, digits) + 0.0:.{digits}f}'  # + 0.0 turns -0.0 into 0.0


def build_rotor_table(sweep: TunnelSweep) -> TextTable:
    """Return the table of net wrenches, compared with the sum of single rotors."""
    rows = []
    for name, blown in sweep.blows.items():
        sum_ = sum_columns(sweep, blown.shares)
        share = linearity_ratio(sweep, name)
        rows.append([
            name.replace('_', ' '), *(_format_thousandths(each, 0) for each in blown.force),
            *(_format_thousandths(each, 1) for each in blown.moment),
            '' if sum_ is None or len(blown.shares) < 2 else _format_thousandths(sum_[2], 0),
            '' if share is None else f'{share:.3f}',
            f'{100 * (blown.evidence.balance or 0.0):.2f}',
        ])  # fmt: skip
    heads = [
        'rotors', 'Fx [mN]', 'Fy', 'Fz', 'Mx [mN m]', 'My', 'Mz', 'Fz of sum', 'quarter',
        'balance [%]',
    ]  # fmt: skip
    note = (
        'Net force and moment about the hull centre, including the thrust. Fz of sum: the '
        'sum of the rotors running one at a time. Quarter: force at a quarter of the thrust '
        'divided by a quarter of the force at full thrust; 1 if linear. Balance: difference '
        'between the force and the momentum of the air, relative to the force.'
    )
    return TextTable('Rotors on', heads, rows, note)


def build_incidence_table(sweep: TunnelSweep) -> TextTable:
    """Return the table of forward flight with the nose up, beside what the model flies."""
    rows = [
        [
            f'{flow.incidence:.0f}',
            _format_thousandths(flow.point.force[0], 1),
            _format_thousandths(flow.by_axis[0], 1),
            _format_thousandths(flow.point.force[2], 1),
            _format_thousandths(flow.by_axis[1], 1),
            f'{flow.lift_slope:.2f}',
            _format_thousandths(flow.point.moment[1], 2),
            _format_thousandths(flow.munk, 2),
            f'{flow.lost:.2f}',
            f'{100 * flow.point.evidence.spread:.1f}',
        ]
        for flow in compare_inclined_flows(sweep)
    ]
    heads = [
        'incidence [deg]', 'Fx [mN]', 'by axis', 'Fz [mN]', 'by axis', 'lift slope', 'My [mN m]',
        'Munk', 'lost', 'spread [%]',
    ]  # fmt: skip
    note = (
        'Force and moment in body axes about the hull centre at 1 m/s, with the nose up by the '
        'incidence; a negative My raises it further. By axis: the drag of surge and heave, each '
        'at its part of the speed. Lift slope: the force Fz beyond that, as a coefficient by '
        'radian on the shadow of the hull from above; the effect oblique_lift has it as '
        'lift and stall. Munk: the moment of attached flow. Lost: the share of it that is '
        'missing, the value of the effect munk_moment. Spread: of the drag.'
    )
    return TextTable('Nose up', heads, rows, note)


def build_sphere_table(results: Sequence[SphereComparison]) -> TextTable:
    """Return the table of the sphere, compared with measurements."""
    rows = [
        [
            each.setting, f'{each.reynolds:.2g}', f'{each.coefficient:.3f}',
            f'{100 * each.error:.1f}', f'{each.measured:.3f}',
            f'{100 * (each.coefficient / each.measured - 1.0):+.0f}', f'{100 * each.off:+.0f}',
            f'{each.seconds:.0f}',
        ]
        for each in results
    ]  # fmt: skip
    heads = [
        'setting', 'Re', 'Cd', 'error [%]', 'Morrison', 'from Morrison [%]', 'from scatter [%]',
        'CPU s',
    ]  # fmt: skip
    note = (
        'Error: standard error of the mean of a transient flow, or standard deviation of a '
        'steady flow over its averaging window. From scatter: deviation from the measured '
        "range, which reaches from Morrison's value to the 0.50 of Achenbach."
    )
    return TextTable('Sphere', heads, rows, note)

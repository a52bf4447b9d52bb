"""Tables of a sweep, for page and terminal."""

import math

from lta_sim.cfd.aero_fit import (
    fit_axes,
    hull_share,
    mesh_share,
    middle_point,
    ratio_to_estimate,
    select_fit_points,
    select_solved_points,
)
from lta_sim.cfd.sweep_table import TunnelSweep
from lta_sim.cfd.thrust_allocation import linearity_ratio, sum_columns
from lta_sim.cfd.validation import SphereComparison
from lta_studies.energy.tables import TextTable


def build_drag_table(sweep: TunnelSweep) -> TextTable:
    """Return linear and quadratic drag of each axis, how well they fit, and what is beside."""
    rows = []
    for axis, fit in fit_axes(sweep).items():
        points = select_fit_points(sweep, axis)
        middle = middle_point(sweep, axis)
        rows.append([
            axis, f'{fit.linear:.2g}', f'{fit.quadratic:.3g}', f'{100 * fit.error:.1f}',
            '' if math.isnan(fit.exponent) else f'{fit.exponent:.2f}',
            f'{100 * max(p.evidence.spread for p in points):.1f}',
            f'{middle.evidence.cells}' if select_solved_points(sweep, axis) else 'by hand',
            _format_percent(mesh_share(sweep, axis), '+.0f'),
            _format_percent(hull_share(sweep, axis), '.0f'),
            f'{ratio_to_estimate(sweep, axis):.2f}',
        ])  # fmt: skip
    heads = [
        'axis', 'D1', 'D2', 'fit error [%]', 'exponent', 'spread [%]', 'cells', 'mesh [%]',
        'hull [%]', 'over hand',
    ]  # fmt: skip
    note = (
        'D1 in N s/m and N m s, D2 in N s2/m2 and N m s2, about the hull centre. Fit error: the '
        'worst point. At the middle point: mesh, how much more drag there is on a coarser one; '
        'hull, its share of the drag; over hand, the drag over the estimate by hand.'
    )
    return TextTable('Drag', heads, rows, note)


def _format_percent(share: float | None, form: str) -> str:
    return '' if share is None else f'{100 * share:{form}}'


def _format_thousandths(value: float, digits: int) -> str:
    return f'{round(1e3 * value, digits) + 0.0:.{digits}f}'  # no minus before a nought


def build_rotor_table(sweep: TunnelSweep) -> TextTable:
    """Return the net wrench of all that blew, and what the sum of single rotors says."""
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
        'Net, the thrust itself included, about the hull centre. Fz of sum: of the single rotors. '
        'Quarter: the wrench at a quarter of the thrust over a quarter of the whole one, 1 where '
        'it is linear. Balance: force that is not in the momentum of the air.'
    )
    return TextTable('Rotors on', heads, rows, note)


def build_sphere_table(results: list[SphereComparison]) -> TextTable:
    """Return the sphere beside what was measured."""
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
        'setting', 'Re', 'Cd', 'error [%]', 'Morrison', 'off it [%]', 'off scatter [%]',
        'CPU s',
    ]  # fmt: skip
    note = (
        'Error: standard error of a transient, standard deviation of the window of a steady '
        'flow. Scatter: from Morrison to the 0.50 that Achenbach measured.'
    )
    return TextTable('Sphere', heads, rows, note)

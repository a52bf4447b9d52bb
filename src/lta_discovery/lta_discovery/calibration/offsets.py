"""Find calibration numbers that a discovery had to move far from the vehicle file."""

from collections.abc import Sequence
import math
from typing import Final

from lta_discovery.fit.joint_fit import JointFit
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter, NET_LIFT
from lta_discovery.page.formatting import append_unit, format_parameter

FAR: Final = 3.5  # tolerances; one in two thousand values of a correct file is further off
KINDS: Final = {True: 'force', False: 'moment'}
FORCES: Final = ('surge', 'sway', 'heave')


def list_calibration_offsets(
    nominal: NominalVehicle,
    knobs: Sequence[FreeParameter],
    fit: JointFit,
    names: Sequence[str],
    named: Sequence[str],
) -> tuple[str, ...]:
    """
    Return what a calibration should settle, one clause each.

    `fit`: of the flights, with tolerances and named effects. `names`: of the flights. `named`:
    parameters of named effects, which are reported as such.
    """
    out = []
    for k, knob in enumerate(knobs):
        if not knob.is_calibration or knob.name in named:
            continue
        limit = FAR * knob.tolerance
        change = float(fit.fitted.mean[k])
        if knob.name == NET_LIFT:
            out += _list_lifts(k, limit, fit, names)
        elif not knob.per_flight and 0.0 < limit < abs(change):
            out.append(_format_offset(nominal, knob, change))
    return tuple(out)


def _list_lifts(k: int, limit: float, fit: JointFit, names: Sequence[str]) -> list[str]:
    """Return the flights with a net lift far from that of the file."""
    lifts = [float(one.fitted.mean[k]) for one in fit.members]
    return [
        f'net lift of {name}: {1e3 * lift:.1f} mN'
        for name, lift in zip(names, lifts, strict=True)
        if abs(lift) > limit
    ]


def _format_offset(nominal: NominalVehicle, knob: FreeParameter, change: float) -> str:
    """Return one offset in words."""
    effect, _, part = knob.name.partition('.')
    if effect == 'wrench_gain':
        share = 100.0 * (nominal.parameter_value(effect, part) + change)
        return f'{part}: {share:.0f} % of the commanded {KINDS[part in FORCES]} arrives'
    if effect == 'vehicle':  # the logarithm of a factor
        size = f'{100.0 * math.expm1(change):+.0f} %'
    else:
        size = append_unit(f'{change:+.3g}', knob.unit)
    return f'{format_parameter(knob.name)}: {size} from the vehicle file'


def format_calibration_warning(offsets: Sequence[str]) -> list[str]:
    """Return a warning that the vehicle should be calibrated first, if it should."""
    if not offsets:
        return []
    return [
        f'The vehicle file is off by more than its tolerances explain ({"; ".join(offsets)}). '
        'Calibrate it first with "lta calibrate", and study the flights with calibrated.yaml.'
    ]

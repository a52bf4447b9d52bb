# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Estimate the daily loss of lift by helium that permeates the hull film, and its days.

    rate = q S (rho_air - rho_he)

q is the permeability of the film and S its area. Aerostat laminates have 0.636 to 0.882
L/(m2 day atm) when new and 0.20 to 0.22 after 18 months (Frontiers in Materials 2022, 992984).
No value for the foil of toy balloons was found, so 0.2 to 0.9 is assumed for all hulls.
A foil balloon has the surface pi^2 r^2 of the mylar shape (Paulsen 1994).
"""

from collections.abc import Iterator
import math

from lta_config.constants import HELIUM_TO_AIR, STANDARD_GRAVITY
from lta_config.schema.vehicle_body import HullBlock
from lta_model import mass_properties as hulls
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.mass_budget import GRAMS, HULL_BLOCKS
from lta_vehicle.figures.thrust_envelope import CARRIED_BLOCKS
from lta_vehicle.figures.wrench_limit import solve_wrench_limit

LEAK_RANGE = (0.2e-3, 0.9e-3)  # m3/(m2 day)
SOURCE = (
    'assumed: permeability of airship laminates, 0.2 to 0.9 L/(m² day) (Frontiers Mater. '
    '2022, 992984)'
)


def film_area(hull: HullBlock) -> float:
    """Return the area of the film; 0 without a hull [m2]."""
    a, b, c = hulls.half_axes(hull)
    if hull.shape == 'balloon':
        # Area of the smooth shape, without the creases of the foil near the seam
        return (math.pi * a) ** 2
    if hull.shape == 'none':
        return 0.0
    if hull.shape == 'sphere':
        return 4.0 * math.pi * a * a
    lengths = sorted((a, b, c))
    across = lengths[1]  # of the three half axes, two are equal
    along = lengths[0] if lengths[1] == lengths[2] else lengths[2]
    return _spheroid_area(across, along)


def _spheroid_area(across: float, along: float) -> float:
    """Return the surface of a spheroid from its half axes [m2]."""
    if across == along:
        return 4.0 * math.pi * across**2
    if along > across:
        # Prolate: e is the eccentricity of the meridian
        e = math.sqrt(1.0 - (across / along) ** 2)
        return 2.0 * math.pi * across**2 * (1.0 + along / (across * e) * math.asin(e))
    # Oblate
    e = math.sqrt(1.0 - (along / across) ** 2)
    return 2.0 * math.pi * across**2 * (1.0 + (1.0 - e * e) / e * math.atanh(e))


def daily_lift_loss(hull: HullBlock, air_density: float) -> tuple[float, float]:
    """Return the lowest and highest expected loss of lift [kg/day]."""
    # Lift per volume: each lost cubic metre of helium no longer displaces air
    density = air_density * (1.0 - HELIUM_TO_AIR)
    low, high = (flow * film_area(hull) * density for flow in LEAK_RANGE)
    return low, high


HELIUM = 'Helium'


def tolerable_lift_loss(vehicle: Vehicle) -> float | None:
    """Return the loss of lift up to which it can hover; None if it cannot hover now [kg]."""
    up = solve_wrench_limit(vehicle, 'up')
    if up is None:
        return None
    # `most` is the total upward force [N]; the heaviness [kg] is already carried
    spare = up.most / STANDARD_GRAVITY - vehicle.heaviness
    return spare if spare > 0.0 else None


def derive_helium_figures(vehicle: Vehicle, held: float | None = None) -> Iterator[DerivedFigure]:
    """
    Yield the figures of the group 'Helium'.

    `held`: loss of lift up to which simulated flights stayed stable, if this was tested [kg].
    """
    low, high = daily_lift_loss(vehicle.file.hull, vehicle.air_density)
    # No hull, hence no film
    if high <= 0.0:
        return
    for key, words, rate in (
        ('leak_low', 'lift lost by helium leakage, at least', low),
        ('leak_high', 'lift lost by helium leakage, at most', high),
    ):
        yield DerivedFigure(key, HELIUM, words, GRAMS * rate, 'g/day', SOURCE, HULL_BLOCKS, 2)
    spare = tolerable_lift_loss(vehicle)
    note = 'it cannot hover now' if spare is None else format_leak_days(spare, low, high)
    yield DerivedFigure(
        'hover_loss',
        HELIUM,
        'can hover up to a lift loss of',
        None if spare is None else GRAMS * spare,
        'g',
        'upward thrust minus the carried weight',
        CARRIED_BLOCKS,
        1,
        note,
    )
    if held is not None:
        yield DerivedFigure(
            'gains_loss',
            HELIUM,
            'controller stable up to a lift loss of',
            GRAMS * held,
            'g',
            'simulated closed-loop flights with increasing weight',
            (),
            1,
            format_leak_days(held, low, high),
        )


def format_leak_days(loss: float, low: float, high: float) -> str:
    """Return the days until a loss of lift, at the highest and the lowest leak rate."""
    return (
        f'after {loss / high:.0f} to {loss / low:.0f} days of leakage' if loss > 0.0 else 'at once'
    )

"""Derive the helium leak and the time until the rotors cannot compensate for it."""

from collections.abc import Iterator

from lta_config.constants import STANDARD_GRAVITY
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.helium_leak import daily_lift_loss, SOURCE
from lta_vehicle.figures.mass_budget import GRAMS, HULL
from lta_vehicle.figures.thrust_envelope import CARRIED
from lta_vehicle.figures.wrench_limit import solve_wrench_limit

HELIUM = 'Helium'


def tolerable_lift_loss(vehicle: Vehicle) -> float | None:
    """Return the loss of lift up to which it can hover; None if it cannot hover now. [kg]"""
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
        yield DerivedFigure(key, HELIUM, words, GRAMS * rate, 'g/day', SOURCE, HULL, 2)
    spare = tolerable_lift_loss(vehicle)
    note = 'it cannot hover now' if spare is None else format_leak_days(spare, low, high)
    yield DerivedFigure(
        'hover_loss',
        HELIUM,
        'can hover up to a lift loss of',
        None if spare is None else GRAMS * spare,
        'g',
        'upward thrust minus the carried weight',
        CARRIED,
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

"""How long the helium lasts: what leaks, and when the rotors can no longer carry the loss."""

from collections.abc import Iterator

from lta_config.constants import STANDARD_GRAVITY
from lta_model.vehicle import Vehicle
from lta_vehicle.figures.figure import DerivedFigure
from lta_vehicle.figures.helium_leak import daily_lift_loss, SOURCE
from lta_vehicle.figures.mass_budget import GRAMS, HULL
from lta_vehicle.figures.thrust_envelope import CARRIED
from lta_vehicle.figures.wrench_limit import solve_wrench_limit

HELIUM = 'Helium'


def lift_margin(vehicle: Vehicle) -> float | None:
    """Return how much lift may be lost before it cannot hover; None if it cannot now. [kg]."""
    up = solve_wrench_limit(vehicle, 'up')
    if up is None:
        return None
    spare = up.most / STANDARD_GRAVITY - vehicle.heaviness
    return spare if spare > 0.0 else None


def derive_helium_figures(vehicle: Vehicle, held: float | None = None) -> Iterator[DerivedFigure]:
    """
    Yield what the hull loses and what that means.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    held : float or None
        Loss up to which its gains were flown and held, where that was asked for. [kg]

    """
    low, high = daily_lift_loss(vehicle.file.hull, vehicle.air_density)
    if high <= 0.0:
        return
    for key, words, rate in (
        ('leak_low', 'loses at least', low),
        ('leak_high', 'loses at most', high),
    ):
        yield DerivedFigure(key, HELIUM, words, GRAMS * rate, 'g/day', SOURCE, HULL, 2)
    spare = lift_margin(vehicle)
    note = 'it cannot hover now' if spare is None else format_leak_days(spare, low, high)
    yield DerivedFigure(
        'hover_loss',
        HELIUM,
        'cannot hover after a loss of',
        None if spare is None else GRAMS * spare,
        'g',
        'push up less what it carries',
        CARRIED,
        1,
        note,
    )
    if held is not None:
        yield DerivedFigure(
            'gains_loss',
            HELIUM,
            'gains hold up to a loss of',
            GRAMS * held,
            'g',
            'flown in the loop, heavier and heavier',
            (),
            1,
            format_leak_days(held, low, high),
        )


def format_leak_days(loss: float, low: float, high: float) -> str:
    """Return in how many days a loss comes about, at the most and the least that leaks."""
    return f'{loss / high:.0f} to {loss / low:.0f} days' if loss > 0.0 else 'at once'

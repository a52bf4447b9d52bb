"""A draught is a small horizontal force that is alike in all directions and follows nothing."""

from lta_discovery.fit.evidence import FLOOR, wrench_floor
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.unmodeled.draught import (
    detect_draught,
    DraughtEstimate,
    estimate_air_speed,
    is_horizontally_isotropic,
    isotropy_p_value,
)
from lta_discovery.unmodeled.latent_series import LatentSeries
from lta_discovery.unmodeled.rivals import GenericRival
from lta_discovery.unmodeled.unexplained_force import Remainder
import numpy as np
import pytest

from .latent_draws import process, times, turning

Known = tuple[NominalVehicle, list[FreeParameter]]
# Floors of a draught of 1.1 mN for a GT-MAB; what is missing nowhere leaves as much of the others.
FLOORS = np.array([2.75, 2.75, 0.3, 1.2, 1.3, 0.5])
SURGE, SWAY = Remainder('surge', 1.1e-3, 2.75, (), 0.05), Remainder('sway', 1.1e-3, 2.75, (), 0.0)
ONE = GenericRival(
    'surge by one-sided speed', 13.3, 18.7, 25.1, 'surge', ('surge',), 8e-4, 'speed', 0.64
)  # fmt: skip


def _pair(scale: tuple[float, float, float], rate: float = 0.5) -> list[LatentSeries]:
    """Return two flights in air that pushes so much along x, y and z of the map. [floors]"""
    rng = np.random.default_rng(8)
    out = []
    for seconds in (64.0, 72.0):
        drawn = process(rng, len(times(seconds)), 6) * FLOOR
        drawn[:, :3] *= scale
        out.append(turning(drawn[:, :3], drawn[:, 3:], rate))
    return out


AIR = _pair((2.75, 2.75, 0.3))


def _found(known: Known, **given: object) -> DraughtEstimate | None:
    """Return the draught of a GT-MAB in air of 2.75 floors, with something else."""
    nominal, floor = known[0], wrench_floor(known[0])
    asked = {'floors': FLOORS, 'left': [SURGE, SWAY], 'rivals': [], 'series': AIR} | given
    deviations = np.asarray(asked['floors']) * floor
    return detect_draught(
        deviations, floor, asked['left'], asked['rivals'], asked['series'], nominal
    )


def test_the_chance_of_being_alike_is_that_of_mauchlys_test() -> None:
    # Squares of 4 and 1, four products each: 4 x 4 x 4 x 1 / (20 / 2)^2 is 0.64.
    pair = np.array([[2.0, 1.0], [2.0, -1.0], [-2.0, 1.0], [-2.0, -1.0]])
    assert isotropy_p_value(pair, 5.0) == pytest.approx(0.64**2)
    assert isotropy_p_value(pair, 21.0) == pytest.approx(0.64**10)
    assert isotropy_p_value(pair / [2.0, 1.0], 21.0) == pytest.approx(1.0)
    assert isotropy_p_value(np.zeros((4, 2)), 21.0) == 1.0


def test_the_chance_holds_in_draws() -> None:
    rng = np.random.default_rng(3)
    chances = [isotropy_p_value(rng.standard_normal((20, 2)), 20.0) for _ in range(2000)]
    # One in ten below 0.1, give or take three of its deviations of 0.7 %. The mean is known to be
    # 0, so that there is one value more than the test takes.
    assert np.mean(np.array(chances) < 0.1) == pytest.approx(0.1, abs=0.03)


@pytest.mark.parametrize(
    ('scale', 'rate', 'expected'),
    [
        ((2.75, 2.75, 0.3), 0.5, True),
        ((2.75, 2.75, 0.3), 0.0, True),
        ((2.75, 0.9, 0.3), 0.5, False),  # along one way of the map
        ((2.75, 2.75, 2.75), 0.5, False),  # up and down as well
    ],
)
def test_a_draught_is_horizontal_and_alike_in_the_map(
    scale: tuple[float, float, float], rate: float, expected: bool
) -> None:
    assert is_horizontally_isotropic(_pair(scale, rate)) == expected


def test_a_force_of_the_body_is_no_draught_though_it_turns_with_the_heading() -> None:
    # A force ahead that turns with the vehicle is alike along x and y of the map.
    out = []
    for each in AIR:
        ahead = each.body.copy()
        ahead[:, 1] *= 0.2
        c, s = np.cos(0.5 * each.time), np.sin(0.5 * each.time)
        x, y = ahead[:, 0], ahead[:, 1]
        out.append(LatentSeries(each.time, np.column_stack([c * x - s * y, s * x + c * y,
                                                            ahead[:, 2]]), ahead))  # fmt: skip
    ground = np.sqrt(np.mean(np.concatenate([each.ground for each in out]) ** 2, axis=0))
    assert ground[0] / ground[1] == pytest.approx(1.0, abs=0.25)
    assert not is_horizontally_isotropic(out)


def test_a_draught_has_its_force_and_the_speed_of_the_air(gtmab: Known) -> None:
    found = _found(gtmab)
    assert found is not None
    assert found.force == pytest.approx(2.75 * float(wrench_floor(gtmab[0])[0]))
    assert found.sentence.startswith('a draught: a random horizontal force of 1.1 mN')


def test_the_speed_is_force_by_the_mass_of_the_air_times_its_memory(gtmab: Known) -> None:
    nominal = gtmab[0]
    # Displaced, 0.314 m3 of 1.2 kg/m3 and less by its gas's purity, and 0.134 kg of added mass.
    moved = nominal.displaced + 0.134
    # The centre of gravity below the hull's couples surge and pitch, but not in the mass itself.
    assert estimate_air_speed(1.1e-3, nominal) == pytest.approx(1.1e-3 * 1.5 / moved, rel=0.03)


@pytest.mark.parametrize(
    ('floors', 'expected'),
    [
        ((0.8, 0.8), True),
        ((0.6, 0.8), False),  # nothing
        ((3.9, 3.9), True),
        ((4.1, 3.9), False),  # gusts
    ],
)
def test_a_draught_has_its_size(gtmab: Known, floors: tuple[float, float], expected: bool) -> None:
    given = np.concatenate([floors, FLOORS[2:]])
    assert (_found(gtmab, floors=given) is not None) == expected


def test_a_draught_follows_nothing_and_comes_alone(gtmab: Known) -> None:
    assert _found(gtmab, left=[]) is not None
    assert _found(gtmab, left=[SURGE._replace(carried=0.4, follows=('x',)), SWAY]) is None
    assert _found(gtmab, left=[SURGE, SWAY, Remainder('pitch', 2e-4, 2.6, (), 0.0)]) is None


def test_what_explains_surge_alone_is_chance_where_sway_is_like_it(gtmab: Known) -> None:
    assert _found(gtmab, rivals=[ONE]) is not None
    assert _found(gtmab, rivals=[ONE._replace(axes=('surge', 'sway'))]) is None
    assert _found(gtmab, rivals=[ONE._replace(axis='heave', axes=('heave',))]) is None

"""A slow force of one frequency is found in the axes in which it keeps its direction."""

from lta_discovery.fit.evidence import FLOOR
from lta_discovery.unmodeled.latent_series import LatentSeries
from lta_discovery.unmodeled.oscillation import (
    dominant_oscillations,
    find_common_oscillations,
    fit_wave_power,
    LatentOscillation,
)
import numpy as np
import pytest

from .latent_draws import process, times, turning

KNOTS = 20
SWING = LatentOscillation('force along x of the map', 0.21, 3.1e-3, 0.8)


def _flight(
    seed: int,
    seconds: float,
    size: float,
    hertz: float = 0.21,
    noise: float = 0.5,
    rate: float = 0.5,
) -> LatentSeries:
    """Return a turning flight with noise [floors], and a force along x of the map [N]."""
    rng = np.random.default_rng(seed)
    time = times(seconds)
    drawn = noise * process(rng, len(time), 6) * FLOOR
    drawn[:, 0] += size * np.cos(2.0 * np.pi * hertz * time + rng.uniform(0.0, 6.28))
    return turning(drawn[:, :3], drawn[:, 3:], rate)


def test_waves_have_the_amplitudes_with_which_they_were_made() -> None:
    time = np.delete(np.arange(200) * 0.3, [7, 50, 51])
    values = np.column_stack(
        [3.0 * np.cos(2.0 * np.pi * 0.25 * time + 1.0) + 5.0 + 0.1 * time, np.zeros_like(time)]
    )
    power = fit_wave_power(time, values, np.array([0.25, 0.5]))
    assert power[0, 0] == pytest.approx(9.0, rel=0.02)
    assert power[1, 0] < 0.02
    np.testing.assert_allclose(power[:, 1], 0.0, atol=1e-20)


def test_a_cross_wind_to_and_fro_is_found_in_the_map_while_the_heading_turns() -> None:
    flights = [_flight(1, 62.0, 3.1e-3), _flight(2, 78.0, 3.1e-3)]
    (one,) = find_common_oscillations(flights, FLOOR, KNOTS)
    assert one.channel == 'force along x of the map'
    assert one.hertz == pytest.approx(0.21, abs=0.008)
    # A bin may lie 1 / (4 T) beside it, which takes a tenth of the amplitude.
    assert one.amplitude == pytest.approx(3.1e-3, rel=0.12)
    # 3.1^2 / 2 of it, beside 0.2^2 of noise on each of two axes.
    assert one.share == pytest.approx(4.8 / 4.88, abs=0.1)
    assert dominant_oscillations([one]) == {'surge': one, 'sway': one}


def test_a_force_that_turns_with_the_body_is_found_there() -> None:
    flights = []
    for seed in (3, 4):
        each = _flight(seed, 64.0, 0.0)
        body = each.body.copy()
        body[:, 1] += 3e-3 * np.cos(2.0 * np.pi * 0.4 * each.time)
        c, s = np.cos(0.5 * each.time), np.sin(0.5 * each.time)
        x, y = body[:, 0], body[:, 1]
        ground = np.column_stack([c * x - s * y, s * x + c * y, body[:, 2]])
        flights.append(LatentSeries(each.time, ground, body))
    (one,) = find_common_oscillations(flights, FLOOR, KNOTS)
    assert (one.channel, one.axes) == ('sway force', ('sway',))
    assert one.hertz == pytest.approx(0.4, abs=0.008)


def test_one_flight_alone_makes_none() -> None:
    flights = [_flight(1, 62.0, 3.1e-3), _flight(2, 78.0, 0.0)]
    assert find_common_oscillations(flights, FLOOR, KNOTS) == ()
    # Nor do two frequencies.
    flights = [_flight(1, 62.0, 3.1e-3), _flight(2, 78.0, 3.1e-3, 0.6)]
    assert find_common_oscillations(flights, FLOOR, KNOTS) == ()


def test_no_frequency_is_told_that_the_knots_sample_as_nothing() -> None:
    # Half a wave from knot to knot of 19 in 6 s is 1.5 Hz: a sine of it is 0 at all of them.
    flights = []
    for seed in (1, 2):
        time = np.arange(200) / 3.0
        drawn = 0.1 * process(np.random.default_rng(seed), 200, 6) * FLOOR
        drawn[:, 0] += 3e-3 * np.cos(np.pi * time)
        flights.append(LatentSeries(time, drawn[:, :3], drawn))
    (one,) = find_common_oscillations(flights, FLOOR, 19)
    assert one.hertz == pytest.approx(0.5, abs=0.008)


def test_an_oscillation_has_to_be_worth_speaking_of() -> None:
    # 1.5 floors of root mean square are an amplitude of 0.85 mN.
    for size, expected in ((1.2e-3, 1), (0.6e-3, 0)):
        flights = [_flight(seed, 70.0, size, noise=0.2) for seed in (1, 2)]
        assert len(find_common_oscillations(flights, FLOOR, KNOTS)) == expected


def test_a_flight_of_few_cycles_is_not_asked() -> None:
    for seconds, expected in ((14.0, 0), (30.0, 1)):  # 2.9 and 6.3 of them
        flights = [_flight(seed, seconds, 3.1e-3, rate=0.0) for seed in (1, 2)]
        assert len(find_common_oscillations(flights, FLOOR, KNOTS)) == expected
    assert find_common_oscillations([_flight(1, 2.0, 3.1e-3)] * 2, FLOOR, KNOTS) == ()


@pytest.mark.parametrize('memory', [0.5, 1.5, 4.0])
def test_noise_has_none_whatever_its_memory(memory: float) -> None:
    rng = np.random.default_rng(11)
    small = np.full(6, 1e-9)  # so that its size saves none
    found = 0
    for _ in range(12):
        flights = []
        for seconds in rng.uniform(50.0, 80.0, 2):
            drawn = process(rng, len(times(seconds)), 6, memory)
            flights.append(turning(drawn[:, :3], drawn[:, 3:]))
        found += len(find_common_oscillations(flights, small, KNOTS))
    assert found == 0


def test_an_oscillation_is_told_with_its_axis_frequency_and_size() -> None:
    assert SWING.sentence == 'an oscillation of the force along x of the map at 0.21 Hz, 3.1 mN'
    nod = LatentOscillation('pitch moment', 0.5, 1.1e-3, 0.3)
    assert nod.sentence == 'an oscillation of the pitch moment at 0.50 Hz, 1.1 mN m'


def test_an_axis_follows_the_oscillations_that_take_most_of_it() -> None:
    other = SWING._replace(channel='force along y of the map', share=0.3)
    both = [SWING._replace(share=0.4), other]
    assert dominant_oscillations([other]) == {}
    assert {axis: one.share for axis, one in dominant_oscillations(both).items()} == {
        'surge': 0.4,
        'sway': 0.4,
    }

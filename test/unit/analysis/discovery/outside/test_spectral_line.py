"""A forcing that knots cannot follow is a line; noise of any colour has none."""

from lta_analysis.discovery.flights.measured import CHANNELS, PERIOD
from lta_analysis.discovery.outside.spectral_line import Line, lines, spectrum, telling
import numpy as np
import pytest

PIECES, SIZE = 10, 150
TIME = PERIOD * np.arange(PIECES * SIZE, dtype=np.float64).reshape(PIECES, SIZE)
TIMES = [TIME, TIME]


def _left(seed: int, colour: float = 0.0) -> np.ndarray:
    """Return pieces of noise; by `colour` each reading keeps that much of the one before."""
    left = np.random.default_rng(seed).standard_normal((PIECES, SIZE, len(CHANNELS)))
    for k in range(1, SIZE):
        left[:, k] += colour * left[:, k - 1]
    return left


def _wave(hertz: float, amplitude: float) -> np.ndarray:
    return amplitude * np.sin(2.0 * np.pi * hertz * TIME + 0.3)


def test_a_line_has_its_channel_its_frequency_and_its_amplitude() -> None:
    flights, noise = [_left(1), _left(2)], [np.full(len(CHANNELS), 0.02)] * 2
    for flight in flights:
        flight[:, :, CHANNELS.index('fz')] += _wave(2.0, 1.5)
    found = lines(flights, TIMES, noise)
    assert [one.channel for one in found] == ['fz']
    assert found[0].hertz == pytest.approx(2.0, abs=1.0 / (PIECES * SIZE * PERIOD))
    assert found[0].amplitude == pytest.approx(1.5 * 0.02, rel=0.15)
    assert found[0].unit == 'm/s2'
    assert found[0].medians > 20.0


def test_one_flight_alone_makes_no_line() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    flights[0][:, :, 11] += _wave(2.0, 1.5)
    assert lines(flights, TIMES, noise) == []


@pytest.mark.parametrize(
    'colour',
    [pytest.param(0.0, marks=pytest.mark.long), pytest.param(0.5, marks=pytest.mark.long), 0.9],
)
def test_noise_has_no_line(colour: float) -> None:
    noise = [np.ones(len(CHANNELS))] * 2
    found = [lines([_left(k, colour), _left(k + 500, colour)], TIMES, noise) for k in range(40)]
    assert sum(map(len, found)) == 0


def test_a_wave_has_its_power_whatever_is_missing() -> None:
    wave = _wave(3.0, 2.0)
    wave[0, 30:80] = np.nan  # left out
    wave[1, 70] = np.nan
    seen = spectrum(wave)
    assert seen.pieces == PIECES - 1
    assert seen.power.max() == pytest.approx(4.0, rel=0.05)


def test_a_weak_wave_of_one_frequency_adds_up_over_a_flight() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    for k, flight in enumerate(flights):
        flight[:, :, 6] += np.roll(_wave(2.13, 0.3), 40 * k)
        flight[3, 20:90] = np.nan
    assert max(spectrum(each[:, :, 6]).medians.max() for each in flights) < 5.0
    found = lines(flights, TIMES, noise)
    assert [one.channel for one in found] == ['p']
    assert found[0].hertz == pytest.approx(2.13, abs=1.0 / (PIECES * SIZE * PERIOD))
    assert found[0].amplitude == pytest.approx(0.3, rel=0.3)


def test_a_wave_that_drifts_adds_up_within_the_pieces() -> None:
    rng, flights, noise = np.random.default_rng(3), [_left(1), _left(2)], [np.ones(14)] * 2
    for flight in flights:
        drift = np.cumsum(0.12 * rng.standard_normal(PIECES * SIZE)).reshape(PIECES, SIZE)
        flight[:, :, 6] += 1.2 * np.sin(2.0 * np.pi * 2.0 * TIME + drift)
    found = lines(flights, TIMES, noise)
    assert [one.channel for one in found] == ['p']
    assert found[0].hertz == pytest.approx(2.0, abs=0.35)


def test_what_only_the_pressure_shows_is_the_weather() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    for flight in flights:
        flight[:, :, 13] += _wave(0.9, 1.5)
    assert lines(flights, TIMES, noise) == []


INVERSE = np.diag([2.0, 2.0, 2.0, 20.0, 20.0, 25.0])  # 1/kg, 1/(kg m2)
FLOOR = np.array([4e-4, 4e-4, 4e-4, 8e-5, 8e-5, 4e-5])


@pytest.mark.parametrize(
    ('channel', 'axis', 'amplitude'),
    [  # what a force of 1 mN (rms) at 2 Hz makes of half a kilogramme, or 1 mN m of 0.05 kg m2
        ('fz', 2, 2e-3),
        ('q', 4, 20e-3 / (4.0 * np.pi)),
        ('turn_x', 3, 20e-3 / (4.0 * np.pi) ** 2),
        ('y', 1, 2e-3 / (4.0 * np.pi) ** 2),
    ],
)
def test_a_line_takes_a_wrench(channel: str, axis: int, amplitude: float) -> None:
    line = Line(channel, 2.0, np.sqrt(2.0) * amplitude, 12.0)
    assert line.wrench(INVERSE) == (axis, pytest.approx(1e-3))


def test_a_line_that_moves_nothing_is_not_told() -> None:
    faint, strong = Line('q', 0.5, 0.0004, 30.0), Line('q', 2.0, 0.004, 6.0)
    assert telling([faint, strong], INVERSE, FLOOR) == (strong,)
    assert telling([faint], INVERSE, 0.1 * FLOOR) == (faint,)


def test_what_the_knots_follow_is_no_line() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    for hertz, found in ((0.5, []), (1.0, ['q'])):
        moved = [flight.copy() for flight in flights]
        for flight in moved:
            flight[:, :, CHANNELS.index('q')] += _wave(hertz, 1.5)
        assert [one.channel for one in lines(moved, TIMES, noise)] == found

"""A forcing that knots cannot follow is a line; noise of any colour has none."""

from lta_discovery.flights.measured_flight import CHANNELS, PERIOD
from lta_discovery.unmodeled import spectral_line
from lta_discovery.unmodeled.spectral_line import (
    find_spectral_lines,
    flight_spectrum,
    LeveledSpectrum,
    lowest_frequency,
    piece_spectrum,
    select_strong_lines,
    SpectralLine,
)
import numpy as np
import pytest

PIECES, SIZE = 10, 150
TIME = PERIOD * np.arange(PIECES * SIZE, dtype=np.float64).reshape(PIECES, SIZE)
TIMES = [TIME, TIME]
LEAST = lowest_frequency(9)  # 0.7 Hz


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
    found = find_spectral_lines(flights, TIMES, noise, LEAST)
    assert [one.channel for one in found] == ['fz']
    assert found[0].hertz == pytest.approx(2.0, abs=1.0 / (PIECES * SIZE * PERIOD))
    assert found[0].amplitude == pytest.approx(1.5 * 0.02, rel=0.15)
    assert found[0].unit == 'm/s2'
    assert found[0].medians > 20.0


def test_one_flight_alone_makes_no_line() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    flights[0][:, :, 11] += _wave(2.0, 1.5)
    assert find_spectral_lines(flights, TIMES, noise, LEAST) == []


@pytest.mark.parametrize(
    'colour',
    [pytest.param(0.0, marks=pytest.mark.long), pytest.param(0.5, marks=pytest.mark.long), 0.9],
)
def test_noise_has_no_line(colour: float) -> None:
    noise = [np.ones(len(CHANNELS))] * 2
    pairs = [[_left(k, colour), _left(k + 500, colour)] for k in range(40)]
    found = [find_spectral_lines(pair, TIMES, noise, LEAST) for pair in pairs]
    assert sum(map(len, found)) == 0


def test_a_wave_has_its_power_whatever_is_missing() -> None:
    wave = _wave(3.0, 2.0)
    wave[0, 30:80] = np.nan  # left out
    wave[1, 70] = np.nan
    seen = piece_spectrum(wave, LEAST)
    assert seen.pieces == PIECES - 1
    assert seen.power.max() == pytest.approx(4.0, rel=0.05)


def test_a_weak_wave_of_one_frequency_adds_up_over_a_flight() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    for k, flight in enumerate(flights):
        flight[:, :, 6] += np.roll(_wave(2.13, 0.3), 40 * k)
        flight[3, 20:90] = np.nan
    assert max(piece_spectrum(each[:, :, 6], LEAST).power_ratio.max() for each in flights) < 5.0
    found = find_spectral_lines(flights, TIMES, noise, LEAST)
    assert [one.channel for one in found] == ['p']
    assert found[0].hertz == pytest.approx(2.13, abs=1.0 / (PIECES * SIZE * PERIOD))
    assert found[0].amplitude == pytest.approx(0.3, rel=0.3)


def test_a_wave_that_drifts_adds_up_within_the_pieces() -> None:
    rng, flights, noise = np.random.default_rng(3), [_left(1), _left(2)], [np.ones(14)] * 2
    for flight in flights:
        drift = np.cumsum(0.12 * rng.standard_normal(PIECES * SIZE)).reshape(PIECES, SIZE)
        flight[:, :, 6] += 1.2 * np.sin(2.0 * np.pi * 2.0 * TIME + drift)
    found = find_spectral_lines(flights, TIMES, noise, LEAST)
    assert [one.channel for one in found] == ['p']
    assert found[0].hertz == pytest.approx(2.0, abs=0.35)


def test_what_only_the_pressure_shows_is_the_weather() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    for flight in flights:
        flight[:, :, 13] += _wave(0.9, 1.5)
    assert find_spectral_lines(flights, TIMES, noise, LEAST) == []


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
    line = SpectralLine(channel, 2.0, np.sqrt(2.0) * amplitude, 12.0)
    assert line.equivalent_wrench(INVERSE) == (axis, pytest.approx(1e-3))


def test_a_line_that_moves_nothing_is_not_told() -> None:
    faint, strong = SpectralLine('q', 0.5, 0.0004, 30.0), SpectralLine('q', 2.0, 0.004, 6.0)
    assert select_strong_lines([faint, strong], INVERSE, FLOOR) == (strong,)
    assert select_strong_lines([faint], INVERSE, 0.1 * FLOOR) == (faint,)


def test_each_channel_of_pose_and_imu_has_its_unit() -> None:
    units = ['m', 'm', 'm', *['rad'] * 3, *['rad/s'] * 3, *['m/s2'] * 3]
    assert [SpectralLine(channel, 2.0, 1.0, 9.0).unit for channel in CHANNELS[:12]] == units


@pytest.mark.parametrize('channel', CHANNELS[12:])
def test_range_and_pressure_are_not_searched_for_lines(channel: str) -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    for flight in flights:
        flight[:, :, CHANNELS.index(channel)] += _wave(2.0, 3.0)
    assert find_spectral_lines(flights, TIMES, noise, LEAST) == []


def test_what_the_knots_follow_is_no_line() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS))] * 2
    for hertz, found in ((0.5, []), (1.0, ['q'])):
        moved = [flight.copy() for flight in flights]
        for flight in moved:
            flight[:, :, CHANNELS.index('q')] += _wave(hertz, 1.5)
        assert [one.channel for one in find_spectral_lines(moved, TIMES, noise, LEAST)] == found


@pytest.mark.parametrize(('known', 'pieces'), [(134, 0), (135, 1)])
def test_a_piece_with_less_than_nine_tenths_of_its_readings_is_left_out(
    known: int, pieces: int
) -> None:
    wave = _wave(3.0, 2.0)[:1]
    wave[:, known:] = np.nan
    assert piece_spectrum(wave, LEAST).pieces == pieces


@pytest.mark.parametrize(('knots', 'first'), [(9, 7), (19, 16), (37, 32)])
def test_spectra_begin_where_the_knots_are_blind(knots: int, first: int) -> None:
    """
    Knots 6 / (K - 1) s apart follow half a wave of (K - 1) / 12 Hz; 5 % more is beyond them.

    Pieces of 250 readings at 25 Hz last 10 s, so the bins are 0.1 Hz apart.
    """
    seen = piece_spectrum(np.zeros((2, 250)), lowest_frequency(knots))
    np.testing.assert_allclose(seen.hertz, 0.1 * np.arange(first, 126))


def test_parabolas_of_any_size_are_removed_from_pieces_and_cubics_are_not() -> None:
    ramp = np.linspace(-1.0, 1.0, SIZE)
    slow = np.array([[1e3 + 2e3 * ramp - 3e3 * ramp**2], [5e3 * ramp]])[:, 0]
    assert piece_spectrum(slow, LEAST).power.max() < 1e-12
    assert flight_spectrum(slow, TIME[:2], 2 * SIZE, LEAST).power.max() < 1e-12
    cubic = slow + ramp**3
    assert piece_spectrum(cubic, LEAST).power.max() > 1e-7
    np.testing.assert_allclose(
        piece_spectrum(cubic, LEAST).power,
        piece_spectrum(np.tile(ramp**3, (2, 1)), LEAST).power,
        rtol=1e-4,
    )
    gone = np.vstack([_wave(3.0, 2.0)[:1], np.full((1, SIZE), np.nan)])
    found = flight_spectrum(gone, TIME[:2], 2 * SIZE, LEAST)  # normalised by the known readings
    assert found.power.max() == pytest.approx(4.0, rel=0.02)


def test_a_whole_flight_is_padded_to_twice_its_length() -> None:
    size = PIECES * SIZE
    found = flight_spectrum(_wave(2.0, 1.5), TIME + 7.0, size, LEAST)
    assert np.diff(found.hertz) == pytest.approx(0.5 / (size * PERIOD))
    assert found.hertz[found.power.argmax()] == pytest.approx(2.0)
    assert found.power.max() == pytest.approx(1.5**2, rel=0.02)
    assert found.pieces == 1


@pytest.mark.parametrize(
    ('wide', 'plateau', 'kept'),
    [(0.5, 2, False), (0.5, 3, True), (0.4, 2, False), (0.4, 3, True), (0.1, 1, False),
     (0.1, 2, True)],
)  # fmt: skip
def test_a_level_is_the_median_of_an_odd_number_of_neighbours(
    wide: float, plateau: int, kept: bool
) -> None:
    """
    Of bins 0.1 Hz apart, 0.5 and 0.4 Hz are five and 0.1 Hz are three, the fewest.

    A plateau over more than half of them is the level itself.
    """
    power = np.ones(100)
    power[50 : 50 + plateau] = 5.0
    found = spectral_line.level_spectrum(0.1 * np.arange(100), power, 3, wide, LEAST)
    assert found.level.max() == (5.0 if kept else 1.0)
    assert found.power_ratio.max() == (1.0 if kept else 5.0)
    assert (found.pieces, len(found.power)) == (3, 93)  # without the 7 bins below 0.7 Hz


def test_levels_are_medians_over_2_5_hertz_of_pieces_and_1_hertz_of_flights() -> None:
    """These are 15 bins of 1/6 Hz of pieces of 6 s, and 121 of 1/120 Hz of a padded flight."""
    left = _left(5)[:, :, 0]
    for found, size in (
        (piece_spectrum(left, LEAST), 15),
        (flight_spectrum(left, TIME, PIECES * SIZE, LEAST), 121),
    ):
        at = np.arange(size, len(found.power) - size)
        middle = [np.median(found.power[k - size // 2 : k + size // 2 + 1]) for k in at]
        np.testing.assert_allclose(found.level[at], middle)


def _spectra(
    *peaks: tuple[int, float], pieces: tuple[int, ...] = (10, 10)
) -> list[LeveledSpectrum]:
    """Return spectra of 100 bins and a level of 1, each with a peak of some bin and height."""
    out = []
    for (at, height), count in zip(peaks, pieces, strict=False):
        power = np.ones(100)
        power[at] = height
        out.append(LeveledSpectrum(0.1 * np.arange(100), power, np.ones(100), count))
    return out


@pytest.mark.parametrize(
    ('heights', 'found'),
    [
        # One flight: exp(-x) = 1e-4 / 100 at x = 13.816, and 1.3 x / ln 2 = 25.91.
        ((25.8,), False), ((26.0,), True),
        # Two flights, three bins of the second for each of the first:
        # exp(-x) (1 + x) = 1e-4 / 300 at x = 17.850, and 1.3 x / (2 ln 2) = 16.74.
        ((16.7, 16.7), False), ((16.8, 16.8), True),
        # However high the other one is, each needs 1.3 ln(3 / 0.01) / ln 2 = 10.70.
        ((10.6, 90.0), False), ((10.8, 90.0), True),
    ],
)  # fmt: skip
def test_a_steady_line_is_higher_than_noise_is_by_chance(
    heights: tuple[float, ...], found: bool
) -> None:
    """
    Noise in any of the 100 bins exceeds the limit with a probability of 1e-4.

    Its power is exponential, with a median of ln 2 times its mean; heights are in medians, and
    1.3 is the allowance for windows and levels.
    """
    seen = _spectra(*((50, height) for height in heights))
    assert spectral_line.find_steady_line(seen) == (50 if found else None)


@pytest.mark.parametrize(
    ('heights', 'apart', 'at'),
    [
        ((40.0, 39.0), 0, 50), ((40.0, 39.0), 2, 50), ((39.0, 40.0), 2, 52),  # the higher peak
        ((40.0, 39.0), 3, 51), ((40.0, 39.0), 4, 52),  # the first bin within two of both
        ((40.0, 39.0), 5, None),
    ],
)  # fmt: skip
def test_peaks_of_a_steady_line_may_be_two_bins_from_it(
    heights: tuple[float, float], apart: int, at: int | None
) -> None:
    seen = _spectra((50, heights[0]), (50 + apart, heights[1]))
    assert spectral_line.find_steady_line(seen) == at


@pytest.mark.parametrize(
    ('heights', 'pieces', 'found'),
    [
        ((4.9, 4.9), (10, 10), False), ((5.1, 5.1), (10, 10), True),  # five medians in the mean
        ((2.9, 9.0), (10, 10), False), ((3.1, 7.0), (10, 10), True),  # three medians in each
        ((3.5, 9.0), (30, 10), False), ((4.0, 9.0), (30, 10), True),  # weighted by pieces
        ((9.0, 9.0), (9, 1), False),  # one piece is too few
        # The power of noise in four pieces is a gamma variable of shape 4: it exceeds 21.350 with
        # a probability of 1e-4 / 100, its median is 3.672, and 1.3 * 21.350 / 3.672 = 7.56.
        ((7.5, 7.5), (2, 2), False), ((7.6, 7.6), (2, 2), True),
    ],
)  # fmt: skip
def test_a_line_in_the_mean_of_pieces_is_higher_than_its_limits(
    heights: tuple[float, float], pieces: tuple[int, int], found: bool
) -> None:
    seen = _spectra(*((50, height) for height in heights), pieces=pieces)
    assert spectral_line._find_drifting_line(seen) == (50 if found else None)


@pytest.mark.parametrize(('apart', 'found'), [(2, True), (3, False)])
def test_peaks_of_a_line_in_the_mean_of_pieces_may_be_one_bin_from_it(
    apart: int, found: bool
) -> None:
    seen = _spectra((50, 9.0), (50 + apart, 9.0))
    assert spectral_line._find_drifting_line(seen) == (51 if found else None)


def test_a_line_has_the_mean_amplitude_and_the_least_medians_of_the_flights() -> None:
    """Beside the bin there are powers of 9 and 4: amplitudes of 3 and 2 times the noise."""
    first, second = _spectra((51, 9.0), (49, 4.0))
    line = spectral_line._measure_line('q', [first, second], 50, [0.1, 0.2])
    assert line == ('q', pytest.approx(5.0), pytest.approx(0.5 * (0.3 + 0.4)), 4.0)
    # At bin 0 the neighbour is bin 1, where only the second spectrum has its peak.
    far = spectral_line._measure_line('q', _spectra((2, 9.0), (1, 4.0)), 0, [1.0, 1.0])
    assert far == ('q', 0.0, 1.5, 1.0)


def test_the_strongest_line_comes_first_and_an_unmeasured_channel_has_none() -> None:
    flights, noise = [_left(1), _left(2)], [np.ones(len(CHANNELS)), np.ones(len(CHANNELS))]
    for flight in flights:
        for channel, amplitude in (('p', 1.0), ('q', 3.0), ('r', 2.0)):
            flight[:, :, CHANNELS.index(channel)] += _wave(2.0, amplitude)
    assert [one.channel for one in find_spectral_lines(flights, TIMES, noise, LEAST)] == [
        'q',
        'r',
        'p',
    ]
    noise[1][CHANNELS.index('r')] = np.inf
    assert [one.channel for one in find_spectral_lines(flights, TIMES, noise, LEAST)] == ['q', 'p']


@pytest.mark.parametrize(('size', 'told'), [(0.99, False), (1.01, True)])
def test_a_line_is_reported_if_its_wrench_exceeds_the_floor(size: float, told: bool) -> None:
    line = SpectralLine('fz', 2.0, size * FLOOR[2] * INVERSE[2, 2] * np.sqrt(2.0), 12.0)
    assert select_strong_lines([line], INVERSE, FLOOR) == ((line,) if told else ())

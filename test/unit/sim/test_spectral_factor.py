# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Spectral factors against pvlib's sunlight, published ranges, and integrals by hand."""

from lta_config.schema.spectrum_file import (
    LightSpectrum,
    load_spectral_response,
    load_spectrum,
    luminous_efficacy,
    photopic_sensitivity,
    sample_spectrum,
    SpectralResponse,
    WAVELENGTHS,
)
from lta_model.electrical.panel import array_spectral_factor, cell_spectral_factor
from lta_model.light.spectral_factor import (
    find_spectrum,
    mean_responsivity,
    spectral_factor,
)
from lta_model.vehicle import load_vehicle
import numpy as np
import pvlib
import pytest

LED, SUN, HALOGEN = 300.0, 110.0, 20.0
DETECTORS = ('crystalline', 'amorphous', 'organic', 'opt101')

HEAD = {'schema': 1, 'name': 'made', 'about': '', 'source': ''}


def test_the_sun_is_pvlibs():
    """The table of 20 nm means gives each detector what the 2002 points of ASTM G173 give it."""
    table = pvlib.spectrum.get_reference_spectra()['global']
    nm, power = table.index.to_numpy(), table.to_numpy()
    total = np.trapezoid(power, nm)
    assert load_spectrum('sun').total == pytest.approx(total, rel=1e-4)
    for name in DETECTORS:
        response = load_spectral_response(name)
        answer = np.interp(nm, *np.array(response.points).T, left=0.0, right=0.0)
        expected = np.trapezoid(power * answer, nm) / total
        assert mean_responsivity(load_spectrum('sun'), response) == pytest.approx(
            expected, rel=0.005
        )


def test_the_factor_is_pvlibs_mismatch():
    """pvlib's M for the LED, times the sensitivity to photons that both leave out."""
    pandas = pytest.importorskip('pandas')
    response = load_spectral_response('crystalline')
    nm = WAVELENGTHS[WAVELENGTHS <= 1200.0]
    answer = pandas.Series(np.interp(nm, *np.array(response.points).T, right=0.0), index=nm)
    led = pandas.Series(sample_spectrum(load_spectrum('white_led'))[: len(nm)], index=nm)
    sun = pvlib.spectrum.get_reference_spectra(wavelengths=nm)['global']
    mismatch = pvlib.spectrum.calc_spectral_mismatch_field(answer, led, e_ref=sun)
    # Its irradiances are those of the response's range; ours of all wavelengths
    whole = np.trapezoid(sun.to_numpy(), nm) / 1000.4
    assert spectral_factor(LED, 'crystalline') == pytest.approx(mismatch / whole, rel=0.01)


@pytest.mark.parametrize(
    ('detector', 'low', 'high'),
    [('crystalline', 1.05, 1.17), ('amorphous', 2.0, 2.4), ('organic', 2.0, 2.7)],
)
def test_under_a_white_led_the_factors_are_the_published_ones(detector, low, high):
    assert low < spectral_factor(LED, detector) < high
    assert spectral_factor(SUN, detector) == 1.0


def test_a_halogen_lamp_favours_crystalline_silicon():
    """Most of its light is heat, and little of the rest is short enough for amorphous silicon."""
    assert spectral_factor(HALOGEN, 'crystalline') == pytest.approx(0.51, abs=0.03)
    assert spectral_factor(HALOGEN, 'amorphous') == pytest.approx(0.19, abs=0.03)


def test_the_photodiodes_printed_responsivity_is_that_of_650_nm():
    response = load_spectral_response('opt101')
    narrow = {'at': 650.0, 'below': 1.0, 'above': 1.0, 'height': 1.0}
    red = LightSpectrum.model_validate({**HEAD, 'peaks': [narrow]})
    assert mean_responsivity(red, response) == pytest.approx(0.45, abs=0.001)
    white = mean_responsivity(load_spectrum('white_led'), response)
    assert white == pytest.approx(0.37, abs=0.01)  # 0.83 of the printed number
    assert mean_responsivity(load_spectrum('sun'), response) == pytest.approx(0.32, abs=0.01)


def test_efficacies_tell_the_lights_apart():
    assert luminous_efficacy('sun') == pytest.approx(110.0, abs=2.0)
    assert luminous_efficacy('white_led') == pytest.approx(326.0, abs=1.0)
    assert luminous_efficacy('halogen') == pytest.approx(20.4, abs=0.5)
    names = [find_spectrum(lm) for lm in (330.0, 280.0, 200.0, 180.0, 105.0, 50.0, 45.0, 15.0)]
    assert names == ['white_led'] * 3 + ['sun'] * 3 + ['halogen'] * 2
    assert photopic_sensitivity(np.array([556.0]))[0] == pytest.approx(1.0, abs=0.01)


def test_integrals_by_hand():
    """A flat light from 400 to 500 nm, half of its power; a response of 1 above 450 nm."""
    flat = {**HEAD, 'points': [[399.0, 0], [400.0, 1], [500.0, 1], [501.0, 0]], 'total': 202.0}
    light = LightSpectrum.model_validate(flat)
    answer = SpectralResponse.model_validate({**HEAD, 'points': [[450.0, 1], [600.0, 1]]})
    assert mean_responsivity(light, answer) == pytest.approx(50.5 / 202.0, rel=0.02)
    sun = load_spectrum('sun')
    assert np.trapezoid(sample_spectrum(sun), WAVELENGTHS) == pytest.approx(0.83, abs=0.02)
    hot = LightSpectrum.model_validate({**HEAD, 'temperature': 2950})
    # Wien: 2.898e6 nm K / T
    assert WAVELENGTHS[sample_spectrum(hot).argmax()] == pytest.approx(2.898e6 / 2950, abs=1.0)


def test_a_vehicle_without_an_array_has_no_factor():
    gtmab, none = load_vehicle('gtmab').file.energy, load_vehicle('sblimp').file.energy
    assert array_spectral_factor(gtmab, LED) == cell_spectral_factor('anysolar', LED)
    assert array_spectral_factor(none, LED) == 1.0

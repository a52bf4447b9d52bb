"""A forecast under a law as an outer wrench is the one that the compiled kernel makes of it."""

from dataclasses import replace

from lta_config.errors import BadInput
from lta_config.schema.vehicle_law import coefficient_unit, HiddenState, Law, LawFactor, LawTerm
from lta_discovery.fit.evidence import FLOOR
from lta_discovery.laws.forecast import FlightLaw, LawForecaster, simulate_under_law
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import SENSORS, unchanged_vehicle_point
from lta_model.effects.law import list_law_parameters
import numpy as np
import pytest

TERMS = (
    ('pitch', -0.01, [LawFactor(quantity='u'), LawFactor(quantity='r')]),
    ('map_z', 0.01, [LawFactor(quantity='height', form='sin', scale=2.0)]),
    ('yaw', 0.0006, [LawFactor(quantity='yaw', form='sin', phase=0.5)]),
    ('surge', -0.2, [LawFactor(quantity='hidden'), LawFactor(quantity='thrust_heave')]),
)
ALL = {'u': 1.0, 'r': 3.0, 'height': 9.0, 'yaw': 3.15, 'hidden': 9.0, 'thrust_heave': 9.0}


@pytest.mark.parametrize(
    ('order', 'sizes', 'share'),
    [
        ({'time_constant': 1.0}, {}, 0.02),
        # Fades with the yaw rate, and with it the drive of the hidden state
        ({'time_constant': 1.0}, {'r': 0.3}, 0.015),
        ({'frequency': 4.0, 'damping': 0.3}, {}, 0.02),
    ],
)
def test_picard_rounds_agree_with_the_kernel(
    gtmab: tuple[NominalVehicle, list[FreeParameter]],
    clean: FlightLinearizer,
    order: dict[str, float],
    sizes: dict[str, float],
    share: float,
) -> None:
    """Motion and wrench agree after some rounds; the law moves the vehicle by centimetres."""
    state = HiddenState(drive=[LawFactor(quantity='r')], **order)
    terms = [
        LawTerm(axis=axis, coefficient=c, unit=coefficient_unit(axis, f, state), factors=f)
        for axis, c, f in TERMS
    ]
    region = {name: [-size, size] for name, size in (ALL | sizes).items()}
    law = Law(source='a test', terms=terms, hidden=state, region=region)
    point = unchanged_vehicle_point(gtmab[0], clean.knobs, clean.replay.cut)
    ours = simulate_under_law(clean, point, FlightLaw(law, clean, gtmab[0]))
    given = {**gtmab[0].effect_parameters, 'law': list_law_parameters(law)}
    flown = replace(point, nominal=replace(gtmab[0], effect_parameters=given))
    kernel, without = clean.simulate_forecast(flown), clean.simulate_forecast(point)
    # After 3 s; 0.02 s each
    apart = np.linalg.norm((ours - kernel)[:, 150, :3], axis=-1)
    moved = np.linalg.norm((kernel - without)[:, 150, :3], axis=-1)
    assert moved.max() > 0.01
    # The hidden state starts each piece from measured motion, smoothed in two ways
    assert apart.max() < share * moved.max()


def test_a_file_at_a_limit_is_forecast(
    gtmab: tuple[NominalVehicle, list[FreeParameter]], clean: FlightLinearizer
) -> None:
    """A fit may move a value to its limit; the parameters still count from the file before."""
    knob = next(one for one in clean.knobs if one.name == 'munk_moment.lost')
    file = knob.apply_to(gtmab[0], knob.high)
    assert file.parameter_value('munk_moment', 'lost') == pytest.approx(1.0)
    maker = LawForecaster(clean, file, FLOOR)
    left = maker.compute_residuals(None, np.zeros(len(clean.knobs) + len(SENSORS)))
    assert np.isfinite(left[..., :3]).any()
    # All columns would need a step beyond the limit
    point = unchanged_vehicle_point(file, clean.knobs, clean.replay.cut)
    with pytest.raises(BadInput, match=r'munk_moment\.lost'):
        clean.compute_whitened_columns(point)

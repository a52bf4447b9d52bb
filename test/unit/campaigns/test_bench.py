"""What the kernel is measured with: a flight, with as many effects on as the row says."""

from campaigns import bench_kernel as gtmab
from lta_model.model import VehicleModel
from lta_model.vehicle import load_vehicle
from lta_sim.kernels.kernel import advance
import numpy as np
import pytest


def test_the_realistic_one_is_the_vehicle_of_the_file():
    model, shipped = gtmab.build_vehicle(), load_vehicle('gtmab').build_model()
    assert dict(model.effect_parameters) == dict(shipped.effect_parameters)
    for field in ('parameters', 'on', 'body', 'inverse'):
        np.testing.assert_array_equal(getattr(model, field), getattr(shipped, field))


def test_the_other_has_every_effect_of_the_kernel_on():
    model = gtmab.build_vehicle(every=True)
    assert model.on.all()


@pytest.mark.parametrize('every', [False, True])
def test_what_is_measured_is_a_flight(every):
    # 60 s in the air, at speeds of a blimp: nonsense would measure denormals and NaNs.
    last = advance(
        gtmab.build_start(),
        gtmab.build_vehicle(every),
        gtmab.DUTY,
        gtmab.SURROUNDED,
        gtmab.STEP,
        30_000,
    )
    assert np.isfinite(last).all()
    assert every or 1.0 < last[2] < 20.0
    assert np.linalg.norm(last[7:10]) < 3.0
    assert np.linalg.norm(last[10:13]) < 3.0


def test_scattered_vehicles_differ_and_their_mass_matrices_hold():
    states, fleet, duties, surroundings = gtmab.scatter_vehicles(5)
    assert len(np.unique(fleet.body[:, 0])) == 5
    ratio = fleet.body[:, 0] / gtmab.build_vehicle().body[0]
    np.testing.assert_allclose(
        fleet.inverse * ratio[:, None], np.tile(gtmab.build_vehicle().inverse, (5, 1)), atol=1e-15
    )
    # As `advance_many` flies them, to the last bit: see test/unit/sim/test_batch.py.
    for k, (state, duty, around) in enumerate(zip(states, duties, surroundings, strict=True)):
        model = VehicleModel(fleet.parameters[k], fleet.on[k], fleet.body[k], fleet.inverse[k], {})
        assert np.isfinite(advance(state, model, duty, around, gtmab.STEP, 1000)).all()

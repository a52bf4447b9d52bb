"""What has no name is described: its axis, its size, and what it follows on both flights."""

from lta_analysis.discovery.fit.evidence import FLOOR, tolerances
from lta_analysis.discovery.fit.fit import fit
from lta_analysis.discovery.model.knobs import Knob
from lta_analysis.discovery.model.nominal import Nominal
from lta_analysis.discovery.outside.unexplained import followed, remaining
from lta_analysis.discovery.replay.linear import origin
from lta_sim.effects.protocol import AXES
import numpy as np
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[Nominal, list[Knob]]
RNG = np.random.default_rng(5)


def _states(count: int) -> np.ndarray:
    states = RNG.normal(size=(count, 13))
    states[:, 3:7] /= np.linalg.norm(states[:, 3:7], axis=1, keepdims=True)
    return states


def test_a_force_that_follows_a_product_is_described_by_it() -> None:
    pair = [_states(120), _states(90)]
    forces = [s[:, 7] * s[:, 12] + 0.5 * RNG.standard_normal(len(s)) for s in pair]
    names, share = followed(pair, forces)
    assert names == ('surge speed x yaw rate',)
    assert share == pytest.approx(0.8, abs=0.12)  # 1 / (1 + 0.25) of the variance


def test_noise_follows_nothing() -> None:
    pair = [_states(120), _states(90)]
    names, share = followed(pair, [RNG.standard_normal(len(s)) for s in pair])
    assert names == ()
    assert share < 0.15


@pytest.mark.long
def test_turbulence_remains_on_the_axes_that_it_pushes(gtmab: Known) -> None:
    air = {
        f'vehicle.effects.turbulence.{name}': {'value': value, 'unit': unit}
        for name, value, unit in (
            ('along', 0.06, 'm/s'), ('across', 0.06, 'm/s'), ('up', 0.0, 'm/s'),
            ('along_length', 2.0, 'm'), ('across_length', 2.0, 'm'), ('up_length', 2.0, 'm'),
        )
    }  # fmt: skip
    nominal, knobs = gtmab
    flights = tuple(prepared(flown(air, seed, 26.0), knobs) for seed in (81, 82))
    prior = tolerances(knobs)
    fits = [
        fit(flight, nominal, prior, origin(nominal, knobs, len(flight.replay.first)))
        for flight in flights
    ]
    left = remaining([[one] for one in flights], [[one] for one in fits])
    assert {'surge', 'sway'} <= {one.axis for one in left}
    for one in left:
        assert one.size == pytest.approx(one.floors * FLOOR[AXES.index(one.axis)])

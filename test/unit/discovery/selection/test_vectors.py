"""Components of one thing are one candidate, and an effect may be many typical sizes large."""

from types import SimpleNamespace

from lta_discovery.fit.evidence import (
    build_prior,
    build_shared_prior,
    ParameterPosterior,
    Prior,
    ReducedFlight,
    widen_tolerance,
)
from lta_discovery.model.candidates import (
    expand_vectors,
    list_component_sizes,
    vector_components,
    vector_cost,
    VECTORS,
)
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection.candidate_scan import scan_candidates, SIZES, wider_tolerance_gain
from lta_discovery.selection.effect_verification import VerifiedEffects
import numpy as np
import pytest

Known = tuple[NominalVehicle, list[FreeParameter]]


def test_wind_balance_tilt_and_toe_are_vectors_and_no_name_is_in_two(gtmab: Known) -> None:
    assert vector_components('steady_wind.y') == ('steady_wind.x', 'steady_wind.y')
    assert vector_components('cg_offset.x') == ('cg_offset.x', 'cg_offset.y')
    assert vector_components('net_lift.force') == ('net_lift.force',)
    assert expand_vectors(['rotor_misalignment.second_2', 'ballast.mass']) == {
        'rotor_misalignment.first_2', 'rotor_misalignment.second_2', 'ballast.mass',
    }  # fmt: skip
    every = [name for vector in VECTORS for name in vector]
    assert len(every) == len(set(every))
    names = {knob.name for knob in gtmab[1]}
    assert all(set(vector) <= names or not set(vector) & names for vector in VECTORS)


def test_all_components_of_a_named_vector_are_free(gtmab: Known) -> None:
    names = [knob.name for knob in gtmab[1]]
    free = build_shared_prior(gtmab[1], ('steady_wind.x',)).free[: len(names)]
    wind = [free[names.index(f'steady_wind.{axis}')] for axis in 'xyz']
    assert wind == [True, True, False]


def test_a_component_may_be_there_alone(gtmab: Known) -> None:
    """Three ways to have a wind, each at a third of its probability."""
    alone, whole = list_component_sizes('steady_wind.y', 5.0)
    assert alone == {'steady_wind.x': 0.0, 'steady_wind.y': 5.0}
    assert whole == {'steady_wind.x': 5.0, 'steady_wind.y': 5.0}
    assert list_component_sizes('net_lift.force') == ({'net_lift.force': 1.0},)
    assert vector_cost('steady_wind.y') == pytest.approx(np.log(3.0))
    assert vector_cost('net_lift.force') == 0.0
    names = [knob.name for knob in gtmab[1]]
    free = build_shared_prior(gtmab[1], ('steady_wind.y',), alone).free[: len(names)]
    wind = [free[names.index(f'steady_wind.{axis}')] for axis in 'xyz']
    assert wind == [False, True, False]


def test_a_tolerance_may_be_half_as_large_again() -> None:
    """
    A value 5 tolerances from the file, known exactly, is less surprising then.

    The log density under a deviation of 1.5 less that under 1, by hand, and a half for the choice.
    """
    information = 1e8
    gained = wider_tolerance_gain(5.0 * information, information, 1.0)
    assert gained == pytest.approx(12.5 * (1.0 - 1.0 / 2.25) - np.log(1.5) - np.log(2.0), abs=1e-4)
    assert wider_tolerance_gain(information, information, 1.0) == 0.0
    wide = widen_tolerance(Prior(np.zeros(3), np.diag([1.0, 4.0, 0.0])), [1, 2])
    np.testing.assert_allclose(np.diag(wide.covariance), [1.0, 9.0, 0.0])


def test_a_named_effect_may_have_several_typical_sizes() -> None:
    """Variances: 0.1^2 of the tolerance and (5 x 0.3)^2 of the effect; that of the other 0.2^2."""
    knobs = [
        SimpleNamespace(name='a', tolerance=0.1, typical=0.3, per_flight=False),
        SimpleNamespace(name='b', tolerance=0.0, typical=0.2, per_flight=False),
    ]
    found = build_prior(knobs, ('a', 'b'), {'a': 5.0}).covariance
    np.testing.assert_allclose(np.diag(found)[:2], [0.01 + 2.25, 0.04])


@pytest.mark.parametrize(('value', 'size'), [(0.5, 1.0), (12.0, 5.0), (70.0, 25.0)])
def test_a_glance_finds_the_size_that_makes_a_value_most_probable(
    value: float, size: float
) -> None:
    """
    One candidate of typical size 1, of which the data know the value to 4.

    Its log Bayes factor by hand: the density of the value with variance 16 + size^2, by that with
    16 alone, less what the size costs.
    """
    information = 1.0 / 16.0
    products = information * np.array([[1.0, value], [value, value**2]])
    knob = SimpleNamespace(name='a', typical=1.0)
    prior = Prior(np.zeros(1), np.zeros((1, 1)))
    (seen,) = scan_candidates(ReducedFlight(products, 0.0), np.zeros(1), prior, [knob])
    gains = {
        one: 0.5 * value**2 * (1.0 / 16.0 - 1.0 / (16.0 + one**2))
        - 0.5 * np.log(1.0 + one**2 / 16.0)
        - cost
        for one, cost in SIZES.items()
    }
    assert seen.size == size == max(gains, key=lambda one: gains[one])
    assert seen.gain == pytest.approx(gains[size])


@pytest.mark.parametrize(
    ('mean', 'told'),
    [
        ((0.2, 0.1), (0, 1)),
        ((0.2, 0.01), (0,)),
        ((0.01, 0.2), (1,)),
        ((0.01, 0.0), (0,)),
        ((0.2, 0.039), (0,)),  # known well, and a trifle
        ((0.2, 0.041), (0, 1)),
    ],
)
def test_the_components_that_stand_out_are_told(
    mean: tuple[float, float], told: tuple[int, ...]
) -> None:
    """
    They are known to 0.01 and 0.005; three deviations are asked for, and 4 % of a typical size.

    Where nothing stands out the name itself is told.
    """
    knobs = [
        SimpleNamespace(name=f'steady_wind.{axis}', typical=1.0, tolerance=0.0) for axis in 'xy'
    ]
    measured = SimpleNamespace(fitted=ParameterPosterior(0.0, np.array(mean), np.eye(2)))
    proven = VerifiedEffects(('steady_wind.x',), {}, {}, {}, None, None, measured)
    assert proven.select_components(knobs, np.array([0.01, 0.005])) == {'steady_wind.x': told}


@pytest.mark.parametrize(('side', 'told'), [(0.0005, (1,)), (0.0016, (0, 1))])
def test_a_component_within_its_tolerance_is_not_told(side: float, told: tuple[int, ...]) -> None:
    """A balance is off by 0.5 mm as vehicles are, however well that is known."""
    knobs = [
        SimpleNamespace(name=f'cg_offset.{axis}', typical=0.005, tolerance=0.0005) for axis in 'xy'
    ]
    measured = SimpleNamespace(fitted=ParameterPosterior(0.0, np.array([side, 0.0138]), np.eye(2)))
    proven = VerifiedEffects(('cg_offset.x',), {}, {}, {}, None, None, measured)
    assert proven.select_components(knobs, np.array([5e-6, 1e-4])) == {'cg_offset.x': told}

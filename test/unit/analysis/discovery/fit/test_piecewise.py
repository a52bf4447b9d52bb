"""What the pieces disagree about counts; where the noise is as taken, it is what was expected."""

from dataclasses import replace

from lta_analysis.discovery.fit.evidence import FLOOR, own_variance, Pieces, shared
from lta_analysis.discovery.fit.fit import Fitter, Joint
from lta_analysis.discovery.fit.piecewise import variance
from lta_analysis.discovery.model.knobs import Knob
from lta_analysis.discovery.model.nominal import Nominal
from lta_analysis.discovery.replay.linear import origin
from lta_analysis.discovery.replay.linearise import Linearised
import numpy as np
import pytest

Known = tuple[Nominal, list[Knob]]


@pytest.fixture(scope='module')
def begun(gtmab: Known, clean: Linearised) -> tuple[Fitter, Joint]:
    """A clean flight where its tolerances are most probable."""
    nominal, knobs = gtmab
    fitter = Fitter(nominal, [clean], own_variance(knobs), FLOOR)
    begin = origin(nominal, knobs, len(clean.replay.first))
    return fitter, fitter.fit(shared(knobs), fitter.about(begin.values, [begin]), FLOOR)


def test_noise_as_taken_leaves_the_variance_near_what_it_was(
    begun: tuple[Fitter, Joint],
) -> None:
    joint = begun[1]
    free = joint.prior.free
    ratio = variance(joint)[free] / np.diag(joint.fitted.covariance)[free]
    assert 0.6 < np.median(ratio) < 1.6
    assert (variance(joint)[~free] == 0.0).all()


def test_noise_larger_than_taken_is_seen_by_the_pieces(begun: tuple[Fitter, Joint]) -> None:
    fitter, joint = begun
    (linear,) = joint.group.linears
    # The same flight, its noise taken to be half of what it is: columns and residual double.
    sure = replace(joint.group, pieces=(Pieces(replace(linear, grams=4.0 * linear.grams)),))
    told = fitter.settled(sure, joint.prior, joint.deviations)
    after, before = np.diag(told.fitted.covariance), np.diag(joint.prior.covariance)
    shown = joint.prior.free & (after < 0.1 * before)  # by the flight, not beforehand
    assert np.max(variance(told)[shown] / after[shown]) > 2.0  # of 4 where no force hides it

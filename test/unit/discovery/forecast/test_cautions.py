"""What forecasts warn of."""

from dataclasses import replace

from lta_discovery.finding import ChannelErrors
from lta_discovery.forecast.forecast_warnings import list_forecast_warnings, should_keep_file
import pytest


def gap(channel: str, horizon: float, before: float, after: float, coast: float, most: float):
    """Return a gap whose shrinkage is at most `most`."""
    shrink = 1.0 - after / before
    return ChannelErrors(
        channel, 'm', horizon, before, after, after, coast, 0.01, shrink, (shrink - 0.1, most), 9
    )


def test_a_fit_that_predicts_worse_is_said_and_so_is_a_model_of_no_use() -> None:
    """RGBlimp's, rounded; one second ahead nothing is certain."""
    told = [
        gap('position', 1.0, 0.019, 0.020, 0.021, 0.1),
        gap('position', 5.0, 0.27, 0.30, 0.24, -0.03),
        gap('attitude', 3.0, 0.12, 0.14, 0.07, -0.05),
        gap('attitude', 5.0, 0.22, 0.27, 0.13, -0.14),
        gap('turn_z', 5.0, 0.21, 0.27, 0.12, -0.15),
    ]
    where = '(position after 5 s, attitude after 3, 5 s)'
    worse, idle = list_forecast_warnings(told)
    assert worse.startswith(f'The fitted model predicts worse than the vehicle file {where}.')
    assert idle.endswith(f'which ignores the commands, is better than every model {where}.')


def test_a_fit_that_helps_is_not_warned_of() -> None:
    assert list_forecast_warnings([gap('position', 5.0, 0.3, 0.1, 0.5, 0.7)]) == []


@pytest.mark.parametrize(('most', 'worse'), [(0.0, 0), (-1e-6, 1)])
def test_a_fit_is_worse_if_even_the_upper_end_of_its_interval_is_negative(
    most: float, worse: int
) -> None:
    assert len(list_forecast_warnings([gap('position', 5.0, 0.3, 0.31, 0.5, most)])) == worse


def test_a_second_ahead_alone_decides_nothing() -> None:
    """A clock that is 32 ms late: 7.5 to 8.8 mm after 1 s, and 26 to 19 mm after 5 s."""
    near = gap('position', 1.0, 0.0075, 0.0088, 0.02, -0.08)
    far = gap('position', 5.0, 0.0264, 0.0193, 0.45, 0.46)
    better = replace(far, shrink_ci95=(0.09, 0.46))
    told = [near, better]
    assert not should_keep_file(told)
    (one,) = list_forecast_warnings(told)
    assert one.endswith('less accurate than those of the vehicle file: position after 1 s.')
    assert should_keep_file(
        [near, replace(far, shrink_ci95=(-0.1, 0.46))]
    )  # nothing is surely better
    assert should_keep_file([replace(near, horizon_s=7.0), better])  # the furthest is worse


@pytest.mark.parametrize('better', ['before', 'tuned', 'after'])
def test_a_model_that_predicts_as_well_as_keeping_velocity_is_of_use(better: str) -> None:
    told = replace(gap('attitude', 3.0, 0.5, 0.5, 0.3, 0.7), **{better: 0.3})
    assert not any('every model' in one for one in list_forecast_warnings([told]))
    *_, idle = list_forecast_warnings([replace(told, coast=0.29)])
    assert idle.endswith('is better than every model (attitude after 3 s).')


@pytest.mark.parametrize(('tuned', 'warned'), [(0.1, False), (0.0905, True), (0.0915, False)])
def test_a_name_with_which_forecasts_are_worse_than_with_tolerances_alone_is_warned_of(
    tuned: float, warned: bool
) -> None:
    """From 4.3 to 6.2 cm was shown without a word; a tenth more is let pass."""
    told = list_forecast_warnings([replace(gap('position', 3.0, 0.3, 0.1, 0.5, 0.7), tuned=tuned)])
    assert bool(told) is warned
    if warned:
        assert 'fitted within their tolerances (position after 3 s)' in told[0]

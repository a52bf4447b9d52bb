# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Settings of the strategies, in addition to the shared ones."""

import math

from lta_config.settings import setting, Settings

MAP_SAMPLES = 40  # places whose light DGA keeps


class CruiseSettings(Settings):
    """Settings of every strategy."""

    speed: float = setting(0.5, 'm/s', 0.0, 3.0)
    """Commanded forward airspeed."""
    search_rate: float = setting(0.3, 'rad/s', 0.0, 2.0)
    """Turn rate of the search when no lamp is seen."""


class BearingAngleSettings(Settings):
    """Settings of the bearing."""

    mean: bool = setting(False)
    """
    Whether to head along the weighted mean of the photodiodes, as in the paper, instead of the
    fitted bearing.
    """


class DitherSettings(Settings):
    """Swing of the heading, and gains from the light to the turn rate."""

    amplitude: float = setting(0.5 * math.pi, 'rad', 0.0, math.pi)
    """Amplitude of the heading oscillation."""
    rate: float = setting(0.3, 'rad/s', 0.01, 10.0)
    """Angular frequency of the heading oscillation."""
    scan: float = setting(0.3, 'rad/s', 0.0, 20.0)
    """Turn rate per unit of log brightness that varies in phase with the heading oscillation."""
    gradient: float = setting(0.0, 'rad', 0.0, 50.0)
    """Turn angle per change of log brightness that is in phase with the heading oscillation."""
    washout: float = setting(15.0, 's', 0.1, 600.0)
    """Time constant of the running mean of the log brightness."""
    floor: float = setting(5.0, 'counts', 0.01, 1e6)
    """Brightness added before taking the logarithm, which keeps it finite in darkness."""


class GradientSettings(Settings):
    """Settings of the map, the plane fit and the delays."""

    cell: float = setting(0.02, 'm', 1e-3, 10.0)
    """Side length of a cell of the light map."""
    least: float = setting(30.0, '1', 3.0, float(MAP_SAMPLES))
    """Number of brightness samples taken before the first plane is fitted to them."""
    arc: float = setting(0.5, 'rad/s', -2.0, 2.0)
    """Turn rate while the first brightness samples are taken."""
    commanded_heading: bool = setting(False)
    """Whether to dead-reckon by the commanded heading instead of that of the IMU."""
    centred: bool = setting(True)
    """Whether the fitted plane passes through the mean of the samples instead of the origin."""
    ridge: float = setting(1e-3, 'm2', 1e-9, 10.0)
    """Regularisation of the plane fit, added to the mean square of positions."""
    computing: float = setting(1.0, 's', 0.0, 60.0)
    """Delay from measuring the light to using the heading computed from it."""
    stop_beyond: float = setting(1.2, 'rad', 0.0, 3.2)
    """Heading error above which the drone stops to turn."""
    go_within: float = setting(0.5, 'rad', 0.0, 3.2)
    """Heading error below which a stopped drone flies on."""


class HomingSettings(Settings):
    """Prior knowledge of lamp, wind and drone, and the time limits of homing."""

    top_speed: float = setting(0.7, 'm/s', 0.05, 20.0)
    """Highest commanded airspeed."""
    brightness: float = setting(2100.0, 'counts', 1.0, 1e9)
    """
    Expected brightness of the lamp at 1 m, with a resistor of 100 kohm in the photodiode
    amplifiers.
    """
    unsure: float = setting(0.5, '1', 0.01, 5.0)
    """Uncertainty of the expected lamp brightness: standard deviation of its logarithm."""
    bearing_noise: float = setting(0.03, 'rad', 1e-4, 1.0)
    """Standard deviation added to the one reported with each bearing."""
    strength_noise: float = setting(0.15, '1', 0.01, 5.0)
    """Noise of a measured lamp brightness: standard deviation of its logarithm."""
    wind: float = setting(0.4, 'm/s', 0.0, 10.0)
    """Standard deviation of the wind drift assumed at the start."""
    gusts: float = setting(0.03, 'm/s', 0.0, 5.0)
    """Expected random change of the wind drift in one second."""
    settling: float = setting(6.0, 's', 0.1, 60.0)
    """
    Time for the airspeed estimate to settle after take-off; until then, larger changes of the
    drift are expected (see unsettled).
    """
    unsettled: float = setting(0.6, 'm/s', 0.0, 5.0)
    """Expected random change of the wind drift in one second, just after take-off."""
    gate: float = setting(4.0, '1', 1.0, 20.0)
    """Number of standard deviations beyond which a light measurement is rejected as an outlier."""
    echo: float = setting(0.25, '1', 0.0, 1.0)
    """
    Smallest plausible ratio of measured to expected brightness: weaker light counts as a
    reflection, and light above the inverse ratio as too bright for the lamp.
    """
    trusted: float = setting(0.5, 'rad', 0.01, 3.2)
    """Standard deviation above which a bearing is ignored."""
    doubt: float = setting(1.5, 's', 0.1, 60.0)
    """Time for which a light in another place must be seen before it is accepted as the lamp."""
    hold: float = setting(8.0, 's', 0.0, 600.0)
    """Longest time to fly by dead reckoning without light."""
    certain: float = setting(0.8, 'rad', 0.05, 3.2)
    """Largest standard deviation of the bearing with which dead reckoning is allowed."""
    arrival: float = setting(0.8, 'm', 0.1, 100.0)
    """Horizontal distance to the lamp that counts as arrival."""
    approach: float = setting(0.5, '1/s', 0.05, 5.0)
    """Without brake: ground speed per metre of remaining distance, near the lamp."""
    brake: bool = setting(True)
    """Whether to brake ahead of the lamp and stay there, instead of flying past it."""
    deceleration: float = setting(0.12, 'm/s2', 0.001, 10.0)
    """With brake: deceleration by thrust against the motion and drag that is planned with."""
    turn_rate: float = setting(0.48, 'rad/s', 0.01, 6.0)
    """With brake: mean rate of a turn about, the time to begin and end it included."""
    coasting: float = setting(5.0, 'm', 0.01, 1000.0)
    """
    With brake: distance through the air in which drag alone divides the airspeed by e; mass, with
    the air that moves along, by quadratic drag.
    """
    shade: float = setting(0.85, '1', 0.0, 1.0)
    """
    With brake: smallest ratio of measured to expected brightness near the lamp; below it the hull
    hides a part of it.
    """


class StrategySettings(CruiseSettings):
    """The cruise settings, and those of each strategy."""

    bag: BearingAngleSettings = setting(BearingAngleSettings())
    """Settings of the strategy BAG, bearing angle guidance."""
    des: DitherSettings = setting(DitherSettings())
    """Settings of the strategy DES, dither extremum seeking."""
    dga: GradientSettings = setting(GradientSettings())
    """Settings of the strategy DGA, dither-free gradient ascent."""
    homing: HomingSettings = setting(HomingSettings())
    """Settings of the strategy homing."""

"""Settings of the strategies: one line each, in addition to the shared ones."""

from lta_config.settings import setting
from lta_control.strategies.bearing_angle import BearingAngleSettings
from lta_control.strategies.dither import DitherSettings
from lta_control.strategies.gradient import GradientSettings
from lta_control.strategies.homing import HomingSettings
from lta_control.strategies.protocol import CruiseSettings


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

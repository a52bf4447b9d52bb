"""What can be set of the strategies: one line each, beside what all of them share."""

from lta_config.settings import setting
from lta_control.strategies.dither import DitherSettings
from lta_control.strategies.gradient import GradientSettings
from lta_control.strategies.homing import HomingSettings
from lta_control.strategies.protocol import CruiseSettings


class StrategySettings(CruiseSettings):
    """The cruise, and what each strategy has of its own."""

    des: DitherSettings = setting(DitherSettings(), 'DES, dither extremum seeking.')
    dga: GradientSettings = setting(GradientSettings(), 'DGA, dither-free gradient ascent.')
    homing: HomingSettings = setting(HomingSettings(), 'Homing.')

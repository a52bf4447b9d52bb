"""What can be set of the strategies: one line each, beside what all of them share."""

from lta_config.settings import setting
from lta_control.strategies.homing import HomingSettings
from lta_control.strategies.protocol import CruiseSettings


class StrategySettings(CruiseSettings):
    """The cruise, and what each strategy has of its own."""

    homing: HomingSettings = setting(HomingSettings(), 'Homing.')

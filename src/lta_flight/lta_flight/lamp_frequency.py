"""Whether the drone of a flight listens for the lamp that it is to find."""

from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_model.scenario import Scenario
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.bins import plan_beacon_bins


def check_lamp_frequency(scenario: Scenario, demodulation: DemodulationSettings) -> None:
    """
    Refuse a scene whose lamp flickers where the demodulator does not look.

    On a route the navigator asks for the frequency of each lamp, and on a course nobody seeks
    one. Otherwise the demodulator listens where it is set to, and such a flight could only time
    out.

    Raises
    ------
    BadInput
        If the lamp's nominal frequency is outside the window of bins that is searched for the
        first beacon.

    """
    if scenario.route or scenario.course is not None:
        return
    light = load_topic_table().light
    rate, samples = light.sample_rate.si, light.samples
    low, high = plan_beacon_bins(demodulation.beacons, demodulation, rate, samples)[
        0
    ].frequency_limits
    lamp = scenario.goal_lamp.frequency.si
    if not low <= lamp <= high:
        name = next(iter(scenario.lamps))
        raise BadInput(
            f'The lamp of {scenario.name} flickers at {lamp:g} Hz, but the demodulator listens '
            f'at {demodulation.frequency:g} Hz, from {low:.0f} to {high:.0f} Hz; give the '
            f"scenario a 'route: [{name}]', on which each lamp is listened for at its own "
            'frequency, or set demodulator.frequency.'
        )

"""Check that the demodulator searches for the frequency of the target lamp."""

from lta_config.errors import BadInput
from lta_config.topics import load_topic_table
from lta_model.scenario import Scenario
from lta_vlc.settings import DemodulationSettings
from lta_vlc.spectral.bins import plan_beacon_bins


def check_lamp_frequency(scenario: Scenario, demodulation: DemodulationSettings) -> None:
    """
    Reject a scene whose lamp is outside the demodulator's search window.

    On a route the navigator requests the frequency of each lamp, and on a course no lamp is
    searched. Otherwise the demodulator uses its own setting, and such a flight would only time
    out.

    Raise `BadInput` if the lamp's nominal frequency is outside the window of bins of the first
    beacon.
    """
    if scenario.route or scenario.course is not None:
        return
    light = load_topic_table().light
    rate, samples = light.sample_rate.si, light.samples
    # The first beacon is the demodulator's own frequency
    low, high = plan_beacon_bins(demodulation.beacons, demodulation, rate, samples)[
        0
    ].frequency_limits
    lamp = scenario.goal_lamp.frequency.si
    if not low <= lamp <= high:
        name = next(iter(scenario.lamps))
        raise BadInput(
            f'The lamp of {scenario.name} flickers at {lamp:g} Hz, but the demodulator listens '
            f'at {demodulation.frequency:g} Hz ({low:.0f} to {high:.0f} Hz); set '
            f"demodulator.frequency, or add 'route: [{name}]' to the scenario, so that the "
            'demodulator uses the frequency of each lamp.'
        )

"""The demodulator node: from ADC blocks to peaks and a bearing."""

from lta_config.settings import setting
from lta_graph.health import Level
from lta_graph.inbox import Step
from lta_graph.ros.node import GraphNode, run
from lta_graph.ros.parameters import Parameters
from lta_vlc.array import Bearing, bearing, even_ring, Ring
from lta_vlc.demodulation import Bins, bins_of, demodulate, Demodulation, NO_WISH, Peaks
from lta_vlc.lamp import lamp_estimate, LampEstimate, LampPrior
from lta_vlc.messages import from_bearing, from_lamp, from_peaks, to_block
import numpy as np
from sensor_msgs.msg import Image
from std_msgs.msg import Header

NOTHING = Peaks(np.empty(0), np.empty(0), np.empty(0))  # what a block says that cannot be read


class DemodulatorParameters(Demodulation):
    """The beacon to listen for, and what is known of its lamp."""

    prior: LampPrior = setting(LampPrior(), 'The lamp before it is seen.')


class Demodulator(GraphNode):
    """Answer each ADC block with peaks, the paper's vector and where the lamp is."""

    def __init__(self) -> None:
        super().__init__('demodulator')
        self._wanted = NO_WISH
        self._settings = Parameters(
            self, DemodulatorParameters, changed=self._plan, check=self._bins_of
        )
        self._plan(self._settings.value)
        self._peaks = self.output('light/peaks')
        self._bearing = self.output('light/bearing')
        self._estimate = self.output('light/estimate')
        self._refused = 0
        inputs = self.table.read_by('demodulator')
        self.listen(inputs, trigger='photodiodes', on_step=self._on_step)

    def _bins_of(self, settings: DemodulatorParameters) -> Bins:
        light = self.table.light
        return bins_of(settings, self._wanted, light.sample_rate.si, light.samples)

    def _plan(self, settings: DemodulatorParameters) -> None:
        self._bins = self._bins_of(settings)

    def _on_step(self, step: Step) -> None:
        message: Image = step.last('photodiodes')
        try:
            for wish in step.messages['light/beacon']:
                self._wanted = wish.data
                self._plan(self._settings.value)
            block = to_block(message)
            peaks = demodulate(block, self._bins)
        except ValueError as error:
            self._refused += 1
            self.health.report('light', Level.ERROR, str(error), refused=self._refused)
            if self.lockstep:  # whoever waits for the answer would wait for ever
                self._publish(message.header, NOTHING, Ring((), ()), None, None)
            return
        settings = self._settings.value
        ring = even_ring(block.shape[1])
        towards = bearing(peaks, ring, settings.threshold)
        lamp = None if towards is None else lamp_estimate(towards, settings.prior)
        self._publish(message.header, peaks, ring, towards, lamp)
        clipped = int((block >= 4095).sum())
        self.health.report(
            'light',
            Level.OK if towards is not None else Level.WARN,
            'beacon found' if towards is not None else 'no diode hears the beacon',
            best_snr=f'{peaks.snr.max():.1f}',
            clipped_samples=clipped,
        )

    def _publish(
        self,
        header: Header,
        peaks: Peaks,
        ring: Ring,
        towards: Bearing | None,
        lamp: LampEstimate | None,
    ) -> None:
        self._bearing.publish(from_bearing(header, towards))
        self._peaks.publish(from_peaks(header, peaks, ring))
        self._estimate.publish(from_lamp(header, lamp))


def main(args: list[str] | None = None) -> None:
    """Run the node until it is told to stop."""
    run(Demodulator, args)

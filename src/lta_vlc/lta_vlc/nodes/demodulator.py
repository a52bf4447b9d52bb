"""The demodulator node: from ADC blocks to peaks and a bearing."""

from lta_config.schema.vehicle_file import load_vehicle_file
from lta_config.settings import setting
from lta_graph.health import Level
from lta_graph.inbox import Step
from lta_graph.ros.node import GraphNode
from lta_graph.ros.parameters import Parameters
from lta_graph.ros.process import run
from lta_vlc.condition import conditions, WANTED
from lta_vlc.demodulation import Hearing, Peaks
from lta_vlc.diodes import diodes_of
from lta_vlc.lamp import LampPrior
from lta_vlc.lamp_finder import Found, LampFinder
from lta_vlc.listener import Listener
from lta_vlc.messages import from_bearing, from_lamp, from_peaks, to_block
from lta_vlc.sequence import Sequence
from lta_vlc.settings import Demodulation
from sensor_msgs.msg import Image
from std_msgs.msg import Header


class DemodulatorParameters(Demodulation):
    """The beacon to listen for, and what is known of its lamp."""

    vehicle: str = setting('gtmab', 'Vehicle name or file.', fixed=True)
    prior: LampPrior = setting(LampPrior(), 'The lamp before it is seen.')


class Demodulator(GraphNode):
    """Answer each ADC block with peaks, the paper's vector and where the lamp is."""

    def __init__(self) -> None:
        super().__init__('demodulator')
        self._peaks = self.output('light/peaks')
        self._bearing = self.output('light/bearing')
        self._estimate = self.output('light/estimate')
        self._settings = Parameters(
            self, DemodulatorParameters, changed=self._begin, check=self._listener_of
        )
        self._begin(self._settings.value)
        self._sequence = Sequence(self.table['photodiodes'].period_ns)
        self._refused = 0
        # After the outputs: what is published before somebody listens is lost in real time.
        entry = load_vehicle_file(self._settings.value.vehicle).sensors.diodes
        self._finder = LampFinder(diodes_of(entry))
        self._listener.prepare()  # who listens must answer at once
        self._finder.prepare()
        inputs = self.table.read_by('demodulator')
        self.listen(inputs, trigger='photodiodes', on_step=self._on_step)

    def _listener_of(self, settings: DemodulatorParameters) -> Listener:
        light, entry = self.table.light, load_vehicle_file(settings.vehicle).sensors.diodes
        return Listener(settings, light.sample_rate.si, light.samples, entry.top)

    def _begin(self, settings: DemodulatorParameters) -> None:
        self._listener = self._listener_of(settings)

    def _on_step(self, step: Step) -> None:
        message: Image = step.last('photodiodes')
        try:
            self._listener.miss(self._sequence.take(step.stamp_ns))
            for wish in step.messages['light/beacon']:
                self._listener.want(wish.data)
            block = to_block(message)
            self._finder.diodes.check(block.shape[1])
            hearing = self._listener.hear(block)
        except ValueError as error:
            self._refused += 1
            self.health.report(WANTED, Level.ERROR, str(error), blocks_refused=self._refused)
            if self.lockstep:  # whoever waits for the answer would wait for ever
                self._publish(message.header, (), Found())
            return
        settings = self._settings.value
        found = self._finder.found(hearing.peaks[0], settings.threshold, settings.prior)
        self._publish(message.header, hearing.peaks, found)
        self._tell(hearing)

    def _tell(self, hearing: Hearing) -> None:
        """Say how the light stands."""
        for fact in conditions(
            hearing,
            self._listener.beacons,
            tuple(self._listener.presences[one] for one in self._listener.beacons),
            self._sequence.missing,
            self._refused,
        ):
            self.health.report(fact.task, fact.level, fact.message, **fact.values)

    def _publish(self, header: Header, peaks: tuple[Peaks, ...], found: Found) -> None:
        self._bearing.publish(from_bearing(header, found.towards))
        self._peaks.publish(from_peaks(header, peaks, self._finder.diodes.axes))
        self._estimate.publish(from_lamp(header, found.lamp))


def main(args: list[str] | None = None) -> None:
    """Run the node until it is told to stop."""
    run(Demodulator, args)

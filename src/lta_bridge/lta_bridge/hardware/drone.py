"""Listen to a Crazyflie for a while: nothing is written, armed or turned."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
import math
from queue import Empty
import time
from typing import Final, final

from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.connection_manager import explain_mismatch, has_voltage_compensation
from lta_bridge.crazyflie.device_clock import DeviceClock
from lta_bridge.crazyflie.link import CrazyflieLink, LinkLost, LogPacket, Ping
from lta_bridge.crazyflie.log_table import BLOCKS
from lta_bridge.crazyflie.round_trips import RoundTrips
from lta_bridge.crazyflie.supervisor_word import explain_fault, SupervisorBit
from lta_bridge.hardware.check_result import HardwareCheck
from lta_bridge.hardware.stream import measure_stream, StreamStatistics
from lta_config.schema.crazyflie_file import CrazyflieFile, ExpectedParameter

DEADLINE: Final = 8.0  # s for the connection, as the bridge has it
LOSSY: Final = 0.01  # part of the packets whose loss is worth a word
SLOW: Final = 0.05  # s of round trip from which the bridge's 300 ms for a command get short
RELEASE: Final = ('firmware.revision0', 'firmware.revision1')


@final
@dataclass(frozen=True, slots=True)
class DroneMeasurement:
    """
    What a Crazyflie told.

    Attributes
    ----------
    uri : str
        Where it is.
    protocol : int
        Version of CRTP.
    revision : str
        Of the firmware, its own hexadecimal number.
    streams : tuple of Streamed
        Log blocks.
    latency : float
        95th percentile of the round trip; NaN where no answer came. [s]
    drift : float
        By how much its clock runs fast. [1]
    voltage : float
        Of the cell; NaN where unknown. [V]
    word : int or None
        The supervisor's; None where it said nothing.
    parameters : mapping of str to float or None
        Those that its vehicle needs; None for one that the firmware lacks.
    compensates : bool
        Whether the firmware corrects duties for the battery's voltage.
    lost : str
        Why the link went; empty where it did not.

    """

    uri: str
    protocol: int
    revision: str
    streams: tuple[StreamStatistics, ...]
    latency: float
    drift: float
    voltage: float
    word: int | None
    parameters: Mapping[str, float | None]
    compensates: bool
    lost: str


def measure_drone(
    link: CrazyflieLink,
    uri: str,
    file: CrazyflieFile,
    seconds: float,
    tick: Callable[[float], None],
) -> DroneMeasurement:
    """
    Return what a Crazyflie tells.

    Parameters
    ----------
    link : Link
        Open; stays open.
    uri : str
        Where it leads.
    file : CrazyflieFile
        Names the parameters that matter.
    seconds : float
        How long to listen. [s]
    tick : callable
        Told how long it has been. [s]

    """
    heard: dict[str, list[LogPacket]] = {block.name: [] for block in BLOCKS}
    clock, trips, lost = DeviceClock(), RoundTrips(), ''
    began = time.monotonic()
    while (been := time.monotonic() - began) < seconds and not lost:
        tick(been)
        try:
            event = link.events.get(timeout=min(0.1, seconds - been))
        except Empty:
            continue
        match event:
            case LogPacket() as packet:
                heard[packet.block].append(packet)
                clock.stamp_packet(packet.stamp_ms, packet.arrival_ns)
            case Ping(took):
                trips.add(took)
            case LinkLost(why):
                lost = why
    power = [readings.convert_power(packet.values) for packet in heard['power'][-1:]]
    words = [readings.convert_motors(packet.values).word for packet in heard['motors'][-1:]]
    return DroneMeasurement(
        uri=uri,
        protocol=int(getattr(link, 'protocol', -1)),
        revision=format_revision({name: link.read_parameter(name) for name in RELEASE}),
        streams=tuple(measure_stream(block, heard[block.name]) for block in BLOCKS),
        latency=trips.latency,
        drift=clock.drift,
        voltage=power[0].voltage if power else math.nan,
        word=words[0] if words else None,
        parameters={name: link.read_parameter(name) for name in file.expected},
        compensates=has_voltage_compensation(link),
        lost=lost,
    )


def format_revision(parameters: Mapping[str, float | None]) -> str:
    """Return the firmware's revision, of which a Crazyflie tells 32 and 16 bits."""
    high, low = (parameters[name] for name in RELEASE)
    if high is None:
        return 'unknown'
    return f'{int(high):08x}' + ('' if low is None else f'{int(low):04x}')


def judge_drone(
    measurement: DroneMeasurement, file: CrazyflieFile, compensated: bool
) -> Iterator[HardwareCheck]:
    """
    Yield what is to be said of a Crazyflie, the most fundamental first.

    Parameters
    ----------
    heard : DroneHeard
        What it told.
    file : CrazyflieFile
        What it should be like.
    compensated : bool
        Whether the vehicle counts on firmware that corrects duties.

    """
    if measurement.lost:
        yield HardwareCheck(
            'link', 'fail', f'lost: {measurement.lost}', 'Bring it nearer, and switch it on.'
        )
    yield HardwareCheck(
        'firmware',
        'ok',
        f'revision {measurement.revision}, protocol {measurement.protocol} at {measurement.uri}',
    )
    yield _judge_streams(measurement)
    yield _judge_latency(measurement.latency)
    yield _judge_battery(measurement.voltage, file.limits.voltage.si)
    yield _judge_supervisor(measurement.word)
    yield _judge_duties(measurement, compensated)
    for name, want in file.expected.items():
        check = _judge_parameter(name, measurement.parameters[name], want)
        if check is not None:
            yield check


def _judge_streams(measurement: DroneMeasurement) -> HardwareCheck:
    silent = [each.name for each in measurement.streams if not each.packets]
    if silent:
        remedy = 'Switch the Crazyflie off and on; update its firmware if that does not help.'
        return HardwareCheck('telemetry', 'fail', f'nothing came of {", ".join(silent)}', remedy)
    worst = max(measurement.streams, key=lambda each: each.loss)
    found = f'{len(measurement.streams)} log blocks, {worst.loss:.1%} lost of {worst.name} at most'
    if worst.loss > LOSSY:
        return HardwareCheck(
            'telemetry', 'warn', found, 'Bring it nearer, or choose a free channel.'
        )
    return HardwareCheck('telemetry', 'ok', found)


def _judge_latency(latency: float) -> HardwareCheck:
    if math.isnan(latency):
        return HardwareCheck('latency', 'warn', 'no answer to a ping', 'Check again for longer.')
    found = f'{1e3 * latency:.1f} ms there and back, 95 % of the time'
    if latency > SLOW:
        return HardwareCheck(
            'latency', 'warn', found, 'Bring it nearer, or choose a free channel.'
        )
    return HardwareCheck('latency', 'ok', found)


def _judge_battery(voltage: float, least: float) -> HardwareCheck:
    if math.isnan(voltage):
        return HardwareCheck('battery', 'warn', 'no voltage came', 'Check again for longer.')
    if voltage < least:
        found = f'{voltage:.2f} V, and below {least:.2f} V it does not arm'
        return HardwareCheck('battery', 'fail', found, 'Charge the cell.')
    return HardwareCheck('battery', 'ok', f'{voltage:.2f} V')


def _judge_supervisor(word: int | None) -> HardwareCheck:
    if word is None:
        return HardwareCheck('supervisor', 'fail', 'no word came', 'Update the firmware.')
    if why := explain_fault(word):
        return HardwareCheck('supervisor', 'fail', why, 'It does not fly until that is done.')
    if word & SupervisorBit.ARMED:
        return HardwareCheck(
            'supervisor', 'warn', 'armed by somebody', 'Disarm it before you touch it.'
        )
    ready = bool(word & SupervisorBit.CAN_BE_ARMED)
    return HardwareCheck('supervisor', 'ok', 'disarmed, and can be armed' if ready else 'disarmed')


def _judge_duties(measurement: DroneMeasurement, compensated: bool) -> HardwareCheck:
    """Return what becomes of a duty on its way to a motor."""
    if why := explain_mismatch(measurement.compensates, compensated):
        found, _, remedy = why.partition(': ')
        return HardwareCheck('duties', 'fail', found, f'{remedy[0].upper()}{remedy[1:]}.')
    idle = measurement.parameters['powerDist.idleThrust']
    thrust = 'unknown' if idle is None else f'{idle:g} of 65535'
    corrected = '' if measurement.compensates else 'not '
    return HardwareCheck(
        'duties', 'ok', f"idle thrust {thrust}, {corrected}corrected for the battery's voltage"
    )


def _judge_parameter(
    name: str, value: float | None, want: ExpectedParameter
) -> HardwareCheck | None:
    """Return what is to be said of a parameter; nothing where it is as expected."""
    if value is None:
        return HardwareCheck(
            name, 'fail', f'the firmware lacks it ({want.why})', 'Flash the firmware.'
        )
    if value == want.value:
        return None
    found = f'{value:g}, not {want.value:g} ({want.why})'
    if name == 'motorPowerSet.enable':
        return HardwareCheck(
            name, 'fail', found, 'Switch the drone off and on: its motors may turn.'
        )
    if want.write:
        return HardwareCheck(name, 'ok', f'{found}; the bridge sets it before it flies')
    return HardwareCheck(name, 'fail', found, 'Flash the firmware that the vehicle needs.')

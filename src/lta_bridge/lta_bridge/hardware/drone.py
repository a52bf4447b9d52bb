# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Measure and judge a Crazyflie from its telemetry; nothing is written, armed or turned."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
import math
from queue import Empty
import time
from typing import Final, final, NamedTuple

from lta_bridge.crazyflie import readings
from lta_bridge.crazyflie.connection_manager import explain_mismatch, has_voltage_compensation
from lta_bridge.crazyflie.device_clock import DeviceClock, RoundTrips, STAMP_WRAP
from lta_bridge.crazyflie.link import CrazyflieLink, LinkLost, LogPacket, Ping
from lta_bridge.crazyflie.log_table import LOG_BLOCKS, LogBlock
from lta_bridge.crazyflie.supervisor_word import explain_fault, SupervisorBit
from lta_bridge.hardware.check_result import assess_vehicle, HardwareCheck
from lta_config.schema.crazyflie_file import CrazyflieFile, ExpectedParameter
import numpy as np


@final
class StreamStatistics(NamedTuple):
    """Statistics of one log block."""

    name: str
    # Requested rate, and mean rate between the first and the last packet [Hz]
    requested_rate: float
    rate: float
    packets: int  # number of received packets
    loss: float  # lost fraction of the packets between the first and the last one
    # 95th percentile of the difference between arrival interval and stamp interval [s]
    jitter: float


def compute_stream_statistics(block: LogBlock, packets: Sequence[LogPacket]) -> StreamStatistics:
    """Return the statistics of one block; the packets must be in the order of arrival."""
    nominal = 1e3 / block.period_ms
    if len(packets) < 2:
        return StreamStatistics(block.name, nominal, 0.0, len(packets), float(not packets), 0.0)
    stamps = np.array([packet.stamp_ms for packet in packets])
    arrivals = np.array([packet.arrival_ns for packet in packets])
    gaps = (
        np.diff(stamps) + STAMP_WRAP // 2
    ) % STAMP_WRAP - STAMP_WRAP // 2  # the 24-bit stamps may wrap
    span = max(int(gaps.sum()), 1)
    sent = 1 + round(span / block.period_ms)
    uneven = np.abs(1e-9 * np.diff(arrivals) - 1e-3 * gaps)
    return StreamStatistics(
        block.name, nominal, 1e3 * (len(packets) - 1) / span, len(packets),
        max(0.0, 1.0 - len(packets) / sent), float(np.percentile(uneven, 95.0)),
    )  # fmt: skip


LOSSY: Final = 0.01  # packet loss above which to warn
# s of round trip; beyond it the bridge's limit of 300 ms for commands is tight
SLOW_ROUND_TRIP: Final = 0.05
RELEASE: Final = ('firmware.revision0', 'firmware.revision1')


@final
@dataclass(frozen=True, slots=True)
class DroneMeasurement:
    """Measurements of a Crazyflie."""

    uri: str
    protocol: int  # version of CRTP
    revision: str  # revision of the firmware, hexadecimal
    streams: tuple[StreamStatistics, ...]  # statistics of the log blocks
    latency: float  # 95th percentile of the round trip; NaN without an answer [s]
    drift: float  # relative rate error of its clock, positive if it runs fast [1]
    voltage: float  # cell voltage; NaN if unknown [V]
    word: int | None  # the supervisor's status word; None if it did not arrive
    # Parameters that the vehicle needs; None for one that the firmware lacks
    parameters: Mapping[str, float | None]
    # Of LTA's app: commit, and hash of the vehicle; None without the app
    commit: int | None
    vehicle: int | None
    compensates: bool  # whether the firmware corrects duties for the battery's voltage
    lost: str  # why the link was lost; empty if it was not


def measure_drone(
    link: CrazyflieLink,
    uri: str,
    file: CrazyflieFile,
    seconds: float,
    tick: Callable[[float], None],
) -> DroneMeasurement:
    """
    Record the telemetry of a Crazyflie for some seconds and return the measurements.

    The link must be open, and stays open. `file` names the parameters to read. `tick` is called
    with the elapsed time. [s]
    """
    received: dict[str, list[LogPacket]] = {block.name: [] for block in LOG_BLOCKS}
    clock, trips, lost = DeviceClock(), RoundTrips(), ''
    began = time.monotonic()
    while (elapsed := time.monotonic() - began) < seconds and not lost:
        tick(elapsed)
        try:
            # Wake up ten times a second to update the progress bar
            event = link.events.get(timeout=min(0.1, seconds - elapsed))
        except Empty:
            continue
        match event:
            case LogPacket() as packet:
                received[packet.block].append(packet)
                clock.compute_packet_time(packet.stamp_ms, packet.arrival_ns)
            case Ping(took):
                trips.add(took)
            case LinkLost(why):
                lost = why
    power = [readings.convert_power(packet.values) for packet in received['power'][-1:]]
    words = [readings.convert_motors(packet.values).word for packet in received['motors'][-1:]]
    return DroneMeasurement(
        uri=uri,
        protocol=int(getattr(link, 'protocol', -1)),
        revision=format_revision({name: link.read_parameter(name) for name in RELEASE}),
        streams=tuple(
            compute_stream_statistics(block, received[block.name]) for block in LOG_BLOCKS
        ),
        latency=trips.latency,
        drift=clock.drift,
        voltage=power[0].voltage if power else math.nan,
        word=words[0] if words else None,
        parameters={name: link.read_parameter(name) for name in file.expected},
        commit=_read_integer(link, 'lta.commit'),
        vehicle=_read_integer(link, 'lta.vehicle'),
        compensates=has_voltage_compensation(link),
        lost=lost,
    )


def _read_integer(link: CrazyflieLink, name: str) -> int | None:
    value = link.read_parameter(name)
    return None if value is None else int(value)


def format_revision(parameters: Mapping[str, float | None]) -> str:
    """Return the firmware's revision as hexadecimal text, from its 32-bit and 16-bit parts."""
    high, low = (parameters[name] for name in RELEASE)
    if high is None:
        return 'unknown'
    return f'{int(high):08x}' + ('' if low is None else f'{int(low):04x}')


def assess_drone(
    measurement: DroneMeasurement, file: CrazyflieFile, compensated: bool, airframe: int
) -> Iterator[HardwareCheck]:
    """
    Yield the checks of a Crazyflie, the most fundamental first.

    `compensated` states whether the vehicle model assumes firmware that corrects duties;
    `airframe` is the hash of vehicle and wiring.
    """
    if measurement.lost:
        yield HardwareCheck(
            'link',
            'fail',
            f'connection lost: {measurement.lost}',
            'Bring the Crazyflie closer, and check that it is switched on.',
        )
    yield HardwareCheck(
        'firmware',
        'ok',
        f'firmware revision {measurement.revision}, CRTP protocol version {measurement.protocol}, '
        f'at {measurement.uri}',
    )
    if measurement.vehicle is not None:
        yield assess_vehicle('vehicle', measurement.commit or 0, measurement.vehicle, airframe)
    yield _assess_streams(measurement)
    yield _assess_latency(measurement.latency)
    yield _assess_battery(measurement.voltage, file.limits.voltage.si)
    yield _assess_supervisor(measurement.word)
    yield _assess_duties(measurement, compensated)
    for name, want in file.expected.items():
        check = _assess_parameter(name, measurement.parameters[name], want)
        if check is not None:
            yield check


def _assess_streams(measurement: DroneMeasurement) -> HardwareCheck:
    silent = [each.name for each in measurement.streams if not each.packets]
    if silent:
        remedy = 'Switch the Crazyflie off and on; if that does not help, update its firmware.'
        return HardwareCheck(
            'telemetry',
            'fail',
            f'no packets received of the log block {", ".join(silent)}',
            remedy,
        )
    worst = max(measurement.streams, key=lambda each: each.loss)
    finding = (
        f'{len(measurement.streams)} log blocks received, at most {worst.loss:.1%} of the packets '
        f'lost ({worst.name})'
    )
    if worst.loss > LOSSY:
        return HardwareCheck(
            'telemetry',
            'warn',
            finding,
            'Bring the Crazyflie closer, or use a free radio channel.',
        )
    return HardwareCheck('telemetry', 'ok', finding)


def _assess_latency(latency: float) -> HardwareCheck:
    if math.isnan(latency):
        return HardwareCheck(
            'latency',
            'warn',
            'the Crazyflie did not answer a ping',
            'Repeat the check with a longer --seconds.',
        )
    finding = f'round trip {1e3 * latency:.1f} ms (95th percentile)'
    if latency > SLOW_ROUND_TRIP:
        return HardwareCheck(
            'latency', 'warn', finding, 'Bring the Crazyflie closer, or use a free radio channel.'
        )
    return HardwareCheck('latency', 'ok', finding)


def _assess_battery(voltage: float, least: float) -> HardwareCheck:
    if math.isnan(voltage):
        return HardwareCheck(
            'battery', 'warn', 'no voltage received', 'Repeat the check with a longer --seconds.'
        )
    if voltage < least:
        finding = f'{voltage:.2f} V, too low to arm (limit {least:.2f} V)'
        return HardwareCheck('battery', 'fail', finding, 'Charge the cell.')
    return HardwareCheck('battery', 'ok', f'{voltage:.2f} V')


def _assess_supervisor(word: int | None) -> HardwareCheck:
    if word is None:
        return HardwareCheck(
            'supervisor', 'fail', 'no status received', 'Update the firmware of the Crazyflie.'
        )
    if why := explain_fault(word):
        return HardwareCheck(
            'supervisor', 'fail', why, 'The motors stay blocked until this fault is corrected.'
        )
    if word & SupervisorBit.ARMED:
        return HardwareCheck(
            'supervisor',
            'warn',
            'armed by another program',
            'Disarm the Crazyflie before you touch it.',
        )
    ready = bool(word & SupervisorBit.CAN_BE_ARMED)
    return HardwareCheck(
        'supervisor', 'ok', 'disarmed, ready to be armed' if ready else 'disarmed'
    )


def _assess_duties(measurement: DroneMeasurement, compensated: bool) -> HardwareCheck:
    """Check how the firmware changes a duty before it reaches a motor."""
    if why := explain_mismatch(measurement.compensates, compensated):
        # The sentence has the form 'finding: remedy'
        finding, _, remedy = why.partition(': ')
        return HardwareCheck('duties', 'fail', finding, f'{remedy[0].upper()}{remedy[1:]}.')
    idle = measurement.parameters['powerDist.idleThrust']
    thrust = 'unknown' if idle is None else f'{idle:g} of 65535'
    corrects = 'corrects' if measurement.compensates else 'does not correct'
    return HardwareCheck(
        'duties', 'ok',
        f'idle thrust {thrust}; the firmware {corrects} motor duties for the battery voltage',
    )  # fmt: skip


def _assess_parameter(
    name: str, value: float | None, want: ExpectedParameter
) -> HardwareCheck | None:
    """Check a parameter; return None if it is as expected."""
    if value is None:
        return HardwareCheck(
            name,
            'fail',
            f'the firmware does not have this parameter ({want.why})',
            'Flash firmware that has this parameter.',
        )
    if value == want.value:
        return None
    finding = f'{value:g}, but must be {want.value:g} ({want.why})'
    if name == 'motorPowerSet.enable':
        return HardwareCheck(
            name,
            'fail',
            finding,
            'Switch the drone off and on, and keep clear: its motors may turn.',
        )
    if want.write:
        return HardwareCheck(name, 'ok', f'{finding}; the bridge sets it before a flight')
    return HardwareCheck(
        name, 'fail', finding, 'Flash firmware in which this parameter has that value.'
    )

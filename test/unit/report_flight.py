# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
A bag of a flight whose every figure is known by hand.

At rest for 2 s, climb of 8 cm in 2 s, then straight along x at 0.5 m/s from 7 m to 1 m before the
lamp (6 m, 12 s), then hover for 1 s. The nose points at the lamp all along; the world is still.
The estimates are wrong by constants: altitude 2 cm high, airspeed 5 cm/s low while cruising,
yaw 0.01 rad a second to the left from the start of the cruise on. The estimator's own frame is
turned by 0.3 rad. The lamp is out of sight from 10 to 12 s.
"""

from dataclasses import dataclass
from functools import cache
import math

from lta_bag import BagWriter
from lta_bag.schemas import load_jazzy_types
from lta_config.files import find_file
import numpy as np

START = 1_000_000_000
REST, CLIMB, SEEK, GOAL, END = 0.0, 2.0, 4.0, 16.0, 17.0
SPEED, FLOOR, CRUISE = 0.5, 0.42, 0.5
TURN = 0.3
VOLTAGE, RESTING, FLYING = 4.0, 0.025, 0.4
DIODES = [k * math.pi / 4 for k in range(8)]
ROTORS = ['up_left', 'up_right', 'forward_left', 'forward_right']
TYPES = load_jazzy_types().types
TOPICS = {
    'ground_truth/odom': 'nav_msgs/msg/Odometry',
    'odom': 'nav_msgs/msg/Odometry',
    'range': 'sensor_msgs/msg/Range',
    'motors': 'lta_msgs/msg/ActuatorDuty',
    'setpoint/pose': 'geometry_msgs/msg/PoseStamped',
    'setpoint/velocity': 'geometry_msgs/msg/TwistStamped',
    'wind': 'geometry_msgs/msg/Vector3Stamped',
    'photodiodes': 'lta_msgs/msg/LightBlock',
    'light/peaks': 'lta_msgs/msg/LampPeaks',
    'light/bearing': 'geometry_msgs/msg/Vector3Stamped',
    'light/estimate': 'geometry_msgs/msg/PoseWithCovarianceStamped',
    'battery': 'sensor_msgs/msg/BatteryState',
    'panel': 'sensor_msgs/msg/BatteryState',
}


def make(type_name, **given):
    """Return a message with every field that is not given at zero."""
    fields = {}
    for name, (kind, what) in load_jazzy_types().fielddefs[type_name][1]:
        if name in given:
            fields[name] = given[name]
        elif int(kind) == 2:
            fields[name] = make(what)
        elif int(kind) == 1:
            fields[name] = {'string': '', 'bool': False}.get(what[0], 0)
        elif int(kind) == 3:
            fields[name] = np.zeros(what[1])
        else:
            inner = what[0]
            text = int(inner[0]) == 2 or inner[1][0] == 'string'
            fields[name] = (
                [] if text else np.zeros(0, {'byte': 'u1'}.get(inner[1][0], inner[1][0]))
            )
    return TYPES[type_name](**fields)


def header(time):
    nanoseconds = START + round(time * 1e9)
    stamp = make(
        'builtin_interfaces/msg/Time', sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9
    )
    return make('std_msgs/msg/Header', stamp=stamp)


def vector(x, y, z):
    return make('geometry_msgs/msg/Vector3', x=x, y=y, z=z)


def pose(x, y, z, yaw):
    return make(
        'geometry_msgs/msg/Pose',
        position=make('geometry_msgs/msg/Point', x=x, y=y, z=z),
        orientation=make('geometry_msgs/msg/Quaternion', z=math.sin(yaw / 2), w=math.cos(yaw / 2)),
    )


def odometry(time, place, z, yaw, speed):
    covered = make('geometry_msgs/msg/PoseWithCovariance', pose=pose(*place, z, yaw))
    twist = make('geometry_msgs/msg/Twist', linear=vector(speed, 0.0, 0.0))
    moving = make('geometry_msgs/msg/TwistWithCovariance', twist=twist)
    return make('nav_msgs/msg/Odometry', header=header(time), pose=covered, twist=moving)


def place(time):
    """Return x, z and forward speed of the hull centre [m, m/s]."""
    cruising = SEEK <= time <= GOAL
    x = -3.5 + SPEED * min(max(time - SEEK, 0.0), GOAL - SEEK)
    z = FLOOR + (CRUISE - FLOOR) * min(max(time - CLIMB, 0.0) / (SEEK - CLIMB), 1.0)
    return x, z, SPEED if cruising else 0.0


def truth(time):
    x, z, speed = place(time)
    return odometry(time, (x, 0.0), z, 0.0, speed)


def estimate(time):
    x, z, speed = place(time)
    yaw = TURN + 0.01 * max(time - SEEK, 0.0)
    way = (x + 3.5) * math.cos(TURN), (x + 3.5) * math.sin(TURN)
    return odometry(time, way, z + 0.02, yaw, speed - 0.05 if speed else 0.0)


def motors(time):
    flying = 0.5 if time >= CLIMB else 0.0
    cruising = 0.3 if SEEK <= time < GOAL else 0.0
    return make(
        'lta_msgs/msg/ActuatorDuty',
        header=header(time),
        name=list(ROTORS),
        duty=np.array([flying, flying, cruising, cruising]),
    )


def battery(time):
    current = FLYING if time >= CLIMB else RESTING
    return make(
        'sensor_msgs/msg/BatteryState', header=header(time), voltage=VOLTAGE, current=-current
    )


def panel(time):
    return make('sensor_msgs/msg/BatteryState', header=header(time), voltage=5.0, current=0.001)


def amplitudes(time):
    """Return what each diode sees of the lamp ahead: cosine and inverse square [counts]."""
    x, _, _ = place(time)
    return 500.0 / (3.5 - x) ** 2 * np.maximum(np.cos(DIODES), 0.0)


def block(time):
    t = time + np.arange(1000) * 1e-4
    lamp = np.where(t * 150.0 % 1.0 < 0.5, 1.0, -1.0)[:, None] * amplitudes(time) * math.pi / 4
    counts = 500 + lamp + 20 * np.sin(2 * np.pi * 100 * t)[:, None]
    noise = np.random.default_rng(round(time * 10)).normal(size=counts.shape)
    data = np.rint(counts + noise).astype(np.uint16)
    return make(
        'lta_msgs/msg/LightBlock',
        header=header(time),
        sample_rate=1e4,
        diodes=8,
        counts=data.ravel(),
    )


def peaks(time):
    seen = amplitudes(time)
    return make(
        'lta_msgs/msg/LampPeaks',
        header=header(time),
        axis=[vector(math.cos(angle), math.sin(angle), 0.0) for angle in DIODES],
        beacon=[
            make(
                'lta_msgs/msg/BeaconPeaks',
                amplitude=seen.astype(np.float32),
                snr=(10 * seen).astype(np.float32),
                frequency=np.full(8, 150.0, np.float32),
            )
        ],
    )


def bearing(time):
    """Return a bearing that is wrong by 0.05 rad to either side in turn."""
    angle = 0.05 if round(time * 10) % 2 else -0.05
    seen = time >= SEEK and not 10.0 <= time < 12.0
    length = 0.5 if seen else 0.0
    return make(
        'geometry_msgs/msg/Vector3Stamped',
        header=header(time),
        vector=vector(length * math.cos(angle), length * math.sin(angle), 0.0),
    )


def sighting(time):
    """Return a lamp 4 m away that is 0.02 rad to the left, and seen longer than the bearing."""
    seen = time >= SEEK and not 10.0 <= time < 11.0
    covariance = np.zeros(36)
    covariance[0] = 1.0 if seen else -1.0
    place = (4.0 * math.cos(0.02), 4.0 * math.sin(0.02), 0.3) if seen else (0.0, 0.0, 0.0)
    return make(
        'geometry_msgs/msg/PoseWithCovarianceStamped',
        header=header(time),
        pose=make(
            'geometry_msgs/msg/PoseWithCovariance',
            pose=pose(*place, 0.0),
            covariance=covariance,
        ),
    )


@dataclass(frozen=True)
class Stream:
    period: float
    message: object


STREAMS = {
    'ground_truth/odom': Stream(0.02, truth),
    'odom': Stream(0.01, estimate),
    'range': Stream(
        0.025,
        lambda t: make('sensor_msgs/msg/Range', header=header(t), range=place(t)[1] - 0.37),
    ),
    'motors': Stream(0.01, motors),
    'setpoint/pose': Stream(
        0.1,
        lambda t: make(
            'geometry_msgs/msg/PoseStamped', header=header(t), pose=pose(0, 0, CRUISE, TURN)
        ),
    ),
    'setpoint/velocity': Stream(
        0.1,
        lambda t: make(
            'geometry_msgs/msg/TwistStamped',
            header=header(t),
            twist=make(
                'geometry_msgs/msg/Twist', linear=vector(0.5 if SEEK <= t < GOAL else 0.0, 0, 0)
            ),
        ),
    ),
    'wind': Stream(0.1, lambda t: make('geometry_msgs/msg/Vector3Stamped', header=header(t))),
    'photodiodes': Stream(0.1, block),
    'light/peaks': Stream(0.1, peaks),
    'light/bearing': Stream(0.1, bearing),
    'light/estimate': Stream(0.1, sighting),
    'battery': Stream(0.1, battery),
    'panel': Stream(0.1, panel),
}


def provenance():
    """Return what a recorder would have been told."""
    return {
        'commit': '0123456789abcdef',
        'seed': '7',
        'vehicle': 'gtmab',
        'scenario': 'lamp_room',
        'strategy': 'bag',
        'time': 'lockstep',
        'vehicle_file': find_file('vehicle', 'gtmab').read_text(encoding='utf-8'),
        'scenario_file': find_file('scenario', 'lamp_room').read_text(encoding='utf-8'),
    }


@cache  # the flights that tests write have most messages in common
def encoded(topic, stream, time):
    """Return the bytes of one message of a stream."""
    return bytes(load_jazzy_types().serialize_cdr(stream.message(time), TOPICS[topic]))


def write_flight(folder, *, without=(), until=END, facts=None, instead=None):
    """Write the bag of the flight, perhaps without some topics or cut short, and return it."""
    streams = STREAMS | (instead or {})
    events = []
    for topic, stream in streams.items():
        if topic not in without:
            count = round(until / stream.period)
            events += [(k * stream.period, topic) for k in range(count + 1)]
    with BagWriter(folder, provenance() if facts is None else facts) as bag:
        for topic in STREAMS:
            if topic not in without:
                bag.add_topic(f'/lta1/{topic}', TOPICS[topic], [])
        for time, topic in sorted(events):
            data = encoded(topic, streams[topic], round(time, 6))
            bag.write(f'/lta1/{topic}', data, START + round(time * 1e9))
    return folder

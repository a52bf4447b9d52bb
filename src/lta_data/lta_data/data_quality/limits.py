# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Define the thresholds of the checks, with reasons.

They were chosen before scoring, see docs/trust.md.
"""

from typing import Final

# Minimum number of samples of a channel; channels with fewer are not checked
LEAST_SAMPLES: Final = 50
# Shortest time with the same value that is reported as a frozen sensor; a shorter one counts as
# a lost message [s]
FROZEN_TIME: Final = 0.15
# Minimum number of equal readings in a row that is reported as a frozen sensor
FROZEN_SAMPLES: Final = 8
# Equal readings in a row count as a frozen sensor if their probability by chance is below this
FROZEN_CHANCE: Final = 1e-9
# Equal readings in a row count as a frozen sensor if there are at least this many times more
# than usual
FROZEN_TIMES: Final = 5.0
# Minimum number of readings at the extreme value that is reported as clipping
CLIPPED_SAMPLES: Final = 8
# Minimum number of readings in a row at the extreme value that is reported as clipping
CLIPPED_RUN: Final = 4
# The extreme value of a clipped channel occurs at least this many times as often as the adjacent
# values
CLIPPED_PILE: Final = 2.5
# Minimum number of sample blocks at an ADC limit that is reported as clipping; one may be a
# flash of light
ADC_BLOCKS: Final = 3
# Minimum number of readings in a row that is reported if they occur twice, bit for bit
DUPLICATED_SAMPLES: Final = 16
# Minimum number of changes of value in repeated readings; with fewer, the sensor is at rest
DUPLICATED_LEVELS: Final = 12
# Largest deviation from 9.81 m/s2 at rest that is not reported (BMI088 sensor: 0.45) [m/s2]
STILL_FORCE: Final = 0.8
# Largest standard deviation of the acceleration at which a vehicle counts as at rest [m/s2]
STILL_SPREAD: Final = 0.15
# Smallest jump of a position that is reported, beyond what the speed before it allows [m]
JUMP_SIZE: Final = 0.04
# Smallest turn from one attitude to the next that is reported, beyond what the rates before it
# allow [rad]
JUMP_TURN: Final = 0.5
# Lowest plausible noise of a position: a tenth of the 30 um of Vicon motion capture [m]
QUIET_POSITION: Final = 3e-6
# Lowest plausible noise of an attitude: 1/30 of the 3e-4 rad of Vicon motion capture [rad]
QUIET_ATTITUDE: Final = 1e-5
# Lowest plausible noise of a velocity that was computed from tracked poses and smoothed [m/s]
QUIET_VELOCITY: Final = 3e-6
# Lowest plausible noise of angular rates: 1/30 of a good gyroscope [rad/s]
QUIET_RATES: Final = 3e-5
# Lowest plausible noise of a specific force: 1/30 of a good accelerometer [m/s2]
QUIET_FORCE: Final = 3e-4
# Lowest plausible noise of a pressure: a tenth of the best barometers [Pa]
QUIET_PRESSURE: Final = 0.02
# Length of the KERNEL that smooths two channels before they are compared [s]
KERNEL: Final = 0.25
# Shortest overlap of two channels that are compared [s]
PAIR_TIME: Final = 6.0
# Lowest correlation at which two channels count as the same motion
MOTION_CORRELATION: Final = 0.8
# Smallest angular rates that count as motion, not as noise of the motion capture [rad/s]
TURN_MOTION: Final = 0.006
# Smallest speeds that count as motion, not as noise of the motion capture [m/s]
SPEED_MOTION: Final = 0.01
# Smallest lateral specific force that counts as motion, not as noise of the motion capture
# [m/s2]
FORCE_MOTION: Final = 0.08
# Smallest change of height that counts as motion, not as noise [m]
HEIGHT_MOTION: Final = 0.12
# Relative tolerance of the ratio between two channels when it is compared with that of a wrong
# unit, such as 1000
FACTOR_SPREAD: Final = 0.25
# Largest plausible tilt; an attitude beyond it most of the time is reported [deg]
UPRIGHT_TILT: Final = 60.0
# Largest lag between two channels that is not reported; motion capture, filters and radios cause
# some [s]
LARGEST_CLOCK_OFFSET: Final = 0.04
# A lag is reported if it exceeds LARGEST_CLOCK_OFFSET by more than this many standard errors
CLOCK_SIGMAS: Final = 3.0
# Largest lag between two channels that is searched for [s]
CLOCK_SEARCH: Final = 2.5
# A lag is reported if correcting it divides 1 - correlation by at least this
CLOCK_GAIN: Final = 1.5
# A lag or drift is reported if the correlation after correcting it exceeds this
WANDER_AGREE: Final = 0.7
# Shortest gap that is reported, in message periods (GAP_TIME applies too)
GAP_PERIODS: Final = 5.0
# Shortest time without a message that is reported as a gap (GAP_PERIODS applies too) [s]
GAP_TIME: Final = 0.25
# Lowest share of lost messages that is reported
DROPOUT_SHARE: Final = 0.05
# Smallest jump of the time stamps relative to the log time that is reported [s]
LOG_JUMP: Final = 0.5
# Shortest overlap at which two recordings are checked for being the same run [s]
TWIN_TIME: Final = 5.0
# Least agreement of the signs of the noise at which two recordings count as the same run, and by
# how many of its standard deviations at other offsets (pairs of 36 real flights that agree by 0.5:
# at most 2.8; copies of these, cut by a third: at least 5.6)
TWIN_AGREE: Final = 0.5
TWIN_CLEAR: Final = 4.0
# Lower limit of the frequencies at which a hand trembles [Hz]
TREMOR_LOW: Final = 6.0
# Upper limit of the frequencies at which a hand trembles [Hz]
TREMOR_HIGH: Final = 12.0
# Smallest acceleration from TREMOR_LOW to TREMOR_HIGH that is reported as a hand holding the
# vehicle [m/s2]
TREMOR_FORCE: Final = 0.04
# Smallest ratio of the acceleration from TREMOR_LOW to TREMOR_HIGH to that above, for a hand to
# be reported
TREMOR_FLANK: Final = 3.0
# Smallest ratio of the acceleration from TREMOR_LOW to TREMOR_HIGH to its usual value in the
# recording, for a hand to be reported
TREMOR_USUAL: Final = 4.0
# Shortest time for which a vehicle held or carried by hand is reported [s]
HOLD_WINDOW: Final = 1.0
# Largest duty at which a rotor counts as idle (no lift)
IDLE_DUTY: Final = 0.03
# Lowest speed with idle rotors at which a vehicle is reported as carried by hand [m/s]
CARRIED_SPEED: Final = 0.25
# Lowest acceleration with idle rotors at which a vehicle is reported as carried by hand [m/s2]
CARRIED_FORCE: Final = 0.6

"""Define the thresholds of the checks, with reasons."""

from typing import final

from lta_config.settings import setting, Settings


@final
class QualityLimits(Settings):
    """Thresholds; the defaults were chosen before scoring, see docs/trust.md."""

    least_samples: int = setting(
        50, 'Minimum number of samples of a channel; channels with fewer are not checked.'
    )

    frozen_time: float = setting(
        0.15,
        'Shortest time with the same value that is reported as a frozen sensor; a shorter one '
        'counts as a lost message.',
        unit='s',
    )
    frozen_samples: int = setting(
        8, 'Minimum number of equal readings in a row that is reported as a frozen sensor.'
    )
    frozen_chance: float = setting(
        1e-9,
        'Equal readings in a row count as a frozen sensor if their probability by chance is below '
        'this.',
    )
    frozen_times: float = setting(
        5.0,
        'Equal readings in a row count as a frozen sensor if there are at least this many times '
        'more than usual.',
    )

    clipped_samples: int = setting(
        8, 'Minimum number of readings at the extreme value that is reported as clipping.'
    )
    clipped_run: int = setting(
        4, 'Minimum number of readings in a row at the extreme value that is reported as clipping.'
    )
    clipped_pile: float = setting(
        2.5,
        'The extreme value of a clipped channel occurs at least this many times as often as the '
        'adjacent values.',
    )
    adc_blocks: int = setting(
        3,
        'Minimum number of sample blocks at an ADC limit that is reported as clipping; one may be '
        'a flash of light.',
    )

    duplicated_samples: int = setting(
        16,
        'Minimum number of readings in a row that is reported if they occur twice, bit for bit.',
    )
    duplicated_levels: int = setting(
        12,
        'Minimum number of changes of value in repeated readings; with fewer, the sensor is '
        'at rest.',
    )

    still_force: float = setting(
        0.8,
        'Largest deviation from 9.81 m/s2 at rest that is not reported (BMI088 sensor: 0.45).',
        unit='m/s2',
    )
    still_spread: float = setting(
        0.15,
        'Largest standard deviation of the acceleration at which a vehicle counts as at rest.',
        unit='m/s2',
    )
    jump_size: float = setting(
        0.04,
        'Smallest jump of a position that is reported, beyond what the speed before it allows.',
        unit='m',
    )
    jump_turn: float = setting(
        0.5,
        'Smallest turn from one attitude to the next that is reported, beyond what the rates '
        'before it allow.',
        unit='rad',
    )

    quiet_position: float = setting(
        3e-6,
        'Lowest plausible noise of a position: a tenth of the 30 um of Vicon motion capture.',
        unit='m',
    )
    quiet_attitude: float = setting(
        1e-5,
        'Lowest plausible noise of an attitude: 1/30 of the 3e-4 rad of Vicon motion capture.',
        unit='rad',
    )
    quiet_velocity: float = setting(
        3e-6,
        'Lowest plausible noise of a velocity that was computed from tracked poses and smoothed.',
        unit='m/s',
    )
    quiet_rates: float = setting(
        3e-5, 'Lowest plausible noise of angular rates: 1/30 of a good gyroscope.', unit='rad/s'
    )
    quiet_force: float = setting(
        3e-4,
        'Lowest plausible noise of a specific force: 1/30 of a good accelerometer.',
        unit='m/s2',
    )
    quiet_pressure: float = setting(
        0.02, 'Lowest plausible noise of a pressure: a tenth of the best barometers.', unit='Pa'
    )

    kernel: float = setting(
        0.25, 'Length of the kernel that smooths two channels before they are compared.', unit='s'
    )
    pair_time: float = setting(
        6.0, 'Shortest overlap of two channels that are compared.', unit='s'
    )
    agree: float = setting(
        0.8, 'Lowest correlation at which two channels count as the same motion.'
    )
    turn_motion: float = setting(
        0.006,
        'Smallest angular rates that count as motion, not as noise of the motion capture.',
        unit='rad/s',
    )
    speed_motion: float = setting(
        0.01,
        'Smallest speeds that count as motion, not as noise of the motion capture.',
        unit='m/s',
    )
    force_motion: float = setting(
        0.08,
        'Smallest lateral specific force that counts as motion, not as noise of the motion '
        'capture.',
        unit='m/s2',
    )
    height_motion: float = setting(
        0.12, 'Smallest change of height that counts as motion, not as noise.', unit='m'
    )
    factor_spread: float = setting(
        0.25,
        'Relative tolerance of the ratio between two channels when it is compared with that of a '
        'wrong unit, such as 1000.',
    )
    upright: float = setting(
        60.0,
        'Largest plausible tilt; an attitude beyond it most of the time is reported.',
        unit='deg',
    )

    clock_offset: float = setting(
        0.04,
        'Largest lag between two channels that is not reported; motion capture, filters and '
        'radios cause some.',
        unit='s',
    )
    clock_sigmas: float = setting(
        3.0, 'A lag is reported if it exceeds clock_offset by more than this many standard errors.'
    )
    clock_search: float = setting(
        2.5, 'Largest lag between two channels that is searched for.', unit='s'
    )
    clock_gain: float = setting(
        1.5, 'A lag is reported if correcting it divides 1 - correlation by at least this.'
    )

    wander_agree: float = setting(
        0.7, 'A large clock drift is reported if the correlation after correcting it exceeds this.'
    )

    gap_periods: float = setting(
        5.0, 'Shortest gap that is reported, in message periods (gap_time applies too).'
    )
    gap_time: float = setting(
        0.25,
        'Shortest time without a message that is reported as a gap (gap_periods applies too).',
        unit='s',
    )
    dropout_share: float = setting(0.05, 'Lowest share of lost messages that is reported.')
    log_jump: float = setting(
        0.5,
        'Smallest jump of the time stamps relative to the log time that is reported.',
        unit='s',
    )

    twin_time: float = setting(
        5.0,
        'Shortest overlap at which two recordings are checked for being the same run.',
        unit='s',
    )
    twin_agree: float = setting(
        0.5,
        'Lowest correlation of the noise at which two recordings count as the same run (repeated '
        'flights: below 0.35; copies at another rate: above 0.55).',
    )

    tremor_low: float = setting(
        6.0, 'Lower limit of the frequencies at which a hand trembles.', unit='Hz'
    )
    tremor_high: float = setting(
        12.0, 'Upper limit of the frequencies at which a hand trembles.', unit='Hz'
    )
    tremor_force: float = setting(
        0.04,
        'Smallest acceleration from tremor_low to tremor_high that is reported as a hand holding '
        'the vehicle.',
        unit='m/s2',
    )
    tremor_flank: float = setting(
        3.0,
        'Smallest ratio of the acceleration from tremor_low to tremor_high to that above, for a '
        'hand to be reported.',
    )
    tremor_usual: float = setting(
        4.0,
        'Smallest ratio of the acceleration from tremor_low to tremor_high to its usual value in '
        'the recording, for a hand to be reported.',
    )
    hold_window: float = setting(
        1.0, 'Shortest time for which a vehicle held or carried by hand is reported.', unit='s'
    )
    idle_duty: float = setting(0.03, 'Largest duty at which a rotor counts as idle (no lift).')
    carried_speed: float = setting(
        0.25,
        'Lowest speed with idle rotors at which a vehicle is reported as carried by hand.',
        unit='m/s',
    )
    carried_force: float = setting(
        0.6,
        'Lowest acceleration with idle rotors at which a vehicle is reported as carried by hand.',
        unit='m/s2',
    )

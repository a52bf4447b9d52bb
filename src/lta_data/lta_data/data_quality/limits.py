"""Define the thresholds of the checks, with reasons."""

from typing import final

from lta_config.settings import setting, Settings


@final
class QualityLimits(Settings):
    """Thresholds; the defaults were chosen before scoring, see docs/trust.md."""

    least_samples: int = setting(
        50, 'Fewest samples for judging a channel; channels with fewer are not judged.'
    )

    frozen_time: float = setting(
        0.15,
        'Shortest freeze that is reported; a shorter stop counts as a lost message.',
        unit='s',
    )
    frozen_samples: int = setting(
        8, 'Fewest equal readings in a row that are reported as a freeze.'
    )
    frozen_chance: float = setting(
        1e-9,
        'A run of equal readings counts as a frozen sensor if chance would produce it with a '
        'lower probability than this.',
    )
    frozen_times: float = setting(
        5.0, 'Smallest ratio of a freeze to the usual length of runs of equal readings.'
    )

    clipped_samples: int = setting(
        8, 'Fewest readings at the extreme value that are reported as clipping.'
    )
    clipped_run: int = setting(
        4, 'Clipping has at least one run of this many readings at the extreme value.'
    )
    clipped_pile: float = setting(
        2.5, 'Clipping has at least this many times the readings of the adjacent values.'
    )
    adc_blocks: int = setting(
        3, 'Fewest blocks at a limit of the ADC that are reported; one may be a flash.'
    )

    duplicated_samples: int = setting(
        16, 'Length of a stretch that is reported if it occurs twice, bit for bit.'
    )
    duplicated_levels: int = setting(
        12, 'Fewest changes of value in such a stretch; with fewer, it is at rest.'
    )

    still_force: float = setting(
        0.8, 'Largest error of 9.81 m/s2 at rest that is not reported (BMI088: 0.45).', unit='m/s2'
    )
    still_spread: float = setting(
        0.15, 'Largest standard deviation of an accelerometer that counts as at rest.', unit='m/s2'
    )
    jump_speed: float = setting(
        60.0,
        'Largest plausible speed between two poses; a faster change is reported as a jump.',
        unit='m/s',
    )
    jump_size: float = setting(
        0.25,
        'Smallest jump of the position that is reported; trackers make smaller ones.',
        unit='m',
    )

    quiet_position: float = setting(
        3e-6, 'Least plausible noise of a position: a tenth of the 30 um of Vicon.', unit='m'
    )
    quiet_attitude: float = setting(
        1e-5, 'Least plausible noise of an attitude: 1/30 of the 3e-4 rad of Vicon.', unit='rad'
    )
    quiet_velocity: float = setting(
        3e-6,
        'Lowest plausible noise of a velocity that was computed from tracked poses and smoothed.',
        unit='m/s',
    )
    quiet_rates: float = setting(
        3e-5, 'Least plausible noise of angular rates: 1/30 of a good gyroscope.', unit='rad/s'
    )
    quiet_force: float = setting(
        3e-4,
        'Least plausible noise of a specific force: 1/30 of a good accelerometer.',
        unit='m/s2',
    )
    quiet_pressure: float = setting(
        0.02, 'Least plausible noise of a pressure: a tenth of the best barometers.', unit='Pa'
    )

    kernel: float = setting(
        0.25, 'Length of the kernel that smooths two channels before they are compared.', unit='s'
    )
    pair_time: float = setting(
        6.0, 'Shortest overlap of two channels that are compared.', unit='s'
    )
    agree: float = setting(0.8, 'Correlation from which two channels count as the same motion.')
    turn_motion: float = setting(
        0.006,
        "Smallest angular rates that count as motion, not as a tracker's noise.",
        unit='rad/s',
    )
    speed_motion: float = setting(
        0.01, "Smallest speeds that count as motion, not as a tracker's noise.", unit='m/s'
    )
    force_motion: float = setting(
        0.08,
        "Smallest lateral specific force that counts as motion, not as a tracker's noise.",
        unit='m/s2',
    )
    height_motion: float = setting(
        0.12, 'Smallest change of height that counts as motion, not as noise.', unit='m'
    )
    factor_spread: float = setting(
        0.25, 'Tolerance of a ratio of two channels that reveals a wrong unit, such as 1000.'
    )
    upright: float = setting(
        60.0,
        'Largest plausible tilt; an attitude beyond it most of the time is reported.',
        unit='deg',
    )

    clock_offset: float = setting(
        0.04, 'Largest lag that is not reported; trackers, filters and radios cause it.', unit='s'
    )
    clock_sigmas: float = setting(
        3.0, 'Standard errors by which a lag must exceed clock_offset to be reported.'
    )
    clock_search: float = setting(2.5, 'Largest lag that is searched for.', unit='s')
    clock_gain: float = setting(
        1.5, 'Factor by which correcting a lag must reduce 1 - correlation to be reported.'
    )

    wander_agree: float = setting(
        0.7, 'Smallest correlation after correcting a clock drift for which the drift is reported.'
    )

    gap_periods: float = setting(
        5.0, 'Periods without a message from which a gap is reported (see gap_time too).'
    )
    gap_time: float = setting(
        0.25,
        'Time without a message from which a gap is reported (see gap_periods too).',
        unit='s',
    )
    dropout_share: float = setting(0.05, 'Share of lost messages from which they are reported.')
    regular: float = setting(
        0.3, 'Largest relative spread of the period of a topic whose gaps are judged.'
    )
    log_jump: float = setting(
        0.5, 'Smallest jump of the message stamps against the log time that is reported.', unit='s'
    )

    twin_time: float = setting(
        5.0,
        'Shortest common part of two recordings that are checked for being the same run.',
        unit='s',
    )
    twin_agree: float = setting(
        0.97, 'Correlation from which two recordings are the same run (repeats: below 0.9).'
    )

    tremor_low: float = setting(
        6.0, 'Lower end of the frequencies at which a hand trembles.', unit='Hz'
    )
    tremor_high: float = setting(
        12.0, 'Upper end of the frequencies at which a hand trembles.', unit='Hz'
    )
    tremor_force: float = setting(
        0.04,
        'Acceleration at the frequencies of a hand from which one may hold the vehicle.',
        unit='m/s2',
    )
    tremor_flank: float = setting(
        3.0, 'Smallest ratio of the tremor of a hand to the band above its frequencies.'
    )
    tremor_usual: float = setting(
        4.0, 'Smallest ratio of the tremor of a hand to the usual level in this recording.'
    )
    hold_window: float = setting(
        1.0, 'Shortest time for which a held or carried vehicle is reported.', unit='s'
    )
    idle_duty: float = setting(0.03, 'Largest duty at which a rotor counts as idle (no lift).')
    carried_speed: float = setting(
        0.25, 'Speed from which a vehicle with idle rotors is reported as carried.', unit='m/s'
    )
    carried_force: float = setting(
        0.6,
        'Acceleration from which a vehicle with idle rotors is reported as carried.',
        unit='m/s2',
    )

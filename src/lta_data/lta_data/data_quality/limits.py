"""Define the thresholds of the checks, with reasons."""

from typing import final

from lta_config.settings import setting, Settings


@final
class QualityLimits(Settings):
    """Thresholds; the defaults were chosen before scoring, see docs/trust.md."""

    least_samples: int = setting(50, 'Channels with fewer samples are not judged.')

    frozen_time: float = setting(0.15, 'A shorter stop is a lost message.', unit='s')
    frozen_samples: int = setting(8, 'Fewer equal readings happen with coarse instruments.')
    frozen_chance: float = setting(
        1e-9, 'Probability of such a run by chance in the whole channel.'
    )
    frozen_times: float = setting(
        5.0, 'Ratio to the usual length of runs; regular repeats come from slow sampling.'
    )

    clipped_samples: int = setting(8, 'Readings at the extreme: fewer are a broad maximum.')
    clipped_run: int = setting(4, 'Consecutive readings at the extreme, at least once.')
    clipped_pile: float = setting(
        2.5, 'Ratio to the readings at adjacent values: noise thins out towards an extreme.'
    )
    adc_blocks: int = setting(3, 'Blocks at a limit of the ADC: a single one may be a flash.')

    duplicated_samples: int = setting(16, 'Readings in a row that are equal bit for bit.')
    duplicated_levels: int = setting(12, 'Changes among them; otherwise the channel is at rest.')

    still_force: float = setting(0.8, 'The BMI088 allows 0.45 m/s2 of 9.81 at rest.', unit='m/s2')
    still_spread: float = setting(0.15, 'A resting accelerometer spreads less.', unit='m/s2')
    jump_speed: float = setting(
        60.0, 'Between two poses: no tracked indoor vehicle is so fast.', unit='m/s'
    )
    jump_size: float = setting(0.25, "Smaller jumps are a tracker's change of solution.", unit='m')

    quiet_position: float = setting(3e-6, 'The quietest tracker: 30 um of Vicon / 10.', unit='m')
    quiet_attitude: float = setting(1e-5, 'Vicon 3e-4 / 30.', unit='rad')
    quiet_velocity: float = setting(3e-6, 'Derived from such a tracker, smoothed.', unit='m/s')
    quiet_rates: float = setting(3e-5, 'A good gyroscope: 1e-3 / 30.', unit='rad/s')
    quiet_force: float = setting(3e-4, 'A good accelerometer: 1e-2 / 30.', unit='m/s2')
    quiet_pressure: float = setting(0.02, 'The quietest barometers: 0.2 Pa / 10.', unit='Pa')

    kernel: float = setting(0.25, 'Smoothing of both sides of a comparison.', unit='s')
    pair_time: float = setting(6.0, 'Least overlap of two compared channels.', unit='s')
    agree: float = setting(0.8, 'Correlation from which two channels are the same motion.')
    turn_motion: float = setting(0.006, "Angular rates above a tracker's noise.", unit='rad/s')
    speed_motion: float = setting(0.01, "Speeds above a tracker's noise.", unit='m/s')
    force_motion: float = setting(
        0.08, "Lateral specific force above a tracker's noise.", unit='m/s2'
    )
    height_motion: float = setting(0.12, 'Climb that a barometer detects.', unit='m')
    factor_spread: float = setting(0.25, 'Tolerance of a unit factor: calibration and lag.')
    upright: float = setting(
        60.0, 'A vehicle tilted further for long has a wrong attitude.', unit='deg'
    )

    clock_offset: float = setting(
        0.04, 'Smaller lags of a tracker, filter or radio are usual.', unit='s'
    )
    clock_sigmas: float = setting(3.0, 'Standard errors from which an offset is significant.')
    clock_search: float = setting(2.5, 'Largest offset of the search.', unit='s')
    clock_gain: float = setting(
        1.5, 'Factor by which removing the offset must reduce the mismatch.'
    )

    wander_agree: float = setting(0.7, 'Correlation of all axes after a drift is removed.')

    gap_periods: float = setting(5.0, 'A gap is longer than this many periods ...')
    gap_time: float = setting(0.25, '... and longer than this.', unit='s')
    dropout_share: float = setting(0.05, 'Share of lost messages that affects statistics.')
    regular: float = setting(
        0.3, 'Largest spread of the period, relative to it, of a regular topic.'
    )
    log_jump: float = setting(0.5, 'Change of stamp against log time.', unit='s')

    twin_time: float = setting(5.0, 'Least common stretch.', unit='s')
    twin_agree: float = setting(
        0.97, 'The same run correlates by over 99 %, repeats of one input by less than 90.'
    )

    tremor_low: float = setting(6.0, 'Physiological tremor of the hand, lower end.', unit='Hz')
    tremor_high: float = setting(12.0, 'Upper end.', unit='Hz')
    tremor_force: float = setting(
        0.04, 'Acceleration of a steady hand at these frequencies.', unit='m/s2'
    )
    tremor_flank: float = setting(3.0, 'Ratio to the adjacent bands: rotors and noise are broad.')
    tremor_usual: float = setting(4.0, 'Ratio to the usual level in this recording.')
    hold_window: float = setting(1.0, 'Shortest hold of the search.', unit='s')
    idle_duty: float = setting(0.03, 'Rotors at a lower duty give no lift.')
    carried_speed: float = setting(
        0.25, 'With idle rotors: a free blimp drifts more slowly.', unit='m/s'
    )
    carried_force: float = setting(
        0.6, 'With idle rotors: drag and lift accelerate a blimp less.', unit='m/s2'
    )

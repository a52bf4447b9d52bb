"""Every threshold of the checks, with its reason."""

from typing import final

from lta_config.settings import setting, Settings


@final
class QualityLimits(Settings):
    """Thresholds; the defaults were chosen before scoring, see docs/trust.md."""

    least_samples: int = setting(50, 'Fewer samples of a channel say nothing.')

    frozen_time: float = setting(0.15, 'A shorter stop is a lost message.', unit='s')
    frozen_samples: int = setting(8, 'Fewer equal readings happen with coarse instruments.')
    frozen_chance: float = setting(1e-9, 'Chance of such a run in the whole channel by itself.')
    frozen_times: float = setting(
        5.0, 'A run this many times as long as the usual longest ones: held values are a rhythm.'
    )

    clipped_samples: int = setting(8, 'Readings at the extreme: fewer are a broad maximum.')
    clipped_run: int = setting(4, 'In a row at the extreme at least once.')
    clipped_pile: float = setting(
        2.5, 'As many times as readings at the next values: noise thins out towards an extreme.'
    )
    adc_blocks: int = setting(3, 'Blocks at an end of the converter: one may be a flash.')

    duplicated_samples: int = setting(16, 'Readings in a row that are equal bit for bit.')
    duplicated_levels: int = setting(12, 'Changes among them, or the channel rests.')

    still_force: float = setting(0.8, 'The BMI088 allows 0.45 m/s2 of 9.81 at rest.', unit='m/s2')
    still_spread: float = setting(0.15, 'A resting accelerometer spreads less.', unit='m/s2')
    jump_speed: float = setting(
        60.0, 'From one pose to the next: no flying thing a room tracks is so fast.', unit='m/s'
    )
    jump_size: float = setting(0.25, "Smaller jumps are a tracker's change of solution.", unit='m')

    quiet_position: float = setting(3e-6, 'The quietest tracker: 30 um of Vicon / 10.', unit='m')
    quiet_attitude: float = setting(1e-5, 'Vicon 3e-4 / 30.', unit='rad')
    quiet_velocity: float = setting(3e-6, 'Derived from such a tracker, smoothed.', unit='m/s')
    quiet_rates: float = setting(3e-5, 'A good gyroscope: 1e-3 / 30.', unit='rad/s')
    quiet_force: float = setting(3e-4, 'A good accelerometer: 1e-2 / 30.', unit='m/s2')
    quiet_pressure: float = setting(0.02, 'The quietest barometers: 0.2 Pa / 10.', unit='Pa')

    kernel: float = setting(0.25, 'Both sides of a comparison are smoothed over it.', unit='s')
    pair_time: float = setting(6.0, 'A shorter overlap tells nothing of two channels.', unit='s')
    agree: float = setting(0.8, 'Correlation from which two channels are the same motion.')
    turn_motion: float = setting(0.006, "Rates that stand above a tracker's noise.", unit='rad/s')
    speed_motion: float = setting(0.01, 'Speeds that do.', unit='m/s')
    force_motion: float = setting(0.08, 'Specific force across that does.', unit='m/s2')
    height_motion: float = setting(0.12, 'Climb that a barometer sees.', unit='m')
    factor_spread: float = setting(0.25, 'Around a unit factor: calibration and lag.')
    upright: float = setting(60.0, 'A craft that leans further for long lies.', unit='deg')

    clock_offset: float = setting(
        0.04, 'Below it the lag of a tracker, a filter or a radio is usual.', unit='s'
    )
    clock_sigmas: float = setting(3.0, 'An offset must be this many standard errors.')
    clock_search: float = setting(2.5, 'Furthest offset that is looked for.', unit='s')
    clock_gain: float = setting(
        1.5, 'The mismatch must shrink by this factor when the offset is taken out.'
    )

    wander_agree: float = setting(
        0.7, 'Correlation of all axes together once a wandering is taken out.'
    )

    gap_periods: float = setting(5.0, 'A silence longer than this many periods ...')
    gap_time: float = setting(0.25, '... and than this is a gap.', unit='s')
    dropout_share: float = setting(0.05, 'Lost messages that wear the statistics.')
    regular: float = setting(0.3, 'Spread of a rhythm over its period, above which it is none.')
    log_jump: float = setting(0.5, 'Change of stamp against log time.', unit='s')

    twin_time: float = setting(5.0, 'A shorter common stretch says nothing.', unit='s')
    twin_agree: float = setting(
        0.97, 'One run again agrees by over 99 %, repeats of one input by less than 90.'
    )

    tremor_low: float = setting(6.0, 'Physiological tremor of the hand, lower end.', unit='Hz')
    tremor_high: float = setting(12.0, 'Upper end.', unit='Hz')
    tremor_force: float = setting(0.04, 'Of a steady hand at these frequencies.', unit='m/s2')
    tremor_flank: float = setting(3.0, 'Above the bands beside it: rotors and noise are broad.')
    tremor_usual: float = setting(4.0, 'Above what is usual in this recording.')
    hold_window: float = setting(1.0, 'Shortest hold that is looked for.', unit='s')
    idle_duty: float = setting(0.03, 'Below it no rotor lifts.')
    carried_speed: float = setting(
        0.25, 'With idle rotors: a free blimp drifts slower.', unit='m/s'
    )
    carried_force: float = setting(
        0.6, 'With idle rotors: drag and lift of a blimp change its speed slower.', unit='m/s2'
    )

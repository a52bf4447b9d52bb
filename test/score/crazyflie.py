"""
Estimate battery sag from published Crazyflie flights: `make crazyflie`.

A quadrotor has no righting moment, so a model without its controller diverges within a second.
Instead, the force along the body axis, which the accelerometer measures, is compared with the
thrust curve: does the ratio follow the voltage within a flight, with a drift in time as a second
regressor, and between flights? Takes seconds.
Writes docs/discovery_flights.md.
"""

import os
from pathlib import Path
import sys
from typing import Final, final, NamedTuple
import warnings

from lta_config.constants import STANDARD_GRAVITY
from lta_config.schema.vehicle_file import load_vehicle_file
from lta_discovery.model.nominal import NominalVehicle
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.typing import NDArray
import pandas as pd

Array = NDArray[np.float64]
BESIDE: Final = Path(__file__).resolve().parents[3] / 'shared' / 'data'
DATA: Final = Path(os.environ.get('LTA_DATA', BESIDE)) / 'crazyflie_flights'
PAGE: Final = Path(__file__).resolve().parents[2] / 'docs' / 'discovery_flights.md'
BEGIN, END = '<!-- crazyflie: begin -->', '<!-- crazyflie: end -->'
SECOND: Final = 100  # rows; all is averaged over one
FLYING: Final = 0.3  # m; lower it may stand on the floor
TURNING: Final = 0.1  # duty of every motor; less is a start or a landing
MOTORS: Final = [f'motor_motor_m{i}' for i in (1, 2, 3, 4)]
FIRMWARE: Final = {'battery_compensation', 'battery_sag', 'thrust_polynomial'}


@final
class Flown(NamedTuple):
    """A flight by seconds: force by the curve, voltage [V], duty, time [s]."""

    name: str
    ratio: Array
    voltage: Array
    duty: Array
    time: Array


def read(path: Path, mass: float, a: float, b: float) -> Flown:
    """Return a flight by seconds."""
    table = pd.read_csv(path)
    duty = table[MOTORS].to_numpy(dtype=np.float64) / 65535.0
    voltage = table['pwr_pm_vbat'].to_numpy(dtype=np.float64)
    force = mass * STANDARD_GRAVITY * table['imu_acc_z'].to_numpy(dtype=np.float64)
    columns = np.column_stack([force, (a * duty**2 + b * duty).sum(1), voltage, duty.mean(1)])
    columns[(table['pz'].to_numpy() < FLYING) | (duty.min(axis=1) < TURNING)] = np.nan
    count = len(columns) // SECOND
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', RuntimeWarning)  # seconds on the floor are empty
        means = np.nanmean(columns[: count * SECOND].reshape(count, SECOND, 4), axis=1)
    flying = np.isfinite(means).all(axis=1) & (means[:, 1] > 0.05)
    force, curve, volts, used = means[flying].T
    name = path.name.removesuffix('.csv.gz')
    return Flown(name, force / curve, volts, used, np.flatnonzero(flying).astype(np.float64))


def exponent(flight: Flown, timed: bool) -> tuple[float, float]:
    """Return the exponent of the voltage and its deviation, with a drift beside it or without."""
    columns = [np.ones_like(flight.time), np.log(flight.voltage)]
    table = np.column_stack([*columns, flight.time] if timed else columns)
    table[:, 1:] -= table[:, 1:].mean(axis=0)
    target = np.log(flight.ratio)
    fit = np.linalg.lstsq(table, target, rcond=None)[0]
    left = target - table @ fit
    variance = left @ left / (len(left) - table.shape[1])
    spread = np.linalg.inv(table.T @ table)[1, 1] * variance
    return float(fit[1]), float(np.sqrt(spread))


def by_pwm() -> Vehicle:
    """
    Return the multirotor with GT-MAB's thrust curve, which is by PWM.

    The firmware logs its PWM; the shipped multirotor takes what comes before the compensation of
    the battery.
    """
    file = load_vehicle_file('multirotor')
    effects = {name: each for name, each in file.effects.items() if name not in FIRMWARE}
    curve = load_vehicle_file('gtmab').thrust_curve
    return Vehicle(file.model_copy(update={'effects': effects, 'thrust_curve': curve}))


def main() -> None:
    """Score, print and write."""
    if not DATA.is_dir():
        sys.exit(f'There is no {DATA}; set LTA_DATA to the folder that has crazyflie_flights/.')
    nominal = NominalVehicle.from_vehicle(by_pwm())
    a, b = (nominal.parameter_value('thrust_curve', f'{c}_1') for c in 'ab')
    paths = sorted(DATA.glob('*.csv.gz'))
    flights = [read(path, nominal.mass, a, b) for path in paths]
    text = [
        '| flight | battery [V] | force / thrust curve | exponent of the voltage |'
        ' exponent with a drift in time | correlation of voltage and duty |',
        '|---|---|---|---|---|---|',
    ]
    for one in flights:
        (alone, own), (beside, wide) = exponent(one, timed=False), exponent(one, timed=True)
        together = np.corrcoef(one.voltage, one.duty)[0, 1]
        text.append(
            f'| {one.name} | {one.voltage.max():.2f} to {one.voltage.min():.2f} | '
            f'{np.mean(one.ratio):.3f} | {alone:.2f} +- {own:.2f} | {beside:.2f} +- {wide:.2f} | '
            f'{together:.2f} |'
        )
    volts = np.log([np.mean(one.voltage) for one in flights])
    ratios = np.log([np.mean(one.ratio) for one in flights])
    between = np.polyfit(volts, ratios, 1)[0]
    text += ['', f'Between the {len(flights)} flights the exponent is {between:.2f}.']
    sys.stdout.write('\n'.join(text) + '\n')
    page = PAGE.read_text(encoding='utf-8')
    head, _, rest = page.partition(BEGIN)
    tail = rest.partition(END)[2]
    PAGE.write_text(f'{head}{BEGIN}\n{chr(10).join(text)}\n{END}{tail}', encoding='utf-8')


if __name__ == '__main__':
    main()

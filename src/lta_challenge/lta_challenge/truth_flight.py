"""
Source of the truth simulator's integrator, command path, pilot and battery.

The integrator is the fifth-order step of Dormand and Prince, at most 5 ms long. Steps end where a
command arrives, so that delays are exact. The rotation matrix is orthonormalised every tick.

The pilot is independent of LTA's controllers. It controls height, heading and forward speed with
proportional, integral and rate terms on noisy measurements, and allocates by the pseudo-inverse of
the nominal allocation matrix. The excitation is added to its commands.
"""

from typing import Final

TICK: Final = 0.01  # s; period of the pilot and of the stored samples
LONGEST: Final = 0.005  # s; largest integrator step
# Columns of a stored sample: position 3, rotation 9, velocity 3, rates 3, thrust 8, wrench of
# effects outside the library 6, voltage 1; 5 are unused
KEPT: Final = 38

ENTRIES: Final = '''

$own
def step(y, h, work, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra):
    """Go on by h: Dormand and Prince 1980, fifth order."""
    k1, k2, k3, k4, k5, k6, at = (work[0], work[1], work[2], work[3], work[4], work[5], work[6])
    slope(y, k1, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra)
    for i in range(SIZE):
        at[i] = y[i] + h * (1 / 5) * k1[i]
    slope(at, k2, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra)
    for i in range(SIZE):
        at[i] = y[i] + h * (3 / 40 * k1[i] + 9 / 40 * k2[i])
    slope(at, k3, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra)
    for i in range(SIZE):
        at[i] = y[i] + h * (44 / 45 * k1[i] - 56 / 15 * k2[i] + 32 / 9 * k3[i])
    slope(at, k4, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra)
    for i in range(SIZE):
        at[i] = y[i] + h * (19372 / 6561 * k1[i] - 25360 / 2187 * k2[i] + 64448 / 6561 * k3[i]
                            - 212 / 729 * k4[i])
    slope(at, k5, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra)
    for i in range(SIZE):
        at[i] = y[i] + h * (9017 / 3168 * k1[i] - 355 / 33 * k2[i] + 46732 / 5247 * k3[i]
                            + 49 / 176 * k4[i] - 5103 / 18656 * k5[i])
    slope(at, k6, told, p, on, around, body, inverse, lift, allocation, pushed, u, s, extra)
    for i in range(SIZE):
        y[i] += h * (35 / 384 * k1[i] + 500 / 1113 * k3[i] + 125 / 192 * k4[i]
                     - 2187 / 6784 * k5[i] + 11 / 84 * k6[i])


$own
def upright(y):
    """Draw the rotation matrix back to a rotation: R (3 - R' R) / 2."""
    n = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                n[i, j] -= 0.5 * y[3 + 3 * k + i] * y[3 + 3 * k + j]
        n[i, i] += 1.5
    for i in range(3):
        a, b, c = y[3 + 3 * i], y[4 + 3 * i], y[5 + 3 * i]
        for j in range(3):
            y[3 + 3 * i + j] = a * n[0, j] + b * n[1, j] + c * n[2, j]


$own
def wished(y, s, wanted, noise, gains, summed):
    """Return force forward and up and moment about the vertical that the pilot would like."""
    height, heading, speed = y[2] + noise[0], math.atan2(y[6], y[3]) + noise[1], s[0] + noise[2]
    climb = y[9] * s[0] + y[10] * s[1] + y[11] * s[2] + noise[2]
    off = wanted[0] - height
    if abs(off) < 0.6:
        summed[0] = min(max(summed[0] + 0.01 * off, -8.0), 8.0)
    up = gains[0] * off - gains[1] * climb + gains[2] * summed[0] + gains[3]
    turn = (wanted[1] - heading + math.pi) % (2.0 * math.pi) - math.pi
    around = gains[4] * min(max(turn, -1.0), 1.0) - gains[5] * s[5]
    ahead = gains[6] * (wanted[2] - speed) + gains[7] * abs(wanted[2]) * wanted[2]
    return ahead, up, around


$own
def duty_of(thrust, curve):
    """Return the duty that the nominal curve gives a thrust at; these rotors do not reverse."""
    if thrust <= 0.0:
        return 0.0
    a, b = curve[0], curve[1]
    return (math.sqrt(b * b + 4.0 * a * thrust) - b) / (2.0 * a)


$own
def orders(y, s, wanted, noise, shaken, gains, mixing, curve, limits, pushed, summed, out):
    """Write what the pilot commands: duties, or a wrench."""
    ahead, up, around = wished(y, s, wanted, noise, gains, summed)
    for j in range(out.shape[0]):
        out[j] = 0.0
    if pushed:
        wrench = (ahead, 0.0, up, 0.0, 0.0, around)
        for j in range(6):
            out[j] = min(max(wrench[j] + shaken[j] * limits[j], -limits[j]), limits[j])
        return
    for j in range(ROTORS):
        thrust = mixing[j, 0] * ahead + mixing[j, 1] * up + mixing[j, 2] * around
        out[j] = min(max(duty_of(thrust, curve) + shaken[j], 0.0), 1.0)


$entry
def fly(y, p, on, around, body, inverse, lift, allocation, pushed, wanted, noise, shaken, gains,
        mixing, curve, limits, delay, cell, longest, commands, kept):
    """
    Fly, and keep what happens at each tick.

    `cell` is the voltage when full and at rest, its loss by a duty second, and by a duty.
    """
    work, told = np.zeros((7, SIZE)), np.zeros(8)
    u, s, extra, summed = np.zeros(8), np.zeros(9), np.zeros(6), np.zeros(1)
    spent, tick, newest = 0.0, 0.01, -1
    for k in range(kept.shape[0]):
        now = k * tick
        speeds(y, p, on, around, body, inverse, s)
        orders(y, s, wanted[k], noise[k], shaken[k], gains, mixing, curve, limits, pushed, summed,
               commands[k])
        load = 0.0
        for j in range(ROTORS):
            load += commands[k, j] if not pushed else 0.1
        spent += load * tick
        around[7] = cell[0] - cell[1] * spent - cell[2] * load
        end = now + tick
        while True:
            # What has arrived by now holds until the next arrival.
            while newest + 1 <= k and (newest + 1) * tick + delay <= now + 1e-9:
                newest += 1
            for j in range(8):
                told[j] = commands[newest, j] if newest >= 0 else 0.0
            if now == k * tick:
                slope(y, work[0], told, p, on, around, body, inverse, lift, allocation, pushed, u,
                      s, extra)
                for j in range(12):
                    kept[k, j] = y[j]
                for j in range(6):
                    kept[k, 12 + j] = s[j]
                    kept[k, 26 + j] = extra[j]
                for j in range(8):
                    kept[k, 18 + j] = u[j] if not pushed else told[j]
                kept[k, 32] = around[7]
            until = end
            coming = (newest + 1) * tick + delay
            if newest + 1 <= k and coming < end - 1e-9:
                until = coming
            count = int(math.ceil((until - now) / longest - 1e-9))
            for _ in range(count):
                step(y, (until - now) / count, work, told, p, on, around, body, inverse, lift,
                     allocation, pushed, u, s, extra)
            now = until
            if now >= end - 1e-9:
                break
        upright(y)
'''

# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Hold the source of the compiled replay functions, which `replay_kernel` completes."""

from typing import Final

# Mean thrust of each rotor in each bin. Steps begin exactly when a command arrives; in between,
# classical Runge-Kutta in steps of at most `longest` integrates the thrusts as well.
CHAIN: Final = '''

$INLINE
def tread(row, on, weight, out):
    """Take up the rates and thrusts of a stage of a step."""
    rates(row, on)
    for i in range(RIGID, SIZE):
        row[MEAN + i] += weight * row[RATE + i]
    for j in range(ROTORS):
        out[j] += weight * row[THRUST + j]


$INLINE
def stride(row, on, dt, out):
    """Take a step; add to the integral of the thrusts."""
    for i in range(RIGID, SIZE):
        row[KEPT + i] = row[i]
        row[MEAN + i] = 0.0
    tread(row, on, dt / 6.0, out)
    for reach, weight in ((0.5 * dt, dt / 3.0), (0.5 * dt, dt / 3.0), (dt, dt / 6.0)):
        for i in range(RIGID, SIZE):
            row[i] = row[KEPT + i] + reach * row[RATE + i]
        tread(row, on, weight, out)
    for i in range(RIGID, SIZE):
        row[i] = row[KEPT + i] + row[MEAN + i]


$FREE
def chain(row, on, arrivals, commands, around, begin, width, longest, out):
    """Write the mean thrust of each rotor in each bin of a flight."""
    newest, count = -1, arrivals.shape[0]
    now = begin
    row[TOLD] = 0.0
    for k in range(out.shape[0]):
        end = begin + (k + 1) * width
        for j in range(ROTORS):
            out[k, j] = 0.0
        while now < end:
            while newest + 1 < count and arrivals[newest + 1] <= now + 1e-9:
                newest += 1
                for j in range(ROTORS):
                    row[COMMAND + j] = commands[newest, j]
                for j in range(AROUND_SIZE):
                    row[AROUND + j] = around[newest, j]
            until = end
            if newest + 1 < count and arrivals[newest + 1] < end:
                until = arrivals[newest + 1]
            if until - now < 1e-9:
                now = until
                if until == end:
                    break
                continue
            steps = int(math.ceil((until - now) / longest - 1e-9))
            for _ in range(steps):
                stride(row, on, (until - now) / steps, out[k])
            now = until
        for j in range(ROTORS):
            out[k, j] /= width
'''

# Piece s begins at step first[s] of the flight; `memory` holds the memory of the effects by step.
REPLAY_ENTRY: Final = '''

$INLINE
def meet(row, k, commands, around, memory):
    """Write what a step of the flight finds."""
    for j in range(COMMAND_SIZE):
        row[COMMAND + j] = commands[k, j]
    for j in range(AROUND_SIZE):
        row[AROUND + j] = around[k, j]
    for j in range(memory.shape[1]):
        row[RIGID + j] = memory[k, j]


$FREE
def fly(row, on, first, start, commands, around, memory, latent, dt, out):
    """Write the state of each segment at each step, by classical Runge-Kutta."""
    for s in range(first.shape[0]):
        for j in range(RIGID):
            row[j] = start[s, j]
            out[s, 0, j] = start[s, j]
        for k in range(out.shape[1] - 1):
            meet(row, first[s] + k, commands, around, memory)
            for j in range(6):
                row[LATENT + j] = latent[s, k, j]
            advance(row, on, dt, 1)
            for j in range(RIGID):
                out[s, k + 1, j] = row[j]


$INLINE
def place(row, states, s, k):
    """Write a state into the row."""
    for j in range(RIGID):
        row[j] = states[s, k, j]


$INLINE
def nudge(row, i, small):
    """Move the state in the row by a small change of the ith of the twelve (`tangent`)."""
    if i < 3:
        row[i] += small
    elif i < 6:
        x, y, z, w = row[3], row[4], row[5], row[6]
        c, a = math.cos(0.5 * small), math.sin(0.5 * small)
        dx, dy, dz, dw = w, z, -y, -x
        if i == 4:
            dx, dy, dz, dw = -z, w, x, -y
        elif i == 5:
            dx, dy, dz, dw = y, -x, w, -z
        row[3], row[4] = c * x + a * dx, c * y + a * dy
        row[5], row[6] = c * z + a * dz, c * w + a * dw
    else:
        row[i + 1] += small


$INLINE
def follow(states, s, k, jacobian):
    """Write what attitude does: it follows the rates, in a frame that turns with them."""
    p, q, r = states[s, k, 10], states[s, k, 11], states[s, k, 12]
    for i in range(3, 6):
        for j in range(12):
            jacobian[s, k, i, j] = 0.0
        jacobian[s, k, i, i + 6] = 1.0
    jacobian[s, k, 3, 4], jacobian[s, k, 3, 5] = r, -q
    jacobian[s, k, 4, 3], jacobian[s, k, 4, 5] = -r, p
    jacobian[s, k, 5, 3], jacobian[s, k, 5, 4] = q, -p


$FREE
def jacobians(row, on, first, states, commands, around, memory, wrench, latent, small, out):
    """Write how the rates of the twelve answer to each of them, at given states."""
    row[TOLD] = 0.0
    for s in range(first.shape[0]):
        for k in range(states.shape[1]):
            meet(row, first[s] + k, commands, around, memory)
            for j in range(6):
                row[LATENT + j] = latent[s, k, j] + wrench[first[s] + k, j]
            place(row, states, s, k)
            rates(row, on)
            x, y, z = row[RATE], row[RATE + 1], row[RATE + 2]
            for j in range(6):
                row[KEPT + j] = row[RATE + 7 + j]
            for i in range(12):
                place(row, states, s, k)
                nudge(row, i, small[i])
                rates(row, on)
                out[s, k, 0, i] = (row[RATE] - x) / small[i]
                out[s, k, 1, i] = (row[RATE + 1] - y) / small[i]
                out[s, k, 2, i] = (row[RATE + 2] - z) / small[i]
                for j in range(6):
                    out[s, k, 6 + j, i] = (row[RATE + 7 + j] - row[KEPT + j]) / small[i]
            follow(states, s, k, out)


$FREE
def answers(
    rows, on, faced, first, states, commands, around, memory, wrench, latent, before, after, steps,
    kept, out,
):
    """
    Write how the accelerations answer to each knob, at given states.

    Each row flies through what `faced` says; a knob is two rows and a step between them. `kept`
    is room for the accelerations of one piece under each row.
    """
    for s in range(first.shape[0]):
        for r in range(rows.shape[0]):
            row, q = rows[r], faced[r]
            row[TOLD] = 0.0
            for k in range(states.shape[1]):
                place(row, states, s, k)
                meet(row, first[s] + k, commands[q], around, memory[q])
                for j in range(6):
                    row[LATENT + j] = latent[s, k, j] + wrench[q, first[s] + k, j]
                rates(row, on[r])
                for j in range(6):
                    kept[r, k, j] = row[RATE + 7 + j]
        for k in range(states.shape[1]):
            for i in range(6):
                for j in range(steps.shape[0]):
                    out[s, k, i, j] = (kept[after[j], k, i] - kept[before[j], k, i]) / steps[j]


$FREE
def remember(row, on, states, commands, around, dt, out):
    """Write the memory of the effects at each step of a flight whose motion is known."""
    row[TOLD] = 0.0
    for k in range(states.shape[0]):
        for j in range(RIGID):
            row[j] = states[k, j]
        for j in range(COMMAND_SIZE):
            row[COMMAND + j] = commands[k, j]
        for j in range(AROUND_SIZE):
            row[AROUND + j] = around[k, j]
        for j in range(out.shape[1]):
            out[k, j] = row[RIGID + j]
        rates(row, on)
        for j in range(out.shape[1]):
            row[RIGID + j] += dt * row[RATE + RIGID + j]
'''

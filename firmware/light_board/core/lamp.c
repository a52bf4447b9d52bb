// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
#include "lamp.h"

#define TURN 18446744073709551616.0 /* 2^64 */

void lamp_begin(lamp_t *lamp, double frequency, double duty, double tick_rate, double drift)
{
    *lamp = (lamp_t){
        .step = (uint64_t)(frequency / (tick_rate * (1.0 + drift)) * TURN),
        .on = (uint64_t)(duty * TURN),
    };
}

bool lamp_tick(lamp_t *lamp)
{
    const bool on = lamp->phase < lamp->on;
    lamp->phase += lamp->step; /* wraps once a turn */
    return on;
}

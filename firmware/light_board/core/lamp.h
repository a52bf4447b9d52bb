// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* A lamp's square wave by a timer that counts whole ticks: frequency and duty on average exact, whatever the ratio. */
#pragma once
#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t step;  /* of the phase at each tick, in 2^-64 turns */
    uint64_t on;    /* phase below which the lamp is on */
    uint64_t phase;
} lamp_t;

/* tick_rate is what the timer's crystal says; drift is the part by which it runs fast, once measured, and is taken off. */
void lamp_begin(lamp_t *lamp, double frequency, double duty, double tick_rate, double drift);
bool lamp_tick(lamp_t *lamp); /* whether the lamp is on until the next tick */

// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* A beacon: a transistor on pin 2 switches the lamp at its frequency. Any Arduino board with IntervalTimer (Teensy).
 *
 * NOT RUN ON HARDWARE YET. Put core/lamp.h and core/lamp.c beside this file. */
extern "C" {
#include "core/lamp.h"
}

static const uint8_t PIN = 2;
static const double FREQUENCY = 150.0; /* Hz, the beacon's in the scenario file */
static const double DUTY = 0.5;
static const double DRIFT = 0.0; /* part by which this crystal runs fast, once measured */
static const unsigned TICK_US = 10;

static IntervalTimer timer;
static lamp_t lamp;

static void tick()
{
    digitalWriteFast(PIN, lamp_tick(&lamp));
}

void setup()
{
    pinMode(PIN, OUTPUT);
    lamp_begin(&lamp, FREQUENCY, DUTY, 1e6 / TICK_US, DRIFT);
    timer.begin(tick, TICK_US);
}

void loop() {}

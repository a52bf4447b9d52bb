// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* What the parts of the Linux platform know of each other. */
#pragma once

#include <stdint.h>

#define MOTORS 4

/* Time since an arbitrary moment. [us] */
uint64_t monotonic_us(void);

/* The firmware's own clock, which may begin anywhere and run fast. [us] */
uint64_t firmware_us(void);

/* Only one thread runs at a time: the one that has the core. Around whatever waits it is given. */
void take_core(void);
void give_core(void);

/* What the body senses. */
typedef struct {
  float acc[3];  /* specific force, body FLU [g] */
  float gyro[3]; /* [deg/s] */
  float range;   /* to the ground [m] */
  float pressure; /* [mbar] */
  float voltage; /* of the cell [V] */
} readings_t;

/* Advance the body by a step [s], driven by the PWM ratios of M1 to M4, 0 to 1. */
void body_step(float dt, const float ratios[MOTORS]);
readings_t body_read(void);

/* Set a property by its name: voltage [V] or upside_down (0 or 1); false where there is none. */
int body_set(const char *name, float value);

/* Take the readings of a simulator, nine numbers in the order of `readings_t`, from now on in place
 * of the body's own; false where they are not nine. */
int body_sense(const char *numbers);

/* The PWM compare values that motors.c has written, 0 to 255. */
uint32_t pwm_compare(int motor);

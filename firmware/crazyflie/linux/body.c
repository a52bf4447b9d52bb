// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* A body that only rises and sinks: enough for a firmware whose safety is judged, not its flight.
 *
 * It stays level, so that the IMU shows gravity and vertical acceleration alone. Defaults are a
 * Crazyflie; LTA_BODY_MASS [kg], LTA_BODY_LIFT [N of buoyancy], LTA_BODY_THRUST [N of all four
 * motors at 4.2 V] and LTA_BODY_DRAG [N s2/m2] make it a blimp. A simulator can take its place:
 * from the first readings that it sends, the body only passes them on.
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "linux_platform.h"

#define GRAVITY 9.81f
#define FULL_VOLTAGE 4.2f
#define STANDING 0.03f      /* m from the range finder to the ground it stands on */
#define SEA_LEVEL 1013.25f  /* mbar */
#define MBAR_PER_METRE 0.12f
/* No sensor repeats its reading to the bit; the bridge takes one that does for stuck. */
#define RANGE_NOISE 0.002f     /* m, half of its width */
#define PRESSURE_NOISE 0.005f  /* mbar */

static bool is_simulated;
static readings_t simulated;
static float height, speed, specific_force = 1.0f, voltage = 4.0f, upside_down;

static float from_environment(const char *name, float otherwise) {
  const char *text = getenv(name);
  return text ? strtof(text, NULL) : otherwise;
}

void body_step(float dt, const float ratios[MOTORS]) {
  static float mass, lift, full_thrust, drag;
  if (mass == 0.0f) {
    mass = from_environment("LTA_BODY_MASS", 0.032f);
    lift = from_environment("LTA_BODY_LIFT", 0.0f);
    full_thrust = from_environment("LTA_BODY_THRUST", 0.6f);
    drag = from_environment("LTA_BODY_DRAG", 0.01f);
  }
  float thrust = 0.0f;
  for (int motor = 0; motor < MOTORS; motor++) {
    const float mean = ratios[motor] * voltage / FULL_VOLTAGE;
    thrust += full_thrust / MOTORS * mean * mean;
  }
  float force = lift + thrust - drag * speed * fabsf(speed);
  const bool on_ground = height <= 0.0f && force < mass * GRAVITY;
  if (on_ground) {
    force = mass * GRAVITY;
    height = speed = 0.0f;
  }
  specific_force = force / (mass * GRAVITY);
  speed += dt * (force / mass - GRAVITY);
  height += dt * speed;
}

static float noise(float size) {
  static unsigned int seed = 1;
  return size * (2.0f * (float)rand_r(&seed) / (float)RAND_MAX - 1.0f);
}

readings_t body_read(void) {
  if (is_simulated) {
    return simulated;
  }
  return (readings_t){
      .acc = {0.0f, 0.0f, upside_down ? -specific_force : specific_force},
      .range = STANDING + height + noise(RANGE_NOISE),
      .pressure = SEA_LEVEL - MBAR_PER_METRE * height + noise(PRESSURE_NOISE),
      .voltage = voltage,
  };
}

int body_set(const char *name, float value) {
  if (strcmp(name, "voltage") == 0) {
    voltage = value;
  } else if (strcmp(name, "upside_down") == 0) {
    upside_down = value;
  } else {
    return 0;
  }
  return 1;
}

int body_sense(const char *numbers) {
  readings_t r;
  if (sscanf(numbers, "%f %f %f %f %f %f %f %f %f", &r.acc[0], &r.acc[1], &r.acc[2], &r.gyro[0],
             &r.gyro[1], &r.gyro[2], &r.range, &r.pressure, &r.voltage) != 9) {
    return 0;
  }
  simulated = r;
  is_simulated = true;
  return 1;
}

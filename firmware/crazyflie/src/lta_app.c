// Copyright 2026 The LTA maintainers
// SPDX-License-Identifier: Apache-2.0
/* LTA's app layer for crazyflie-firmware: the ground's duties go to the motors.
 *
 * It is an out-of-tree controller that hands four forces to the stock power distribution
 * (controlModeForce), so everything of the firmware that stops motors stays in force: arming,
 * tumble check, emergency stop, lock and preflight time-out. The landing time-out runs once packets
 * have ended: until then a blimp that coasts counts as flying (lta_duties.h).
 *
 * When packets end, the motors stop after the packets' own time-out. The app then renews a
 * setpoint without thrust, because the commander's watchdog would lock a drone that counts as
 * flying, disarms after DISARM_MS, and lets go of the commander after LET_GO_MS.
 */
#include <string.h>

#include "FreeRTOS.h"
#include "app.h"
#include "app_channel.h"
#include "autoconf.h"
#include "commander.h"
#include "controller.h"
#include "lta_duties.h"
#include "lta_identity.h"
#include "param.h"
#include "supervisor.h"
#include "task.h"

#define LOOK_MS 20
#define DISARM_MS 1000 /* a link that is back within this time flies on */
#define LET_GO_MS 1500 /* the supervisor has seen the disarming by then */

static lta_duties_t newest;
static uint8_t version = 3; /* of the packets and of what this file promises */
static lta_identity_t identity = LTA_IDENTITY;
#ifdef CONFIG_ENABLE_THRUST_BAT_COMPENSATED
static uint8_t compensated = 1;
#else
static uint8_t compensated = 0;
#endif
static bool feeding;

static uint32_t milliseconds(void) { return T2M(xTaskGetTickCount()); }

static void renew_setpoint(void) {
  setpoint_t setpoint;
  memset(&setpoint, 0, sizeof(setpoint));
  setpoint.timestamp = xTaskGetTickCount();
  commanderSetSetpoint(&setpoint, COMMANDER_PRIORITY_CRTP);
}

static void feed(void) {
  const uint32_t silence = lta_duties_silence(&newest, milliseconds());
  if (!feeding) {
    return;
  }
  if (silence >= LET_GO_MS) {
    commanderRelaxPriority();
    feeding = false;
    return;
  }
  if (silence >= DISARM_MS) {
    supervisorRequestArming(false);
  }
  renew_setpoint();
}

void ltaAppStep(void) {
  uint8_t data[APPCHANNEL_MTU];
  const size_t size = appchannelReceiveDataPacket(data, sizeof(data), LOOK_MS);
  lta_duties_t next = newest;
  if (size > 0 && lta_duties_take(&next, data, size, milliseconds())) {
    taskENTER_CRITICAL(); /* the controller must not see half of a packet */
    newest = next;
    taskEXIT_CRITICAL();
    feeding = true;
  }
  if (!supervisorIsArmed()) {
    taskENTER_CRITICAL();
    lta_duties_forget(&newest);
    taskEXIT_CRITICAL();
  }
  feed();
}

void appMain(void) {
  while (true) {
    ltaAppStep();
  }
}

void controllerOutOfTreeInit(void) {}

bool controllerOutOfTreeTest(void) { return true; }

void controllerOutOfTree(control_t *control, const setpoint_t *setpoint,
                         const sensorData_t *sensors, const state_t *state,
                         const stabilizerStep_t step) {
  (void)setpoint, (void)sensors, (void)state, (void)step;
  control->controlMode = controlModeForce;
  lta_duties_now(&newest, milliseconds(), control->normalizedForces);
}

PARAM_GROUP_START(lta)
PARAM_ADD(PARAM_UINT8 | PARAM_RONLY, app, &version)
PARAM_ADD(PARAM_UINT8 | PARAM_RONLY, compensated, &compensated)
PARAM_ADD(PARAM_UINT32 | PARAM_RONLY, commit, &identity.commit)
PARAM_ADD(PARAM_UINT32 | PARAM_RONLY, vehicle, &identity.vehicle)
PARAM_GROUP_STOP(lta)

/* LTA's app layer for crazyflie-firmware: the ground's duties go to the motors.
 *
 * It is an out-of-tree controller that hands four forces to the stock power distribution
 * (controlModeForce), so everything of the firmware that stops motors stays in force: arming,
 * tumble check, emergency stop, lock. The app renews a setpoint without any thrust, so that the
 * commander's watchdog does not lock a drone whose motors the app itself has stopped: when packets
 * end, the motors stop after the packets' own time-out, and once the firmware takes the drone for
 * landed, 2 s later, the app lets go of the commander.
 */
#include <string.h>

#include "FreeRTOS.h"
#include "app.h"
#include "app_channel.h"
#include "commander.h"
#include "controller.h"
#include "lta_duties.h"
#include "param.h"
#include "task.h"

#define LOOK_MS 20
#define LANDED_MS 2500 /* supervisor.c: 2000 with the motors off, and a margin */

static lta_duties_t newest;
static uint8_t present = 1;

static uint32_t milliseconds(void) { return T2M(xTaskGetTickCount()); }

static uint32_t fed_until;
static bool feeding;

/* Renew the setpoint for as long as the drone may count as flying, and then let go. */
static void feed(void) {
  const uint32_t now = milliseconds();
  if (!feeding) {
    return;
  }
  if ((int32_t)(fed_until - now) > 0) {
    setpoint_t setpoint;
    memset(&setpoint, 0, sizeof(setpoint));
    setpoint.timestamp = xTaskGetTickCount();
    commanderSetSetpoint(&setpoint, COMMANDER_PRIORITY_CRTP);
  } else {
    commanderRelaxPriority();
    feeding = false;
  }
}

void ltaAppStep(void) {
  uint8_t data[APPCHANNEL_MTU];
  const size_t size = appchannelReceiveDataPacket(data, sizeof(data), LOOK_MS);
  lta_duties_t next = newest;
  if (size > 0 && lta_duties_take(&next, data, size, milliseconds())) {
    taskENTER_CRITICAL(); /* the controller must not see half of a packet */
    newest = next;
    taskEXIT_CRITICAL();
    fed_until = milliseconds() + newest.hold_ms + LANDED_MS;
    feeding = true;
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
PARAM_ADD(PARAM_UINT8 | PARAM_RONLY, app, &present)
PARAM_GROUP_STOP(lta)

# The firmware's files that judge safety, as they are, and the calls below them that have no meaning
# without its hardware.
modules := app_channel collision_avoidance commander console crtp crtp_commander \
	crtp_commander_generic crtp_commander_high_level crtp_commander_rpyt \
	crtp_localization_service crtp_mem crtp_supervisor crtpservice eventtrigger health log mem param_logic \
	param_task peer_localization planner platformservice power_distribution_quadrotor pptraj \
	pptraj_compressed range sensfusion6 stabilizer supervisor supervisor_state_machine worker \
	controller/attitude_pid_controller controller/controller controller/controller_brescianini \
	controller/controller_indi controller/controller_lee controller/controller_mellinger \
	controller/controller_pid controller/position_controller_indi \
	controller/position_controller_pid estimator/estimator estimator/estimator_complementary \
	estimator/position_estimator_altitude axis3fSubSampler estimator/estimator_kalman kalman_supervisor \
	$(addprefix kalman_core/,kalman_core mm_absolute_height mm_distance mm_distance_robust mm_flow \
	mm_pose mm_position mm_sweep_angles mm_tdoa mm_tdoa_robust mm_tof mm_yaw_error) \
	outlierfilter/outlierFilterLighthouse outlierfilter/outlierFilterTdoa $(if $(filter app,$(BUILD)),app_handler)
FIRMWARE_SOURCES := $(patsubst %,src/modules/src/%.c,$(modules)) \
	$(patsubst %,src/utils/src/%.c,crc32 debug eprintf filter num pid rateSupervisor statsCnt) \
	src/drivers/src/motors.c src/hal/src/pm_stm32f4.c src/platform/src/platform.c
FIRMWARE_INCLUDES := src/config src/modules/interface src/modules/interface/controller \
	src/modules/interface/estimator src/modules/interface/kalman_core \
	src/modules/interface/lighthouse src/modules/interface/outlierfilter \
	src/modules/interface/cpx src/utils/interface src/utils/interface/lighthouse \
	src/utils/interface/kve src/utils/interface/tdoa src/hal/interface src/drivers/interface \
	src/drivers/src src/platform/interface src/deck/interface src/deck/core/interface \
	src/deck/drivers/interface src/deck/backends/interface \
	src/lib/STM32F4xx_StdPeriph_Driver/inc src/lib/CMSIS/STM32F4xx/Include
HARDWARE_CALLS := analogReadVoltage configblockGetRadioAddress \
	deckGetRequiredKalmanEstimatorAttitudeReversionOff ledseqRun ledseqRunBlocking \
	ledseqSetChargeLevel ledseqStop sensorsInit sensorsSetAccMode isSensorsSuspended \
	soundSetEffect syslinkSendPacket systemRequestShutdownSTM \
	GPIO_Init GPIO_PinAFConfig GPIO_ReadInputDataBit GPIO_StructInit GPIO_WriteBit \
	RCC_AHB1PeriphClockCmd RCC_APB1PeriphClockCmd TIM_ARRPreloadConfig TIM_Cmd \
	TIM_CtrlPWMOutputs TIM_DeInit TIM_GetCapture1 TIM_GetCapture2 TIM_GetCapture3 \
	TIM_GetCapture4 TIM_OC1Init TIM_OC1PreloadConfig TIM_OC2Init TIM_OC2PreloadConfig \
	TIM_OC3Init TIM_OC3PreloadConfig TIM_OC4Init TIM_OC4PreloadConfig TIM_SetCompare3 \
	TIM_TimeBaseInit TIM_TimeBaseStructInit
HARDWARE_TESTS := sensorsAreCalibrated sensorsTest

"""The Novint Falcon: opening and homing, the link, calibration, and the checks of the doctor."""

"""Units: parameters are in metres, B-Rep in millimetres."""

MM = 1000.0

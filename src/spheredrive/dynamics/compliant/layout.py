"""Where the numbers of a compliant machine stand in its flat arrays. One row a station, an outline or a wheel.

A *wheel* has one angle ϑ and one speed ω. It carries one *station*, or two where its second half stands at the antipode: a
place on a mount where it presses on the sphere. A station's frame is (n̂, v̂, ŵ): towards the sphere's centre, the drive
direction, the wheel's axis. Each station shows the sphere *outlines*: a race of rollers, or one ring for a wheel that is
given by its profile alone.
"""

from __future__ import annotations

# The sphere and all that is one of a kind. Symmetric matrices as (00, 01, 02, 11, 12, 22).
RADIUS = 0
INERTIA = 1  # 6, about the geometric centre, body frame
MASS_CENTRE = 7  # 3, body frame
MASS = 10
WEIGHT = 11  # 3, M_s g
CLOSURE_FORCE = 14  # 3
CLOSURE_STIFFNESS = 17  # 6
CLOSURE_DAMPING = 23  # 6
MOVING_MASS = 29  # M_s + M_l + Σ m
STAGE_RESPONSE = 30  # 6, (M_l 1 + Σ m (1 − n̂ n̂ᵀ))⁻¹
CREEP_SPEED = 36  # v_s of the friction's rounding
TURN_SPEED = 37  # ε of the resistances' rounding
BODY_SIZE = 38

# A wheel.
AXIAL_INERTIA = 0
PROPORTIONAL = 1
INTEGRAL = 2
TORQUE_LIMIT = 3
FIRST_STATION = 4
STATION_COUNT = 5
ROLLER_INERTIA = 6  # zero: rollers without inertia, which follow at once
ROLLER_DRAG = 7  # N m s/rad
WHEEL_SIZE = 8

# A station.
N_HAT = 0  # 3
V_HAT = 3  # 3
W_HAT = 6  # 3
DISTANCE = 9  # of the centres as drawn
MOUNT_STIFFNESS = 10
MOUNT_DAMPING = 11
MOUNT_MASS = 12  # zero: a rigid mount
STIFFNESS = 13
DAMPING = 14
DISSIPATION = 15  # χ of Hunt and Crossley
HERTZIAN = 16  # whether N grows with the power 3/2
FRICTION = 17
ROLLING_ARM = 18
SPIN_ARM = 19
FIRST_OUTLINE = 20
OUTLINE_COUNT = 21
STATION_WHEEL = 22
STATION_SIZE = 23

# An outline.
KIND = 0
AXIS_DISTANCE = 1  # a; of a ring r_b − r_r
SINE = 2
COSINE = 3
OFFSET = 4
HALF_LENGTH = 5
SECTION = 6  # radius of the ball at the roller's middle; r_b of a barrel; r_r of a ring
EDGE_PLACE = 7
EDGE_RADIUS = 8
THICKEST = 9
PITCH = 10
MIDDLE = 11  # wheel angle at which a roller's middle faces the sphere, less the phase
FARTHEST = 12  # angle from its middle beyond which a roller reaches no sphere
FIRST_PIECE = 13  # of a ring's outline, in the table of pieces
PIECE_COUNT = 14
PERIOD = 15  # of a ring's outline
FIRST_ROLLER = 16  # number of its first roller among all, for rollers that turn
ROLLER_COUNT = 17
OUTLINE_SIZE = 18

# Kinds of outline.
ROUND_ENDS, FLAT_ENDS, BARREL, RING = 0, 1, 2, 3

# A row of the table of pieces: its begin and width (rad), the first and last row of the smooth stretch between corners that
# it belongs to, then the coefficients of h.
PIECE_BEGIN, PIECE_WIDTH, STRETCH_BEGIN, STRETCH_END, PIECE_POWERS = range(5)

# Kinds of drive.
TORQUE, SPEED, LOOP = 0, 1, 2
# Kinds of stage.
STILL, MOVED, DRIVEN = 0, 1, 2

# The state: a block for the sphere and the stage, then wheels, stations and turning rollers.
CENTRE = 0  # displacement c of the sphere's centre on the stage
QUATERNION = 3
CENTRE_VELOCITY = 7
OMEGA = 10
STAGE_POSITION = 13
STAGE_VELOCITY = 16
WHEELS = 19
ANGLE, SPEED_OF_WHEEL, LOOP_ANGLE = 0, 1, 2  # three a wheel; the last is ∫ (speed asked − speed) dt
WHEEL_STATES = 3
DEFLECTION, DEFLECTION_RATE = 0, 1  # two a station
STATION_STATES = 2
# The powers, in the order in which their works are summed up.
MOTOR, STAGE_WORK, SLIPPING, CONTACT_DAMPING, RESISTANCES = range(5)
POWERS = 5

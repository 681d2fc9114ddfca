"""What a particle carries: the rows of the state array `S` (ROWS, n), float64, and the kinds of particles.

Fluid, wall and structure-ghost particles live in one array, sorted by cell, so that a sweep reads contiguous
memory. One array with named rows, rather than one array per quantity, keeps sorting, rolling back and passing
the state to compiled code one operation each.
"""

X, Y = 0, 1  # position [m]
U, V = 2, 3  # momentum velocity u [m/s]; of ghosts: mirrored from the fluid's, what divergence, ∇u and viscosity see
SX, SY = 4, 5  # shifting velocity d = ũ − u [m/s]; zero on ghosts
RHO = 6  # density [kg/m³]
P = 7  # pressure [Pa]
M = 8  # mass per depth [kg/m]; of ghosts: the hydrodynamic mass
VOL = 9  # volume m/ρ [m²]
PR2 = 10  # p/ρ² [m⁴/(kg s²)]
AX, AY = 11, 12  # acceleration du/dt + transport terms [m/s²]; of ghosts: the prescribed one
NX, NY = 13, 14  # outward unit normal of particles at the free surface, else zero
FRICTION = 15  # weight of artificial viscosity: 1, and 0 on free-slip walls
ROWS = 16
OF_SHIFTING = (SX, SY, NX, NY)  # zero, and left alone, where nothing shifts

FLUID = 0
FREE_SLIP = 1  # wall without friction
NO_SLIP = 2  # wall that the fluid sticks to
STRUCTURE = 3  # ghost of a solid body
PARKED = 4  # fluid that left the domain, out of every loop

# Rows of the work array `R` (WORK_ROWS, n): results of a sweep that neighbours must not see yet.
DP, NEW_NX, NEW_NY = 0, 1, 2
WORK_ROWS = 3

"""Rows of the updated-Lagrangian solid's state, one array (rows, slots).

X, Y, U, V: position, velocity. AX, AY: acceleration by stresses and artificial viscosity. M: mass; MOVES: 1 for a
particle, 0 for a fixed one; ACTS: 1 where stress exerts forces, 0 where it does not. RHO: density; SXX, SXY, SYY, SZZ:
deviatoric stress; E0, E1: offset to the material tracer; G00, G01, G10, G11: ∂_j u_i; IRHO: 1/ρ. From OWN on, as
updated_linear.py and updated_quadratic.py say: the stress of the strain's variation over a cell (kept from step to
step), sums over neighbours that the forces need again, and fluxes of stress.
"""

X, Y, U, V, AX, AY, M, MOVES, ACTS, RHO, SXX, SXY, SYY, SZZ, E0, E1, G00, G01, G10, G11, IRHO, OWN = range(22)

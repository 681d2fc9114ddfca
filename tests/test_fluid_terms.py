"""Terms of the fluid equations on a jittered lattice against polynomial fields, and against the printed signs.

Kernel sums on a disordered lattice are good to a few per cent; a wrong sign is off by twice the term.
"""

import numpy as np
import pytest

from fluid_solver.fields import AX, AY, DP, FLUID, FRICTION, PR2, RHO, ROWS, SX, SY, VOL, M, P, U, V, X, Y
from fluid_solver.forces import make_forces
from fluid_solver.parameters import Parameters, pairing_of, slope_of
from fluid_solver.rates import make_rates
from fluid_solver.store import Store
from fluid_solver.terms import inverse
from shared.jit import njit
from shared.kernels import kernel_named

DX, C0, RHO0, NU = 0.1, 20.0, 1000.0, 0.3
KERNEL = kernel_named("quintic-spline")
H_OVER_DX = 1.6
N = 31


def numbers(**changed) -> Parameters:
    h = H_OVER_DX * DX
    given = {
        "h": h, "dx": DX, "support": KERNEL.support * h, "rho0": RHO0, "c0": C0, "alpha": 0.0, "nu": 0.0,
        "nu_edac": 0.0, "gx": 0.0, "gy": 0.0, "slope": slope_of(KERNEL, h, DX),
        "pairing": pairing_of(KERNEL, h, DX), "weakest": -np.inf, "closed": 0.0,
    }  # fmt: skip
    return Parameters(**(given | changed))


def patch(jitter=0.05, u=None, d=None, p=None) -> Store:
    """A square of fluid with fields given as functions of x and y; u, d: pairs of them."""
    i = (np.arange(N) - N // 2) * DX
    x, y = (grid.ravel() for grid in np.meshgrid(i, i))
    shake = np.random.default_rng(1).uniform(-jitter, jitter, (2, x.size)) * DX
    x, y = x + shake[0], y + shake[1]
    S = np.zeros((ROWS, x.size))
    S[X], S[Y], S[RHO], S[FRICTION] = x, y, RHO0, 1.0
    S[M], S[VOL] = RHO0 * DX**2, DX**2
    for rows, field in (((U, V), u), ((SX, SY), d)):
        if field is not None:
            S[rows[0]], S[rows[1]] = field(x, y)
    if p is not None:
        S[P] = p(x, y)
        S[PR2] = S[P] / RHO0**2
    support = KERNEL.support * H_OVER_DX * DX
    store = Store(S, np.full(x.size, FLUID), support, np.array([-1e9, -1e9, 1e9, 1e9]), np.zeros((2, 2)))
    store.sort()
    return store


def interior(store: Store) -> np.ndarray:
    reach = N // 2 * DX - KERNEL.support * H_OVER_DX * DX - DX
    return np.flatnonzero((np.abs(store.S[X]) < reach) & (np.abs(store.S[Y]) < reach))


def pressure_rate(store: Store, c: Parameters, transported: bool) -> np.ndarray:
    make_rates(KERNEL.code, transported)(store.S, *store.cells(), c, store.work)
    return store.work[DP]


def acceleration(store: Store, c: Parameters, viscous=False, shifting=False, u_max=0.0) -> np.ndarray:
    sweep = make_forces(KERNEL.code, viscous, shifting)
    sweep(store.S, *store.cells(), c, u_max, store.work, store.fastest)
    return store.S[[AX, AY]]


def close(computed, expected, within):
    """Root mean square difference over the expected size."""
    return np.sqrt(np.mean((computed - expected) ** 2)) < within * np.sqrt(np.mean(expected**2))


def test_density_falls_where_the_flow_diverges():
    store = patch(u=lambda x, y: (0.7 * x + 0.4 * y, 0.3 * y - 1.1 * x))
    here = interior(store)
    expected = np.full(here.size, -RHO0 * C0**2 * (0.7 + 0.3))
    rate = pressure_rate(store, numbers(), False)[here]
    assert close(rate, expected, 0.05)
    assert not close(-rate, expected, 0.5)  # the printed sign of the p_a − ρ_a c² term


def test_pressure_is_carried_by_the_transport_velocity():
    """d̃p/dt = d·∇p − ρc²∇·u for d and p linear: with the printed sign of (p d)_ab it comes out wrong."""
    store = patch(d=lambda x, y: (0.2 + 0.1 * x, -0.3 + 0.05 * y), p=lambda x, y: 500.0 * x - 300.0 * y + 2000.0)
    here = interior(store)
    x, y = store.S[X, here], store.S[Y, here]
    expected = (0.2 + 0.1 * x) * 500.0 - (-0.3 + 0.05 * y) * 300.0
    rate = pressure_rate(store, numbers(), True)[here]
    assert close(rate, expected, 0.05)
    p, div_d = store.S[P, here], 0.1 + 0.05
    printed = p * -div_d - (expected + p * div_d)  # p_a ũ_ab + (p d)_ab
    assert not close(rate, printed, 0.5)


def test_transport_does_not_see_a_constant_pressure():
    store = patch(jitter=0.2, d=lambda x, y: (0.2 + 0.1 * x, -0.3 * y), p=lambda x, y: 5000.0 + 0.0 * x)
    assert np.abs(pressure_rate(store, numbers(), True)).max() < 1e-8


def test_pressure_diffuses_at_the_diffusivity_and_hydrostatic_pressure_does_not():
    """ν_e ∇²p of a paraboloid; with V_b in place of m_b, as printed, it would be a thousand times less."""
    g = 9.81
    c = numbers(nu_edac=0.02, gy=-g)
    store = patch(p=lambda x, y: 400.0 * x * x + 100.0 * y * y - RHO0 * g * y)
    here = interior(store)
    assert close(pressure_rate(store, c, True)[here], np.full(here.size, 0.02 * 1000.0), 0.08)
    still = patch(p=lambda x, y: -RHO0 * g * y)
    rate = pressure_rate(still, c, True)  # surfaces included
    torn = still.S[P] < 0.0
    assert np.abs(rate[~torn]).max() < 1e-8 * RHO0 * g


def test_pressure_gradient_drives_the_flow_downhill():
    store = patch(p=lambda x, y: 3000.0 * x - 1000.0 * y)
    here = interior(store)
    ax, ay = acceleration(store, numbers())[:, here]
    # the symmetric form feels 2 p/ρ² Σ V ∇W on a disordered lattice: take the mean
    assert ax.mean() == pytest.approx(-3.0, rel=0.05)
    assert ay.mean() == pytest.approx(1.0, rel=0.05)


def test_laminar_viscosity_is_nu_times_the_laplacian():
    store = patch(jitter=0.02, u=lambda x, y: (y * y + 0.5 * x * x, 2.0 * x * x - x * y))
    here = interior(store)
    ax, ay = acceleration(store, numbers(nu=NU), viscous=True)[:, here]
    assert close(ax, np.full(here.size, NU * 3.0), 0.15)
    assert close(ay, np.full(here.size, NU * 4.0), 0.15)
    assert ax.mean() == pytest.approx(NU * 3.0, rel=0.03)
    assert ay.mean() == pytest.approx(NU * 4.0, rel=0.03)


def test_laminar_viscosity_turns_strain_into_heat_and_leaves_rotation_alone():
    """A free patch under u = (x, −y) loses 2ν ρ D:D = 4ν ρ per area; one that spins as a whole loses nothing."""
    store = patch(jitter=0.02, u=lambda x, y: (x, -y))
    a = acceleration(store, numbers(nu=NU), viscous=True)
    lost = -np.sum(store.S[M] * (store.S[U] * a[0] + store.S[V] * a[1]))
    inner = ((N - 2.0 * H_OVER_DX) * DX) ** 2  # pairs that the surface cuts off are missing
    assert 4.0 * NU * RHO0 * inner < lost < 4.0 * NU * RHO0 * (N * DX) ** 2
    store = patch(jitter=0.02, u=lambda x, y: (-y, x))
    assert np.abs(acceleration(store, numbers(nu=NU), viscous=True)).max() < 1e-9


@njit
def inverses(x):
    found = np.empty_like(x)
    for k in range(x.size):
        found[k] = inverse(x[k])
    return found


def test_the_inverse_is_one_at_any_scale():
    """From h² of a micrometre to that of a dummy's distance squared."""
    x = np.geomspace(1e-18, 1e26, 100_003)
    off = x * inverses(x) - 1.0
    assert np.abs(off).max() < 1.4e-4


def test_artificial_viscosity_pushes_apart_on_approach_only():
    for inwards, sign in ((1.0, 1.0), (-1.0, 0.0)):
        store = patch(jitter=0.0, u=lambda x, y, s=inwards: (-s * x, 0.0 * y))
        x = store.S[X]
        ax, _ = acceleration(store, numbers(alpha=0.5))
        edge = np.abs(x) > 0.95 * np.abs(x).max()
        # the outermost particles, pressed from outside in by nobody, are pushed back out by Π > 0
        assert np.all(ax[edge] * x[edge] * sign >= 0.0)
        assert np.abs(ax[edge]).min() > 0.1 if sign else np.abs(ax).max() < 1e-12


def test_artificial_viscosity_of_shear_is_alpha_h_c_over_eight():
    """Monaghan's estimate ν = α h c/8 (half of it acts: receding pairs have no Π), on u = (y², 0)."""
    store = patch(u=lambda x, y: (y * y, 0.0 * x))
    here = interior(store)
    nu = 0.5 * H_OVER_DX * DX * C0 / 8.0
    ax, _ = acceleration(store, numbers(alpha=0.5))[:, here]
    assert ax.mean() == pytest.approx(0.5 * nu * 2.0, rel=0.25)


def shifted(uniform: float) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration from (d·∇)u with a uniform velocity added, and what it should be."""
    store = patch(jitter=0.1, u=lambda x, y: (0.8 * x + 0.5 * y + uniform, -0.6 * x + 0.2 * y))
    here = interior(store)
    for _ in range(2):  # the second sweep carries with the shift that the first one found
        a = acceleration(store, numbers(), shifting=True, u_max=1.0)[:, here]
    dx, dy = store.S[SX, here], store.S[SY, here]
    return a, np.array([0.8 * dx + 0.5 * dy, -0.6 * dx + 0.2 * dy])


def test_momentum_is_carried_by_the_shifting_velocity():
    a, expected = shifted(0.0)
    assert close(a, expected, 0.08)
    assert not close(-a, expected, 0.5)


def test_momentum_transport_is_galilean_invariant():
    assert shifted(50.0)[0] == pytest.approx(shifted(0.0)[0], abs=1e-9)


def test_shifting_leads_from_crowd_to_void_and_never_out_of_the_surface():
    store = patch(jitter=0.0)
    moved = np.flatnonzero((np.abs(store.S[X]) < 1e-9) & (np.abs(store.S[Y]) < 1e-9))[0]
    store.S[X, moved] += 0.3 * DX
    for _ in range(2):  # the second sweep knows the surface that the first one marked
        acceleration(store, numbers(), shifting=True, u_max=1.0)
        store.S[13:15] = store.work[1:3]
    assert store.S[SX, moved] < -0.05
    right = store.S[X] > (N // 2 - 0.5) * DX
    middle = right & (np.abs(store.S[Y]) < 0.5 * N // 2 * DX)
    assert np.all(store.S[13, middle] > 0.99)  # outward normal
    assert np.abs(store.S[SX, middle]).max() < 1e-12
    assert np.hypot(store.S[SX], store.S[SY]).max() <= 0.5 * (1.0 + 1e-12)

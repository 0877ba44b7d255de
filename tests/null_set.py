"""What linear theory allows any controller, computed once more: the null-controllable set of unstable modes
that are real, its support function by quadrature over time, its gauge by the largest over directions."""
import numpy as np


def modes(design, limit):
    """Rows of left eigenvectors, their rates, inputs, and bounds of the torques about the equilibrium's."""
    A, B = np.array(design["A"]), np.array(design["B"])
    rates, left = np.linalg.eig(A.T)
    unstable = rates.real > 1e-9
    assert unstable.any() and not rates[unstable].imag.any()
    W, torque = left[:, unstable].T.real, np.array(list(design["equilibrium"]["torque"].values()))
    return W, rates[unstable].real, W @ B, -limit - torque, limit - torque


def gauge(design, limit, x, directions=1200):
    """By how much the set must grow to have each of the states x[points][states] in it; of two modes."""
    W, rates, G, low, high = modes(design, limit)
    angle = np.arange(directions) * 2 * np.pi / directions
    eta = np.stack([np.cos(angle), np.sin(angle)], 1) * rates / np.abs(G).max(1)
    t = np.linspace(0, 1, 2001)**2 * 24 / rates.min()
    s = -np.einsum("di,it,ij->djt", eta, np.exp(-np.outer(rates, t)), G)
    most = np.maximum(s * low[:, None], s * high[:, None]).sum(1)
    h = (most[:, 1:] + most[:, :-1]) @ np.diff(t) / 2
    return ((np.asarray(x) @ W.T) @ eta.T / h).max(1)

"""Poles that share one vector: where eigenvectors fail, integrals around the group of poles do not."""

from __future__ import annotations

import numpy as np

from spheredrive.errors import SingularError

# Poles within this share of their size belong to one group.
NEAR = 0.1
# Points on the circle around a group: the error falls by the ratio of the circle's radius to the distances, to this power.
POINTS = 96


def linked_form(M, D, K, Bk, Bc):
    """Poles λ (R,), link (R,), b (R, m), V (d, R) as ``modal.modal_form`` gives them, with linked pairs where poles meet.

    A group of poles near μ contributes α/(s − λ₁) + β/((s − λ₁)(s − λ₂)) to the transfer H_v(s) of the velocities; α and β are
    contour integrals of H_v and of (s − λ₁) H_v around the group, well conditioned where the eigenvectors are not. Raises
    ``SingularError`` where more than two poles share one vector, or another pole is too near for a circle between.
    """
    M, D, K, Bk, Bc = (np.asarray(a, float) for a in (M, D, K, Bk, Bc))
    X = np.linalg.inv(np.linalg.cholesky(M))
    scale = np.sqrt(np.linalg.norm(X @ K @ X.T))
    K_, D_ = X @ K @ X.T / scale**2, X @ D @ X.T / scale
    bk, bc = X @ Bk / scale**2, X @ Bc / scale
    d, m = bk.shape
    eye = np.eye(d)

    def transfer(s):
        """From ḣ to q̇ of the mass-scaled coordinates, at scaled s (p,): (p, d, m)."""
        s = s[:, None, None]
        strict = np.linalg.solve(s**2 * eye + s * D_ + K_, bk + s * bc)
        return strict

    poles = np.linalg.eigvals(np.block([[np.zeros((d, d)), eye], [-K_, -D_]]))
    lam, link, b, V = [], [], [], []
    for group in _groups(poles):
        mu, half, radius = _circle(poles, group)
        if mu.imag < 0:
            continue
        share = 1.0 if mu.imag == 0 else 2.0
        l1, l2 = mu - half, mu + half
        step = radius * np.exp(2j * np.pi * (np.arange(POINTS) + 0.5) / POINTS)
        H = transfer(mu + step) * (step / POINTS)[:, None, None]
        ahead = (mu + step - l1)[:, None, None]
        behind = (mu + step - l2)[:, None, None]
        alpha, beta, rest = H.sum(0), (H * ahead).sum(0), (H * ahead * behind).sum(0)
        size = np.abs(alpha).max() * abs(mu) ** 2 + np.abs(beta).max() * abs(mu)
        if len(group) > 1 and not np.abs(rest).max() <= 1e-9 * size:
            raise SingularError(
                f"more than two poles near {abs(mu) * scale / (2 * np.pi):.6g} Hz share one shape, which this model does not "
                "solve; change a stiffness or a damping by a percent"
            )
        turn = share * X.T.astype(complex)
        for i in range(m):
            lam += [l1 * scale, l2 * scale]
            link += [0, 1]
            b += [np.eye(m)[i], np.zeros(m)]
            V += [turn @ alpha[:, i] * scale, turn @ beta[:, i] * scale**2]
    return np.array(lam), np.array(link), np.array(b, complex), np.array(V).T.copy()


def _groups(poles) -> list[np.ndarray]:
    left, groups = list(range(len(poles))), []
    while left:
        members, more = [], [left.pop(0)]
        while more:
            r = more.pop()
            members.append(r)
            near = [j for j in left if abs(poles[j] - poles[r]) < NEAR / 10 * abs(poles[r])]
            left = [j for j in left if j not in near]
            more += near
        groups.append(np.array(members))
    return groups


def _circle(poles, group):
    """Middle of a group, half the distance of its two poles, and a circle that parts it from the others."""
    mu = poles[group].mean()
    spread = np.abs(poles[group] - mu).max()
    others = np.delete(poles, group)
    away = min(np.abs(others - mu).min(initial=np.inf), 2 * abs(mu))
    squared = ((poles[group] - mu) ** 2).mean()
    if abs(mu.imag) <= 1e-6 * abs(mu):
        mu, squared = complex(mu.real), complex(squared.real)
    if spread > 0.1 * away:
        raise SingularError(
            "poles of the machine lie too close together to be told apart; change a stiffness or a damping by a percent"
        )
    return mu, np.sqrt(squared), np.sqrt(max(spread, 1e-3 * away) * away)

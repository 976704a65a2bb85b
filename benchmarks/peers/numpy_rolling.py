"""The rolling model written a second time, plainly, for SciPy's integrators: NumPy, body frame, one contact state at a time.

Used as a peer in benchmarks and as an independent program in tests. Everything follows from the design's geometry: the
rows come from the contact directions, the rotation from SciPy. The stage stands still; wheels are driven by torques.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation


class Machine:
    """Three or more wheels with one contact each on a sphere with an offset mass under gravity."""

    def __init__(self, design, gravity: float = 9.80665):
        self.design = design
        self.I = np.array(design.sphere.inertia_tensor)
        self.rho = np.array(design.sphere.centre_of_mass)
        self.weight = np.array([0, 0, -gravity * design.sphere.mass if design.stage.gravity else 0.0])
        self.J_w = np.array([wheel.spin_inertia for wheel in design.wheels])
        self.pitch = np.array([wheel.half_pitch for wheel in design.wheels])

    def rows(self, count):
        """R/r (Ω̂ + cot α v̂) of each wheel whose half pitch has the number ``count``."""
        R = self.design.sphere.radius
        rows = []
        for i, placement in enumerate(self.design.placements):
            wheel = placement.wheel
            place, drive = np.array(placement.contact_direction), np.array(placement.drive_direction)
            races = wheel.races(R)
            race = races[int(count[i]) % 2] if len(races) == 2 else races[0]
            tilt = np.arcsin(race.offset / (R + race.roller_radius))
            axle = np.cross(drive, place)
            place = np.cos(tilt) * place + np.sin(tilt) * axle
            rows.append(R / race.radius * (np.cross(place, drive) + drive / np.tan(wheel.roller_angle)))
        return np.array(rows)

    def rates(self, t, y, H, torque):
        """State: Ω in the body frame, quaternion (x, y, z, w), wheel angles."""
        A = Rotation.from_quat(y[3:7]).as_matrix()
        body = y[:3]
        H_body = H @ A
        M = self.I + H_body.T @ (self.J_w[:, None] * H_body)
        # The rows turn against the body: their rate is −Ω × row, which the wheels' inertia feels.
        rate = -np.cross(body, H_body)
        gyro = np.cross(body, self.I @ body)
        reflected = H_body.T @ (self.J_w * (rate @ body))
        moment = H_body.T @ torque(t) + np.cross(self.rho, A.T @ self.weight)
        x, yq, z, w = y[3:7]
        o = A @ body
        q = 0.5 * np.array(
            [
                w * o[0] + o[1] * z - o[2] * yq,
                w * o[1] + o[2] * x - o[0] * z,
                w * o[2] + o[0] * yq - o[1] * x,
                -(o[0] * x + o[1] * yq + o[2] * z),
            ]
        )
        return np.concatenate([np.linalg.solve(M, moment - gyro - reflected), q, H @ o])

    def impact(self, y, H_before, H_after):
        """Ω after free wheels have changed their races."""
        A = Rotation.from_quat(y[3:7]).as_matrix()
        before, after = H_before @ A, H_after @ A
        M = self.I + after.T @ (self.J_w[:, None] * after)
        new = y.copy()
        new[:3] = np.linalg.solve(M, self.I @ y[:3] + after.T @ (self.J_w * (before @ y[:3])))
        return new

    def run(self, torque, knots, Omega0, method="DOP853", rtol=1e-12, atol=1e-13):
        """Integrate from rest orientation; returns Ω (inertial), quaternion (w, x, y, z), wheel angles, changes of race."""
        n = len(self.J_w)
        y = np.concatenate([Omega0, [0, 0, 0, 1], np.zeros(n)])
        count, t, changes = np.zeros(n, int), 0.0, 0
        for end in knots[1:]:
            while t < end:
                H = self.rows(count)
                events = [self._leaves(i, count, sign) for i in range(n) if np.isfinite(self.pitch[i]) for sign in (0, 1)]
                solved = solve_ivp(
                    self.rates, (t, end), y, method, rtol=rtol, atol=atol, events=events or None, args=(H, torque)
                )
                t, y = solved.t[-1], solved.y[:, -1]
                y[3:7] /= np.linalg.norm(y[3:7])
                if solved.status == 1:
                    for i in range(n):
                        for sign in (0, 1):
                            k = 2 * i + sign
                            if len(solved.t_events[k]):
                                count[i] += 1 if sign else -1
                    y = self.impact(y, H, self.rows(count))
                    changes += 1
        A = Rotation.from_quat(y[3:7]).as_matrix()
        return A @ y[:3], y[[6, 3, 4, 5]], y[7:], changes

    def _leaves(self, i, count, sign):
        goal = (count[i] + sign) * self.pitch[i]

        def event(t, y, *_):
            return y[7 + i] - goal

        event.terminal = True
        event.direction = 1 if sign else -1
        return event

"""Null spaces and rotations against SciPy's, made independently of ours."""

import numpy as np
import pytest
import scipy.linalg
from scipy.spatial.transform import Rotation

from layouts import random_design, random_races
from spheredrive import kinematics as K
from spheredrive.frames import quaternion_exponential, quaternion_matrix, quaternion_product, rotation_matrix


@pytest.mark.parametrize("seed", range(25))
def test_slip_free_motions_span_scipys_null_space(seed):
    rng = np.random.default_rng([40, seed])
    design = random_design(rng, int(rng.integers(1, 6)), rng.choice(["triple-race", "dual-race", "mecanum"]), condition=100)
    races = random_races(rng, design)
    A, B = K.constraint(design, races)
    reference = scipy.linalg.null_space(np.hstack([A, -B]), rcond=1e-10).T
    basis = K.slip_free(design, races).basis
    assert basis.shape == reference.shape
    # Two orthonormal bases of one space have the same projector.
    np.testing.assert_allclose(basis.T @ basis, reference.T @ reference, atol=1e-10)


def test_quaternions_and_rotations_match_scipys(rng):
    vectors = rng.normal(size=(50, 3)) * rng.uniform(0, 3, size=(50, 1))
    ours, theirs = quaternion_exponential(vectors), Rotation.from_rotvec(vectors)
    np.testing.assert_allclose(quaternion_matrix(ours), theirs.as_matrix(), atol=1e-14)
    product = quaternion_product(ours[:25], ours[25:])
    np.testing.assert_allclose(quaternion_matrix(product), (theirs[:25] * theirs[25:]).as_matrix(), atol=1e-14)
    angle = np.linalg.norm(vectors, axis=1)
    np.testing.assert_allclose(rotation_matrix(vectors / angle[:, None], angle), theirs.as_matrix(), atol=1e-14)


def test_small_rotations_keep_their_digits():
    vector = np.array([1e-9, -2e-9, 3e-9])
    np.testing.assert_allclose(quaternion_exponential(vector)[1:], vector / 2, rtol=1e-15)
    np.testing.assert_array_equal(quaternion_exponential(np.zeros(3)), [1, 0, 0, 0])


def test_orientation_of_a_random_motion_matches_scipys_composition(rng):
    """Steps of constant Ω, each one a rotation vector: SciPy composes the same rotations one after the other."""
    time = np.cumsum(rng.uniform(0.01, 0.1, 200))
    Omega = rng.normal(size=(200, 3))
    times, values, expected = [time[0]], [Omega[0]], Rotation.identity()
    for i in range(1, 200):
        times += [time[i], time[i]]
        values += [Omega[i - 1], Omega[i]]
        expected = Rotation.from_rotvec((time[i] - time[i - 1]) * Omega[i - 1]) * expected
    end = K.integrate_orientation(times, values)[-1]
    np.testing.assert_allclose(quaternion_matrix(end), expected.as_matrix(), atol=1e-12)

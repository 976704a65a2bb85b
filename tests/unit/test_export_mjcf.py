"""The MuJoCo model: shapes, masses and contacts as the design has them, and a file that keeps them."""

import math
from dataclasses import replace

import numpy as np
import pytest

from layouts import atlas
from spheredrive import kinematics
from spheredrive.design import Closure, Contact, Design, Motor, Mount, Placement, Sphere, Spring, Stage
from spheredrive.errors import SpheredriveError, UnknownNameError
from spheredrive.export.command import export, export_text
from spheredrive.motion import Motion, Series, StageMotion
from spheredrive.shape import profile
from spheredrive.wheels import DualRaceWheel, MecanumWheel, SplitDualRaceWheel, StandardWheel, TripleRaceWheel

mujoco = pytest.importorskip("mujoco")

from spheredrive.export.mjcf.model import contact_law, mjcf_spec  # noqa: E402
from spheredrive.export.mjcf.run import Settings, prepare, run_mujoco  # noqa: E402
from spheredrive.export.mjcf.steps import largest_step, run_difference  # noqa: E402

R = 0.15
THIN = dict(radius=0.025, roller_radius=4.5e-3, mass=0.1)
SPHERES = StandardWheel(**THIN, rollers=12, roller_shape="sphere")
WHEELS = {
    "spheres": SPHERES,
    "capsules": StandardWheel(**THIN, rollers=9, roller_shape="capsule", roller_length=4e-3),
    "cylinders": StandardWheel(**THIN, rollers=8, roller_shape="cylinder", roller_length=8e-3),
    "barrels": StandardWheel(**THIN, rollers=8, roundness=0.3),
    "dual": DualRaceWheel(**THIN, rollers=16, race_spacing=0.012, roller_shape="capsule", roller_length=5e-3),
    "split": SplitDualRaceWheel(**THIN, rollers=16, roller_shape="capsule", roller_length=3e-3),
    "triple": TripleRaceWheel(**THIN, rollers=24, race_spacing=0.010, roller_shape="capsule", roller_length=4e-3),
    "mecanum": MecanumWheel(radius=0.025, mass=0.1, rollers=12),
}


def machine(wheel=SPHERES, **parts) -> Design:
    parts = {"sphere": Sphere(R, 2.0), "contact": Contact(5e4, 60.0, 0.8, creep_speed=1e-5), **parts}
    return replace(atlas(wheel, radius=R), **parts)


def speeds(*values, duration=0.2, **more) -> Motion:
    return Motion("wheel-speed", Series((0.0,), (values,)), duration=duration, sample_rate=500.0, **more)


@pytest.mark.parametrize("name", WHEELS)
def test_geoms_touch_the_sphere_where_the_outline_says(name):
    wheel = WHEELS[name]
    model = mjcf_spec(machine(wheel), mesh=(31, 192)).compile()
    data, outline = mujoco.MjData(model), profile(wheel, R)
    hub, sphere = model.body("wheel_1").id, model.geom("sphere").id
    rollers = [g for g in range(model.ngeom) if model.geom(g).name.startswith("wheel_1_roller")]
    R_hat = model.body_pos[hub] / np.linalg.norm(model.body_pos[hub])
    # A mesh of 192 points around leaves r_r (1 − cos(π/192)) = 0.6 µm, one of 31 circles as much along the roller.
    slack = 1.5e-6 if wheel.roller_shape == "barrel" else 1e-9
    for angle in np.linspace(0, 1.1, 12):
        data.joint("wheel_1").qpos[0] = angle
        # The sphere rises along the line of centres by h.
        data.joint("sphere").qpos[:3] = -R_hat * outline.height(angle)
        mujoco.mj_kinematics(model, data)
        gap = min(mujoco.mj_geomDistance(model, data, sphere, g, 1.0, np.zeros(6)) for g in rollers)
        assert gap == pytest.approx(0, abs=slack)


def test_file_keeps_masses_and_contacts():
    tensor = ((0.05, 0.004, 0.0), (0.004, 0.06, 0.003), (0.0, 0.003, 0.07))
    design = machine(
        MecanumWheel(radius=0.025, mass=0.1, rollers=12, roller_shape="capsule", roller_length=0.01, roller_radius=4e-3),
        sphere=Sphere(R, 2.0, tensor, (0.01, -0.02, 0.005)),
        mount=Mount(1e5, 20.0),
        closure=Closure(100.0, 5.0, (1.0, 2.0, -30.0), (Spring((0, 0, 1), 50.0, 2.0),)),
    )
    model = mjcf_spec(design).compile()
    again = mujoco.MjModel.from_xml_string(export_text("mjcf", design))
    # Six digits are written.
    for field in (
        "body_mass", "body_inertia", "body_ipos", "body_pos", "jnt_axis", "jnt_stiffness", "dof_damping", "pair_solref",
        "pair_solreffriction", "pair_solimp", "pair_friction", "actuator_biasprm", "actuator_gear",
    ):  # fmt: skip
        one, two = getattr(model, field), getattr(again, field)
        np.testing.assert_allclose(two, one, rtol=1e-5, atol=1e-6 * np.abs(one).max(), err_msg=field)
    assert again.body_subtreemass[0] == pytest.approx(2.0 + 3 * 0.1, rel=1e-5)
    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, again.body("sphere").iquat)
    turn, offset = axes.reshape(3, 3), again.body("sphere").ipos
    about = turn @ np.diag(again.body("sphere").inertia) @ turn.T + 2.0 * (
        offset @ offset * np.eye(3) - np.outer(offset, offset)
    )
    np.testing.assert_allclose(about, tensor, atol=1e-6)


def test_wheels_have_the_design_s_axial_inertia():
    wheel = replace(WHEELS["mecanum"], axial_inertia=7e-5)
    model = mjcf_spec(machine(wheel), roller_share=0.3, mesh=(5, 16)).compile()
    data, full = mujoco.MjData(model), np.zeros((model.nv, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, full)
    dof = model.joint("wheel_2").dofadr[0]
    # MuJoCo's entry is the wheel's with its rollers held still in it.
    assert full[dof, dof] == pytest.approx(7e-5, rel=1e-9)


@pytest.mark.parametrize(("name", "duration"), [("spheres", 1.0), ("dual", 0.3), ("mecanum", 0.3)])
def test_file_runs_without_warning(name, duration, tmp_path):
    path = tmp_path / "machine.xml"
    export("mjcf", machine(WHEELS[name], closure=Closure(force=(0.0, 0.0, -40.0))), path)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    data.ctrl[model.actuator("motor_1").id] = 0.2
    mujoco.mj_step(model, data, math.ceil(duration / model.opt.timestep))
    assert not any(warning.number for warning in data.warning)
    assert np.isfinite(data.qpos).all() and data.ncon >= 3
    # The sphere lies on its wheels: lower by the valleys and the penetration, no further.
    assert np.abs(data.body("sphere").xpos).max() < 4e-3
    assert data.joint("wheel_1").qvel[0] > 0.5


def test_contacts_have_the_design_s_stiffness():
    ready = prepare(machine(), speeds(0, 0, 0))
    model, data = ready.model, ready.data
    law = contact_law(machine())
    assert data.ncon == 3 and data.nefc == 9
    k, B, R_n = data.efc_KBIP[::3, 0] * data.efc_KBIP[::3, 2], data.efc_KBIP[::3, 1], data.efc_R[::3]
    np.testing.assert_allclose(k / R_n, law.stiffness, rtol=1e-12)
    np.testing.assert_allclose(B / R_n, law.damping, rtol=1e-12)
    for row in (1, 2):
        np.testing.assert_allclose(data.efc_KBIP[row::3, 1] / data.efc_R[row::3], law.friction_slope, rtol=1e-12)
        assert (data.efc_KBIP[row::3, 1] * model.opt.timestep < 2).all()


def test_sphere_on_one_roller_is_a_damped_oscillator():
    # A sphere let go where it just touches one roller below it; the wheel cannot turn, by symmetry.
    M, K, C, g = 2.0, 5e4, 60.0, 9.80665
    wheel = replace(SPHERES, axial_inertia=1e-3)
    design = Design("one", Sphere(R, M), (Placement.at(wheel, 0.0, -math.pi / 2),), Contact(K, C, 0.8))
    spec = mjcf_spec(design, timestep=2e-5)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model = spec.compile()
    data = mujoco.MjData(model)
    z, N, time = [], [], []
    for _ in range(1000):
        mujoco.mj_forward(model, data)
        time.append(data.time)
        z.append(data.body("sphere").xpos[2])
        N.append(data.efc_force[0] if data.nefc else 0.0)
        mujoco.mj_step(model, data)
    t, a = np.array(time), C / (2 * M)
    w = math.sqrt(K / M - a * a)
    sunk = M * g / K
    exact = -sunk + sunk * np.exp(-a * t) * (np.cos(w * t) + a / w * np.sin(w * t))
    # MuJoCo's contact adds 1/R = 0.2 g to 2 kg, which shifts the phase by half of 1e-4 of w t = 3.
    assert np.abs(np.array(z) - exact).max() < 1e-3 * sunk
    rate = np.gradient(exact, t)
    np.testing.assert_allclose(N[5:-5], (-K * exact - C * rate)[5:-5], atol=2e-3 * M * g)


@pytest.mark.parametrize("name", ["spheres", "mecanum", "dual", "split"])
def test_seat_is_at_rest(name):
    design = machine(
        WHEELS[name],
        mount=Mount(2e5, 30.0),
        closure=Closure(2e3, 5.0, (3.0, -2.0, -30.0), (Spring((0.6, 0, 0.8), 4e3, 2.0),)),
    )
    run = run_mujoco(design, speeds(0, 0, 0, duration=0.05), Settings(mesh=(21, 128)))
    c = run.centre_displacement[0]
    # On a mesh the contact is a corner, up to half a facet off its place; round shapes stay where they are.
    assert np.abs(run.centre_displacement - c).max() < (2e-5 if name == "mecanum" else 1e-9)
    # The springs pull the centre back to where it is drawn, so the forces balance only with the right signs.
    pads = design.contact_directions.T @ design.contact_directions * 2e3
    spring = 4e3 * np.outer([0.6, 0, 0.8], [0.6, 0, 0.8])
    load = np.array([3.0, -2.0, -30.0 - 2 * 9.80665]) - (pads + spring) @ c
    races = [i for i, w in enumerate(design.wheels) for _ in design.races(w)]
    far = [-1.0 if race.antipodal else 1.0 for w in design.wheels for race in design.races(w)]
    held = np.array(far)[:, None] * design.contact_directions[races] * run.normal_force[0][:, None]
    # Normals lean against R̂ by the slope of the outline, and û takes a share then: to that angle.
    np.testing.assert_allclose(held.sum(axis=0), load, atol=0.06 * np.linalg.norm(load))


CAPSULES = dict(radius=0.025, mass=0.1, rollers=12, roller_shape="capsule", roller_length=0.012, roller_radius=3.5e-3)


@pytest.mark.parametrize(
    ("wheel", "slack"),
    [
        (SPHERES, 1e-3),
        # Inclined rollers carry the contact along ŵ and back, so that it rolls on another radius than r_eff: 1.2 % here.
        (MecanumWheel(**CAPSULES), 0.02),
        (MecanumWheel(**CAPSULES, roller_angle=-math.pi / 4), 0.02),
    ],
    ids=["spheres", "right", "left"],
)
def test_run_turns_the_sphere_as_the_kinematics_say(wheel, slack):
    # Stiff, since a contact pressed in by 0.2 mm takes that much off the rolling radius.
    stiff = Contact(1e6, 200.0, 0.8, creep_speed=1e-5)
    design = replace(
        machine(wheel, contact=stiff), placements=atlas(wheel, heading_deg=20).placements, sphere=Sphere(1.22, 2.0)
    )
    speed = (0.5, 1.0, -0.5)
    period = 2 * math.pi / (12 * 0.5)
    motion = Motion("wheel-speed", Series((0.0,), (speed,)), duration=1.25 * period, sample_rate=200 / period)
    # A round sphere's turning does not depend on how it lies.
    motion = replace(motion, orientation=(0.5, 0.5, -0.5, 0.5))
    run = run_mujoco(design, motion, Settings(timestep=2e-4))
    np.testing.assert_allclose(run.angular_velocity[0], kinematics.forward(design, speed), atol=1e-12)
    mean = run.angular_velocity[50:250].mean(axis=0)
    J = kinematics.jacobian(design) * profile(wheel, 1.22).rolling_radius / wheel.radius
    np.testing.assert_allclose(run.wheel_speed[-1], speed, rtol=1e-6)
    assert np.linalg.norm(mean - J @ speed) < slack * np.linalg.norm(mean)


def test_run_follows_speeds_that_change():
    ramp = Series((0.0, 0.1, 0.2), ((0.0, 1.0, 0.0), (2.0, 0.0, -1.0), (2.0, 1.0, 0.0)))
    run = run_mujoco(machine(), Motion("wheel-speed", ramp, duration=0.2, sample_rate=500.0, wheel_angle=(0.1, 0.2, 0.3)))
    # Inputs are taken at the middle of steps, angles are of first order in the step of 0.1 ms.
    np.testing.assert_allclose(run.wheel_speed, ramp.at(run.time), atol=1e-6)
    np.testing.assert_allclose(run.wheel_angle - np.array([0.1, 0.2, 0.3]), ramp.integral(run.time), atol=2e-4)


def test_seat_on_mounts_gives_way_by_both_springs():
    design = machine(mount=Mount(2e5, 30.0))
    run = run_mujoco(design, speeds(0, 0, 0, duration=0.01))
    # Three balls stand on top at angle 0, 40 deg below the equator: 3 N sin 40° = M g, N = K k/(K + k) · sink · sin 40°.
    series = 1 / (1 / 5e4 + 1 / 2e5)
    sink = 2.0 * 9.80665 / (3 * series * math.sin(math.radians(40)) ** 2)
    # The normals turn a little towards the sphere's centre as it sinks.
    assert run.centre_displacement[0] == pytest.approx((0, 0, -sink), rel=5e-3, abs=1e-9)


def test_run_under_torques_gains_the_work_of_its_motors():
    # Without friction nothing couples wheels and sphere but the outline; wheels turn up as T/I.
    design = machine(contact=Contact(5e4, 60.0, 0.0), closure=Closure(force=(0.0, 0.0, 19.0)))
    motion = Motion("wheel-torque", Series((0.0, 0.1), ((1e-3, -2e-3, 0.0), (3e-3, 0.0, 0.0))), duration=0.1, sample_rate=500.0)
    run = run_mujoco(design, motion, Settings())
    I = SPHERES.spin_inertia
    # The sphere, held up by all but 0.6 N, rests on its rollers with N = 0.3 N, whose cogging is N r_w′ ≤ 0.3 N · 5 mm.
    gained = np.array([2e-3, -1e-3, 0.0]) * 0.1 / I
    np.testing.assert_allclose(run.wheel_speed[-1], gained, atol=0.1 * 1.5e-3 / I)


def test_run_with_a_stage_moves_all_mass():
    design = machine(stage=Stage(3.0), closure=Closure(5e3, 50.0), mount=Mount(1e5, 50.0))
    push = (2.0, -3.0, 1.0)
    stage = StageMotion("force", Series((0.0,), (push,)))
    run = run_mujoco(design, speeds(0, 0, 0, stage=stage), Settings(integrator="RK4"))
    # Sphere 2 kg, stage 3 kg, wheels 0.3 kg. What rings between them is small beside the path.
    t = run.time[:, None]
    path = np.array(push) * t**2 / 2 / 5.3
    moved = run.stage_position + 2.0 / 5.3 * (run.centre_displacement - run.centre_displacement[0])
    # Wheels on mounts that ring by N/k = 1e-4 m carry 0.1/5.3 of the mass each.
    assert np.abs(moved - path).max() < 1e-5
    still = run_mujoco(design, speeds(0, 0, 0), Settings())
    given = StageMotion("position", Series((0.0, 0.1, 0.2), ((0, 0, 0), (0.01, 0, 0), (0.03, 0, 0))))
    carried = run_mujoco(design, speeds(0, 0, 0, stage=given), Settings(integrator="RK4"))
    assert np.abs(still.stage_position).max() == 0
    assert carried.stage_position[-1] == pytest.approx((0.03, 0, 0), abs=1e-6)


def test_speed_loop_drives_the_wheels():
    design = machine(motor=Motor(torque=50.0, proportional_gain=5.0, integral_gain=50.0), closure=Closure(force=(0, 0, -20.0)))
    run = run_mujoco(design, speeds(1.0, 2.0, -1.0, duration=0.4), Settings())
    np.testing.assert_allclose(run.wheel_speed[100:].mean(axis=0), (1, 2, -1), atol=0.05)
    # A loop gives way to the rollers where a prescribed speed does not.
    assert run.wheel_speed[100:].std(axis=0).max() > 1e-4
    with pytest.raises(SpheredriveError, match="leave the gains out"):
        run_mujoco(design, Motion("wheel-torque", Series((0.0,), ((0.0,) * 3,)), duration=0.1))


def test_refusals_say_what_is_missing():
    with pytest.raises(SpheredriveError, match=r"give sphere\.mass"):
        mjcf_spec(machine(sphere=Sphere(R)))
    with pytest.raises(SpheredriveError, match=r"contact\.stiffness"):
        run_mujoco(machine(contact=Contact()), speeds(0, 0, 0))
    with pytest.raises(SpheredriveError, match=r"give stage\.mass"):
        mjcf_spec(machine(), stage="free")
    with pytest.raises(SpheredriveError, match="no integrator 'euler'"):
        run_mujoco(machine(), speeds(0, 0, 0), Settings(integrator="euler"))
    with pytest.raises(UnknownNameError, match="did you mean 'mjcf'"):
        export_text("mjfc", machine())


def test_largest_step_stays_within_its_limit():
    motion = speeds(1.0, 2.0, -1.0, duration=0.1)
    design = machine(closure=Closure(force=(0.0, 0.0, -40.0)))
    found = largest_step(design, motion, 0.05, longest=1e-3)
    by_step = dict(zip(found.timestep, found.difference, strict=True))
    assert by_step[found.largest] <= 0.05 and found.timestep[0] < found.timestep[-1] == 1e-3
    longer = [step for step in found.timestep if step > found.largest]
    assert not longer or by_step[longer[0]] > 0.05
    assert run_difference(*[run_mujoco(design, motion)] * 2) == 0

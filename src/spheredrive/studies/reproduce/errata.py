"""Where the thesis is wrong or silent: one sentence each, numbered as on the model's page (E1–E9) and beyond."""

ERRATA = {
    "E1": (
        "[3.41] carries −K′(Δ + δ), a closure spring that pushes the sphere off its wheels. One that restores has the sign "
        "+, and then the natural frequency rises with K′."
    ),
    "E2": ("[2.71] prints +d² under some of its roots. The vectors have length 1 with −d² only."),
    "E3": (
        "Its displacement of the centre is the elastic deflection of the contacts, with the impulse of r̈_w at each "
        "roller's edge left out. Far below resonance the centre follows the shape of the wheels, as it must."
    ),
    "E4": (
        "Table 2.1 is read as straight lines between its times and the magnitude's error as a share of the corrected |Ω|: "
        "only so do both printed peaks come out."
    ),
    "E5": (
        "A roller is not a sphere of the wheel's radius: its patch is an ellipse, and the circular formulas are an "
        "approximation."
    ),
    "E6": ("The inertias of the demonstrator are not given."),
    "E7": (
        "[3.8, 3.11, 4.6] put the corners of the shape at the edges of the rollers (standard) or on top of them (Mecanum) "
        "and round the valleys. A real wheel is smooth on its rollers and has its corner in the valley."
    ),
    "E8": (
        "The sphere is one body on all its contacts. They move it independently of one another only where they are orthogonal."
    ),
    "E9-coplanar": ("Least squares [2.31] fails as soon as all Ω̂ lie in one plane; parallel ones are only the extreme case."),
    "E9-magnitude": (
        "Equal speeds on equal races turn the sphere about z whatever the race, but the race's place on the sphere changes "
        "how fast."
    ),
    "E9-numbering": ("[2.63–2.66] number the races the other way round from the Atlas: the same physics."),
    "E9-hand": ("cot³α − 1 vanishes for rollers of one hand only; at −45° it is −2."),
    "E9-collinear": ("Both conditions are met, yet they leave one rotation free of slip, not all."),
    "E9-ellipse": ("The ellipse of [4.1] never enters [4.4], which takes circles."),
    "E9-cogging": ("[3.39] lacks the torque of the shape, −N r_w′."),
    "E9-negative": (
        "[3.46] takes friction at its limit with the sign of the torque; a contact is pressed whichever way it is driven, N "
        "= |f|/μ."
    ),
    "E10": ("The thesis's own wheel, with 14 rollers and η = 0.4485, is already beyond the bound."),
    "E11": (
        "The centre of mass of sphere and stage follows P alone, so an offset mass that turns shakes the stage by "
        "[3.37–3.38], and its weight turns the sphere by [3.40]."
    ),
    "E12": ("Springs and dampers that do not change with time answer a periodic shape at its own frequencies, whatever K is."),
    "E13": (
        "The resistances are N l_r and μ N l_s. Pressed by its own weight instead of the thesis's least N, the same sphere "
        "meets resistances of the size of its drive torques."
    ),
    "E14": (
        "A gap's depth grows as η² and its width as η, so off the corners r_w″ keeps its size however round the wheel; what "
        "shrinks with η is the impulse at the corners, which Fig 4.18 leaves out."
    ),
    "E15": (
        "Slowly driven, the deflection is about M_s r̈_w (1/K + 1/k), which falls as mounts stiffen. The centre itself "
        "follows the shape on any mount that is stiff enough."
    ),
    "E16": (
        "On a closure that restores, the share 1/(1 + K′ (1/K + 1/k)) of the shape reaches the centre, and √(1 + K′/K) "
        "times the frequency: K′ matters as soon as it is not small against K."
    ),
    "E17": (
        "[3.41] as printed drives the deflection by K′(r_w − Z_c) as well: it grows by K′ h/(K − K′), which no figure shows."
    ),
}


def number(key: str) -> str:
    """ "E9" of "E9-hand": the number on the model's page."""
    return key.partition("-")[0]

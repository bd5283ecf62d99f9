"""Parameters that each model can be run with, for tests of what all models keep to."""

BLOCK = {"half_width": 0.1, "cg_height": 0.5}
"""A block 20 cm wide, with its centre of gravity at half a metre."""

VALID: dict[str, dict[str, float]] = {
    "rocking": BLOCK,
    "sliding": {"friction_static": 0.2},
    "standing": {**BLOCK, "friction_static": 0.4},
    "unanchored": {**BLOCK, "friction_static": 0.4},
    "stress": {"mass": 10.0, "lever": 0.3, "area": 1e-3, "section_modulus": 1e-5},
    "flexible_stress": {
        "mass": 10.0,
        "lever": 0.3,
        "area": 1e-3,
        "section_modulus": 1e-5,
        "frequency": 4.0,
        "damping": 0.02,
    },
    "swing": {"length": 1.0, "damping": 0.02},
    "swing_3d": {"length": 1.0, "damping": 0.02},
    "friction_isolator": {"friction_static": 0.1},
    "horizontal_isolator": {"frequency": 0.5, "damping": 0.02, "friction": 0.1},
    "rotational_isolator": {"frequency": 3.0, "damping": 0.2, "cg_height": 0.5, "inertia_ratio": 1.3},
    "oscillator": {"frequency": 4.0, "damping": 0.02},
    "unhooking": {"hook_height": 0.2, "hook_offset": 0.02, "gyration": 0.3, "restitution": 0.3},
    "hanger_load": {"amplification": 1.0},
}

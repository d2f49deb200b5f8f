"""000 and 001: contact without a mode schedule; rows are the examples as they are, and audits."""

from benchmarks.reproduce.rows import Patch, Row, Table

_STICTION, _LEAST_TIME = 16 / 3**0.5, 1.1063832
_BACKWARD_EULER: Patch = {
    "kind": "contact_implicit",
    "segments": 20,
    "discretisation": "backward_euler",
    "slip_bound": 5,
    "relaxation": {"schedule": [1e-2, 1e-3, 1e-4, 1e-5, 1e-7]},
}
_FIRST_ORDER = "steps are of the first order"


def _audited(name: str, example: str, changes: Patch | None = None) -> Row:
    return Row(name, example, changes or {}, refinement=None, kind="audit")


def _polished(name: str, example: str, segments: int, optimum: float, tolerance: float) -> Row:
    steps = {"kind": "contact_implicit", "segments": segments}
    return Row(
        name,
        example,
        {
            "method": {"kind": "contact_implicit_polished", "steps": steps},
            "refinement": {"tolerance": 1e-8},
        },
        optimum=optimum,
        tolerance=tolerance,
        refinement=None,
        kind="audit",
    )


CONTACT = Table(
    "000",
    "through contact",
    "The seed prints no numbers of its blocks, fingers and grippers but pictures, and of Spring "
    "Flamingo a cost of transport of 0.04 after 0.18 of the nominal gait (001). The polished rows "
    "solve the sequence that steps found by hybrid collocation. What steps lose by themselves is "
    "in the audit's books. Sizes and masses that the seeds leave out are stated in the examples.",
    (
        Row(
            "block with stiction",
            "stiction_block",
            optimum=_STICTION,
            tolerance=2e-3,
            refinement=None,
            why=_FIRST_ORDER,
            kind="audit",
        ),
        _polished("block with stiction, polished", "stiction_block", 20, _STICTION, 1e-8),
        Row(
            "block, least time",
            "block_min_time",
            optimum=_LEAST_TIME,
            tolerance=5e-3,
            refinement=None,
            why=_FIRST_ORDER,
            kind="audit",
        ),
        _polished("block, least time, polished", "block_min_time", 40, _LEAST_TIME, 2e-6),
        _audited("block dropped and sliding", "block_dropped"),
        _audited("plastic ball", "plastic_ball"),
        _audited("finger, one second", "finger_no_gravity"),
        _audited("finger, two seconds", "finger_no_gravity_two_seconds"),
        _audited("finger, four seconds", "finger_no_gravity_four_seconds"),
        _audited("finger with gravity", "finger_gravity"),
        _audited("gripper", "gripper"),
        _audited("gripper, least force", "gripper_least_force"),
        _audited("gripper, forces at most", "gripper_force_cap"),
        _audited("gripper, throw", "gripper_throw"),
        Row(
            "Spring Flamingo, walk",
            "spring_flamingo",
            printed="0.04",
            refinement=None,
            why="the seed's cost was not audited; ours has contacts that feed nothing in",
            kind="audit",
        ),
        Row(
            "Spring Flamingo, the seed's backward Euler",
            "spring_flamingo",
            {"method": _BACKWARD_EULER},
            refinement=None,
            meets=False,
            why="limbs are lifted by work from nothing: the audit fails, as it should",
            kind="audit",
        ),
        _audited("Spring Flamingo, short steps", "spring_flamingo_short"),
        _audited("Spring Flamingo, long steps", "spring_flamingo_long"),
        _audited("Spring Flamingo, hop", "spring_flamingo_hop"),
        _audited("hopper over a gap", "hopper"),
        _audited("hopper onto a step", "hopper_step"),
        _audited("biped over uneven ground", "biped_uneven"),
        _audited("box that slides and tips", "box_tipping"),
        _audited("ball with spin", "ball_spin"),
        _audited("Solo 12 hops", "solo_hop"),
    ),
)

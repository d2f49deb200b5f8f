"""000 and 001: contact without a mode schedule; rows are the examples as they are, and audits."""

from benchmarks.reproduce.rows import Patch, Row, Table

_STICTION, _LEAST_TIME = 16 / 3**0.5, 1.1063832
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
            tolerance=2e-3,
            refinement=None,
            why=_FIRST_ORDER,
            kind="audit",
        ),
        _polished("block, least time, polished", "block_min_time", 40, _LEAST_TIME, 1e-6),
        _audited("block dropped and sliding", "block_dropped"),
        _audited("plastic ball", "plastic_ball"),
        _audited("finger, one second", "finger_no_gravity"),
        _audited("finger, two seconds", "finger_no_gravity_two_seconds"),
        _audited("finger, four seconds", "finger_no_gravity_four_seconds"),
        _audited("finger with gravity", "finger_gravity"),
    ),
)

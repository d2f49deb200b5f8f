"""What a step of the time-stepping simulation costs: a five-link biped on its feet.

Run: python -m benchmarks.contact_step. Seven coordinates, the feet are points of the shanks: four
contacts, four joint limits; processor time of this process.
"""

import time
from typing import Any

import numpy as np

from schemas.mechanisms import Mechanism
from solver.simulation.multibody import Multibody
from solver.simulation.stepping import Stepper
from solver.simulation.unilateral import Unilateral

STEPS, LENGTH = 1000, 1e-3


def main() -> None:
    """Print the mean time of a step, and of how many contacts it is."""
    multibody = Multibody.of(Mechanism.model_validate(biped()))
    controls = len(multibody.controls)
    system = Unilateral.of(multibody, lambda t, *_: np.zeros((controls, len(t))))
    stepper, n = Stepper(system), len(multibody.coordinates)
    state = np.zeros(2 * n)
    state[multibody.coordinates.index("torso.y")] = 0.8
    stepper.step(0.0, state, LENGTH)
    pushing, began = 0, time.process_time()
    for k in range(STEPS):
        found = stepper.step(k * LENGTH, state, LENGTH)
        state, pushing = found.state, pushing + int(np.sum(found.normal > 0))
    spent = (time.process_time() - began) / STEPS
    print(f"biped, {n} coordinates, {len(system.names)} unilateral constraints")
    print(
        f"{1e3 * spent:.2f} ms a step of {1e3 * LENGTH:g} ms; {pushing / STEPS:.1f} contacts push"
    )


def biped() -> dict[str, Any]:
    """Torso, two thighs, two shanks; each foot touches with heel and toe. Nothing drives it."""
    shank: dict[str, Any] = {"mass": 3.2, "inertia": 0.2, "com": [0, -0.128]}
    thigh: dict[str, Any] = {"mass": 6.8, "inertia": 0.47, "com": [0, -0.163]}
    document: dict[str, Any] = {
        "kind": "mechanism",
        "bodies": {"torso": {"mass": 12, "inertia": 1.8, "com": [0, 0.2]}},
        "joints": {"base": {"kind": "floating", "child": "torso"}},
        "contacts": {},
        "surfaces": {"ground": {"friction": 0.8}},
    }
    for side in ("left", "right"):
        document["bodies"] |= {f"thigh_{side}": thigh, f"shank_{side}": shank}
        document["joints"] |= {
            f"hip_{side}": {"kind": "revolute", "parent": "torso", "child": f"thigh_{side}"},
            f"knee_{side}": {
                "kind": "revolute",
                "parent": f"thigh_{side}",
                "child": f"shank_{side}",
                "at": [0, -0.4],
                "limits": [-2, 0],
            },
        }
        document["contacts"] |= {
            f"toe_{side}": {"body": f"shank_{side}", "at": [0.05, -0.4]},
            f"heel_{side}": {"body": f"shank_{side}", "at": [-0.05, -0.4]},
        }
    return document


if __name__ == "__main__":
    main()

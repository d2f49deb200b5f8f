"""What counts as touching and as sliding, and what is too slight to be a mode of its own.

All are weights of physics, an impulse, a gap, a way; none is a number of steps, since a whole kick
may be one step. A mechanism's weight is its masses times gravity, without gravity the largest
effort of a motor (``solver.contact.forces.typical_force``).
"""

from typing import Final

PRESSING: Final = 1e-3
"""The least normal force that touches, over the weight. A pair that was relaxed to 1e-7 and not
polished has force over weight times gap = 1e-7 m: what presses less is open by 0.1 mm or more."""

LENGTH: Final = 1.0
"""m, the gap that a whole weight weighs as much as, in the pairs of the homotopy: of gap and force
the smaller one counts as zero."""

BLOW: Final = 5e-4
"""s: impulses below the weight for so long are no touch of their own. Such a one changes the speed
of the whole machine by 5 mm/s at 9.81 m/s^2; a kick changes that of a limb by m/s."""

CLOSED: Final = 5e-4
"""m (rad of hinges): half a millimetre. Gaps that stay below it between two touches are no flight;
and where no forces are known, as in guesses, smaller gaps touch."""

SLIDING: Final = 1e-3
"""The least slip that slides, over the fastest slip of any contact, open ones too."""

SLOWEST: Final = 1e-4
"""m/s: slips below it are rest, however slowly everything moves."""

WAY: Final = 5e-4
"""m: half a millimetre. A slide that never comes farther is none of its own."""

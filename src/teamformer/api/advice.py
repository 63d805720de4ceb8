"""What would help a mission, measured. The command line calls the same; nothing prints."""

from __future__ import annotations

from teamformer.advice.advise import advise_on
from teamformer.advice.suggestions import Advice
from teamformer.model import Scenario


def advise(mission: Scenario, seconds: float = 60.0, workers: int = 1) -> Advice:
    """Return what would help a mission most, and who could be spared, measured by planning again.

    Each of these is tried: one more robot of each kind, one fewer, each robot at double speed, each
    capability taught to each kind that lacks it, each task left out. Every change is searched
    several times, for about so many `seconds` of processor time in all; what there was no time for
    is `unmeasured`. With more than one of `workers`, processes search side by side; a script then
    needs `if __name__ == "__main__":`. Missions in steps are run by the default method, those in
    continuous time planned by `plan`. Raises `TeamformerError` for a mission that is not completed.

    >>> advice = tf.advise(tf.load("examples/four-robots.yaml"), seconds=20)
    >>> best = advice.suggestions[0]  # the largest gain first
    >>> best.change, best.makespan, best.gain
    ('without task t3', 15.0, 12.0)
    >>> best.gain > best.noise, advice.spare
    (True, ())
    """
    return advise_on(mission, seconds, workers)

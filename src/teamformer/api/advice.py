"""What would help a mission, measured. The command line calls the same; nothing prints."""

from __future__ import annotations

from teamformer.advice.advise import advise_on
from teamformer.advice.suggestions import Advice
from teamformer.api.trials import refuse_no_mission
from teamformer.model import Scenario


def advise(mission: Scenario, seconds: float = 60.0, workers: int = 1) -> Advice:
    """Return what would help a mission most, and which robots could be spared.

    The mission is planned again with one thing changed at a time: one more robot of each kind, one
    fewer, each robot and each kind at double speed, each robot that is lost kept, each capability
    taught to each kind that lacks it, each task left out. Each change is planned several times.
    `seconds` is the processor time for everything; changes that it did not suffice for are in
    `unmeasured`. If `workers` is more than 1, this many processes work side by side, and a script
    needs `if __name__ == "__main__":`. Missions in steps are run by the default method, and
    missions in continuous time are planned by `plan`. Raises `TeamformerError` for a mission that
    is not completed.

    >>> advice = tf.advise(tf.load("examples/four-robots.yaml"), seconds=20)
    >>> best = advice.suggestions[0]  # the largest gain first
    >>> best.change, best.makespan, best.gain
    ('without task t3', 15.0, 12.0)
    >>> best.gain > best.noise, advice.spare
    (True, ())
    """
    refuse_no_mission(mission, "advise")
    return advise_on(mission, seconds, workers)

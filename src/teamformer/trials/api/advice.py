"""What would help a mission, and what its past tells; the command line calls the same."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.mission.checks.rules import rules_not_advised
from teamformer.mission.model import Mission
from teamformer.record.record import Record
from teamformer.trials.advice.advise import advise_on
from teamformer.trials.advice.experience import Experience
from teamformer.trials.advice.experience import learn as learn_from
from teamformer.trials.advice.suggestions import Advice
from teamformer.trials.api.arguments import known_seconds, refuse_no_mission


def advise(mission: Mission, seconds: float = 60.0, workers: int = 1) -> Advice:
    """Return what would help a mission most, and which robots could be spared.

    The mission is planned again with one thing changed at a time: one more robot of each kind, one
    fewer, each robot and each kind at double speed, each robot that is lost kept, each capability
    taught to each kind that lacks it, each kind with shifts at work for longer, each task left out.
    Each change is planned several times.
    `seconds` is how long all of it may take; changes that there was no time for are in
    `unmeasured`. If `workers` is more than 1, this many processes work side by side, and a script
    needs `if __name__ == "__main__":`. Missions in steps are run by the default method.
    Missions in continuous time are planned by `plan`, or run if something happens in them that no
    plan knows. Raises `TeamformerError` for a mission that
    is not completed.

    >>> advice = tf.advise(tf.load("examples/four-robots.yaml"), seconds=20)
    >>> best = advice.suggestions[0]  # the largest gain first
    >>> best.change, best.makespan, best.gain
    ('without task t3', 15.0, 12.0)
    >>> best.gain > best.noise, advice.spare
    (True, ())
    """
    refuse_no_mission(mission, "advise")
    if problems := list(rules_not_advised(mission)):
        raise MissionError(problems)
    return advise_on(mission, known_seconds(seconds), workers)


def learn(mission: Mission, records: Sequence[Record]) -> Experience:
    """Return a mission whose uncertain durations and needs are as records of its site show them.

    The result has the `mission`, and its `lessons` one by one. Records are of missions in the same
    world. Only what has shown itself counts: durations of tasks that were done, needs that became
    known. Near tasks count more (docs/how-to/learn.md). Raises `TeamformerError` for what is no
    record, for a record of another world, and if neither a duration nor a need of the mission is
    uncertain.

    >>> mission = tf.setting("4N20T-C4-needs", seed=1)
    >>> past = [tf.run(mission, seed=seed).record for seed in range(5)]
    >>> learned = tf.learn(mission, past)
    >>> len(learned.lessons) == sum(len(task.may_need) for task in mission.tasks)
    True
    """
    refuse_no_mission(mission, "learn")
    records = [records] if isinstance(records, Record) else list(records)
    for record in records:
        if not isinstance(record, Record):
            what = f"learn takes records, not {type(record).__name__}"
            raise TeamformerError(what, "write trial.record for each trial")
    return learn_from(mission, records)

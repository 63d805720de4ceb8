"""What every coordinator keeps, whoever wrote it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from teamformer.base.errors import TeamformerError
from teamformer.methods.by_name import Method
from teamformer.mission.coordination import NEWS, Coordinator, Known, Plan, heeded_by
from teamformer.mission.model import Mission
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.testing.missions import usual_missions
from teamformer.trials.trial import run_trial


def check_coordinator(make: Callable[[], Coordinator], missions: Sequence[Mission] = ()) -> None:
    """Check that what `make` returns is a coordinator; raises `AssertionError` with what it is not.

    By its plans missions are completed, and their records are legal; the same question gets the
    same plan; and it keeps nothing of a mission. It is given `missions`, or some of each kind.
    """
    missions = missions or usual_missions()
    coordinator = make()
    name = type(coordinator).__name__
    assert callable(getattr(coordinator, "update", None)), (
        f"a coordinator has a method 'update', and {name} has none"
    )
    unknown = sorted(set(heeded_by(coordinator)) - set(NEWS))
    assert not unknown, f"a coordinator heeds news out of NEWS, and {name} heeds {unknown}"
    serving_all = _Watched(coordinator)
    for mission in missions:
        alone = _record(_Watched(make()), name, mission)
        shared = _record(serving_all, name, mission)
        assert alone.steps == shared.steps, (
            f"a coordinator keeps nothing of a mission, and {name} planned {mission.name} otherwise"
            " after others"
        )


class _Watched:
    """A coordinator that is asked everything twice."""

    def __init__(self, coordinator: Coordinator) -> None:
        self._coordinator = coordinator
        self.heeds = heeded_by(coordinator)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return its plan, the same for both questions."""
        name = type(self._coordinator).__name__
        made = self._coordinator.update(known, plan)
        assert isinstance(made, Plan), f"update() returns a Plan, and {name} returned {made!r}"
        again = self._coordinator.update(known, plan)
        assert made == again, (
            f"the same knowledge gets the same plan, and {name} made another one at step"
            f" {known.step} of {known.mission.name}"
        )
        return made


def _record(coordinator: Coordinator, name: str, mission: Mission) -> Record:
    try:
        record = run_trial(mission, Method(name, coordinator=coordinator)).record
    except TeamformerError as error:
        what = f"robots can go by every plan, and in {mission.name}: {error}"
        raise AssertionError(what) from error
    assert record.end.status == "completed", (
        f"a mission that can be done is completed, and by {name} {mission.name} ended as"
        f" '{record.end.status}'"
    )
    findings = judge(record).findings
    assert not findings, f"a record is legal, and by {name} in {mission.name}: {findings[0]}"
    return record

"""Forged records are found; whatever stands in a record, judging it ends without a traceback."""

from __future__ import annotations

from typing import Any

from hypothesis import reject
from hypothesis import strategies as st

from drawing import pick
from event_forgeries import forgeries as event_forgeries
from forgeries import FORGERIES, edited_records, forgeries
from methods import METHODS, play
from missions import SEEDS, continuous_missions, missions
from teamformer.base.errors import TeamformerError
from teamformer.files.mission_files import mission_from_tree
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.referee import judge
from test_forged_events import AT_THE_END
from test_forged_fields import FORGERIES as FIELDS
from watching import fuzzed, noted

RUN = "run FILE --method {method} --seed {seed} --out O; then forge O/record.json as below"


def record_of(mission: Any, method: str, seed: int) -> Any:
    """Return the tree of a record without what is told of it, which would give forgeries away."""
    record = record_to_tree(play(mission_from_tree(mission), method, seed).record)
    return {key: value for key, value in record.items() if key != "told"}


def findings_in(record: Any) -> list[str]:
    """Return what `check` tells of a record, be it that it cannot be read."""
    try:
        return [finding.message for finding in judge(record_from_tree(record, "record")).findings]
    except TeamformerError as error:
        return str(error).splitlines()


@fuzzed(
    40,
    RUN,
    mission=missions(),
    method=METHODS,
    seed=SEEDS,
    forgery=st.sampled_from(sorted(FORGERIES)),
    data=st.data(),
)
def test_a_forgery_is_found(
    mission: Any, method: str, seed: int, forgery: str, data: st.DataObject
) -> None:
    record = record_of(mission, method, seed)
    noted["forged"] = forged = data.draw(forgeries(forgery, record))
    if forged is not None and forged != record:
        assert findings_in(forged), f"{forgery} is not found"


@fuzzed(
    35,
    RUN,
    mission=missions(),
    method=METHODS,
    seed=SEEDS,
    field=st.sampled_from(sorted(FIELDS)),
    data=st.data(),
)
def test_a_forged_field_is_found(
    mission: Any, method: str, seed: int, field: str, data: st.DataObject
) -> None:
    forged = list(FIELDS[field](play(mission_from_tree(mission), method, seed).record))
    if forged:
        noted["forged"] = one = pick(data.draw, forged)
        assert judge(one).findings, f"{field} is not found"


@fuzzed(40, RUN, mission=missions(), method=METHODS, seed=SEEDS, data=st.data())
def test_any_record_is_judged_or_refused(
    mission: Any, method: str, seed: int, data: st.DataObject
) -> None:
    noted["forged"] = forged = data.draw(edited_records(record_of(mission, method, seed)))
    findings = findings_in(forged)
    assert all(line.isprintable() for line in findings), findings


@fuzzed(
    25,
    "run FILE --method plan --seed {seed} --out O; then forge O/record.json as below",
    mission=continuous_missions(),
    seed=SEEDS,
    data=st.data(),
)
def test_forged_events_are_found(mission: Any, seed: int, data: st.DataObject) -> None:
    """Honest records in continuous time are legal, and whatever is forged of them is found."""
    try:
        record = record_of(mission, "plan", seed)
    except TeamformerError:  # linked tasks without enough robots, which no check foresees
        reject()
    assert findings_in(record) == []
    told = [(name, forged) for name, forged in event_forgeries(record) if name not in AT_THE_END]
    if told:
        noted["forged"], forged = data.draw(st.sampled_from(told))
        assert findings_in(forged), f"{noted['forged']} is not found"

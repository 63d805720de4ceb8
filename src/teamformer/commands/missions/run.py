"""`teamformer run`: one scenario, one policy, one trial."""

from __future__ import annotations

import difflib
from collections import defaultdict
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.table import Table
from rich.text import Text

from teamformer.capabilities import describe
from teamformer.commands.compiling import announce_compiling
from teamformer.commands.console import (
    StepProgress,
    ended_like_ctrl_c,
    out,
    prepare_folder,
    print_json,
    say,
)
from teamformer.errors import ReaderGoneError, TeamformerError
from teamformer.export.reasons import story_lines
from teamformer.mission.rules import rules_not_played
from teamformer.model import Scenario
from teamformer.plane import Plane
from teamformer.planning.bounds.makespan import lower_bound
from teamformer.planning.teams.shared_plan import is_too_large
from teamformer.policies import POLICIES
from teamformer.policies.central.plays import CentralPlan
from teamformer.policies.protocol import Planner, Policy
from teamformer.scenarios.files import read_scenario
from teamformer.sim.replay.record import Replay
from teamformer.sim.replay.task_times import lateness
from teamformer.sim.replay.writing import replay_to_tree, write_replay
from teamformer.trials.registry import load_policy
from teamformer.trials.suiting import refuse_unknown, suited
from teamformer.trials.trial import Trial, run_trial
from teamformer.truth import draw_truth

LONGEST_TABLE = 40  # tasks
MOST_NAMES = 12


@dataclass(frozen=True)
class Changes:
    """What the command line changes in a scenario; None leaves what the file says."""

    order: str | None = None
    allocation: str | None = None
    step_limit: int | None = None

    def apply(self, scenario: Scenario) -> Scenario:
        """Return the changed scenario."""
        changed = {key: value for key, value in vars(self).items() if value is not None}
        return replace(scenario, **changed)

    def suit(self, scenario: Scenario, policy: Policy, name: str) -> Scenario:
        """Return a changed scenario under an allocation that a policy was made for, and say so.

        So it is said where crews stand in for a shared plan that would take too long. Raises
        `TeamformerError` if the command line asks for an allocation that the policy does not know.
        """
        refuse_unknown(policy, name, self.allocation)
        its_own = suited(scenario, policy)
        if its_own is not scenario:
            what = f"allocation {its_own.allocation}, not {scenario.allocation}"
            say(f"{name} was made for {what}, and runs under that")
        if its_own.allocation == "plan" != self.allocation and is_too_large(its_own):
            size = f"{len(its_own.robots)} robots and {len(its_own.tasks)} tasks"
            say(f"{size} are too many to share a plan soon: crews instead; or --allocation plan")
            return replace(its_own, allocation="crews")
        return its_own


def run(
    path: Path,
    policy_name: str,
    seed: int,
    changes: Changes,
    time_limit: float,
    folder: Path | None,
    with_page: bool,
    as_json: bool,
    explained: str | None = None,
) -> int:
    """Run a trial, write its record and show what came of it; return the exit status.

    `explained` is the name of a robot whose story is told too.
    """
    scenario = changes.apply(read_scenario(path, rules_not_played))
    robot = None if explained is None else _robot_number(scenario, explained)
    policy = ready_policy(policy_name, time_limit)
    scenario = changes.suit(scenario, policy, policy_name)
    if folder is not None:
        prepare_folder(folder)
    announce_compiling([policy_name], scenario.is_planned, scenario.allocation == "plan")
    with ended_like_ctrl_c():
        trial = watch_trial(scenario, policy, policy_name, seed)
    story = [] if robot is None else list(story_lines(trial.replay, robot))
    with suppress(ReaderGoneError):  # the record is written all the same
        if as_json:
            row = result_row(trial, best_known=best_known([trial]))
            told = {} if robot is None else {"story": story}
            print_json(row | told)
        else:
            _show(trial)
            if robot is not None:
                out.print(_story_table(story))
    if folder is not None:
        _write(trial.replay, folder, with_page)
    return 0 if trial.replay.end.status == "completed" else 1


def _robot_number(scenario: Scenario, name: str) -> int:
    """Return a robot's number; TeamformerError if there is none of this name."""
    names = [robot.name for robot in scenario.robots]
    if name not in names:
        near = difflib.get_close_matches(name, names, 1)
        hint = f"did you mean '{near[0]}'?" if near else f"the first is {names[0]}"
        raise TeamformerError(f"there is no robot '{name}' to explain", hint)
    return names.index(name)


def _story_table(story: Sequence[tuple[str, str, str]]) -> Table:
    table = Table(box=None, header_style="dim")
    for header in ("steps", "what it does", "why"):
        table.add_column(header, overflow="fold")
    for row in story:
        table.add_row(*(Text(part) for part in row))
    return table


def ready_policy(name: str, time_limit: float) -> Policy:
    """Return a policy by name; a planner is given its time."""
    policy = load_policy(name, POLICIES)
    if isinstance(policy, Planner):
        policy.time_limit = time_limit
    return policy


def watch_trial(scenario: Scenario, policy: Policy, name: str, seed: int) -> Trial:
    """Run a trial with its lower bound, and a display of progress if it takes long."""
    bound = lower_bound(draw_truth(scenario, seed))
    with StepProgress(len(scenario.tasks)) as progress:
        return run_trial(
            scenario,
            policy,
            name,
            seed,
            bound,
            on_step=lambda tally: progress.update(tally.steps, tally.tasks_done),
        )


def best_known(trials: Sequence[Trial]) -> int | None:
    """Return the fastest of several trials of one scenario; None if none was completed."""
    makespans = [trial.replay.end.makespan for trial in trials]
    makespans += [trial.plan.makespan for trial in trials if trial.plan]
    return min((steps for steps in makespans if steps is not None), default=None)


def percent_over(makespan: int | None, bar: int | None) -> float | None:
    """Return by how many percent a makespan is above a bar, if there are both."""
    return None if makespan is None or not bar else round(100 * (makespan / bar - 1), 2)


def _plan_row(plan: CentralPlan | None) -> dict[str, Any]:
    """Return what `--json` prints of the central planner's work."""
    if plan is None:
        return {}
    return {
        "relaxed": plan.solution.value,
        "proven": plan.solution.status == "optimal",
        "played_by": plan.played_by,
        "curve": plan.curve,
    }


def plan_line(plan: CentralPlan) -> str:
    """Return what is shown of the central planner's work."""
    solution = plan.solution
    return (
        f"schedule with free joining: {solution.value or 'none'} ({solution.status}, "
        f"bound {solution.bound}); played: {plan.played_by}"
    )


def _improvements(plan: CentralPlan) -> str:
    """Return what the planner found, and when."""
    found = ", ".join(f"{steps} ({seconds:.2f} s)" for seconds, steps in plan.curve) or "none"
    first = "; a first plan, which a longer --time-limit improves" if plan.is_first else ""
    return f"plans found: {found}{first}"


def result_row(trial: Trial, best_known: int | None) -> dict[str, Any]:
    """Return what `--json` prints of a trial."""
    replay, end = trial.replay, trial.replay.end
    return {
        "scenario": replay.scenario.name,
        "policy": replay.policy,
        "seed": replay.seed,
        "completed": end.status == "completed",
        "status": end.status,
        "makespan": end.makespan,
        "makespan_seconds": _seconds(replay.scenario, end.makespan),
        "steps": end.steps,
        "tasks_done": end.tasks_done,
        "tasks": len(replay.scenario.tasks),
        "robots": len(replay.scenario.robots),
        "allocation": replay.scenario.allocation,
        "capabilities": len(replay.scenario.capabilities),
        "joins": end.joins,
        "splits": end.splits,
        "illegal_decisions": end.illegal_decisions,
        "blocked_tasks": list(end.blocked_tasks),
        "late": lateness(replay),
        "decision_seconds": round(trial.decision_seconds, 6),
        "total_seconds": round(trial.total_seconds, 6),
        "best_known": best_known,
        "lower_bound": replay.lower_bound,
        "percent_over_best": percent_over(end.makespan, best_known),
        "percent_over_bound": percent_over(end.makespan, replay.lower_bound),
        **_plan_row(trial.plan),
    }


def _write(replay: Replay, folder: Path, with_page: bool) -> None:
    write_replay(replay, folder / "replay.json")
    say(f"record: {folder / 'replay.json'}")
    if with_page:
        from teamformer.viewer.html import write_page

        write_page(replay_to_tree(replay), folder / "replay.html")
        say(f"page:   {folder / 'replay.html'}")


def _show(trial: Trial) -> None:
    replay, end = trial.replay, trial.replay.end
    scenario = replay.scenario
    title = (
        f"{scenario.name}: {replay.policy}, seed {replay.seed}, allocation {scenario.allocation}"
    )
    out.print(Text(title, style="bold"))
    if len(scenario.tasks) <= LONGEST_TABLE:
        out.print(_task_table(replay))
    out.print(_verdict(replay), style="green" if end.status == "completed" else "red")
    for task, steps in lateness(replay).items():
        out.print(f"late: {task} by {steps:g} steps", markup=False, style="red")
    if lost := _losses(replay):
        out.print(f"lost: {lost}", markup=False, style="red")
    if trial.plan is not None:
        out.print(_improvements(trial.plan))
        out.print(plan_line(trial.plan))
    out.print(
        f"{end.tasks_done} of {len(scenario.tasks)} tasks, {end.joins} joins, {end.splits} splits, "
        f"{end.illegal_decisions} illegal decisions; deciding took {trial.decision_seconds:.3f} s "
        f"of {trial.total_seconds:.3f} s"
    )


def _seconds(scenario: Scenario, steps: int | None) -> float | None:
    """Return how long steps take on a plane; None on grids, whose steps have no length."""
    if steps is None or not isinstance(scenario.world, Plane):
        return None
    return round(steps * scenario.world.step, 3)


def _verdict(replay: Replay) -> str:
    end = replay.end
    if end.makespan is not None:
        bound, seconds = replay.lower_bound, _seconds(replay.scenario, end.makespan)
        done = f"all done after {end.makespan} steps"
        if seconds is not None:
            done = f"{done}, {seconds:g} s"
        if not bound:
            return done
        ratio = 100 * (end.makespan / bound - 1)
        return f"{done}; no plan can take less than {bound} (+{ratio:.0f}%)"
    if end.status == "infeasible":
        return f"given up at step {end.steps}: {', '.join(end.blocked_tasks)} can never be done"
    if end.status == "interrupted":
        return f"interrupted at step {end.steps}; what was done so far is recorded"
    return f"not done within the limit of {end.steps} steps"


def _task_table(replay: Replay) -> Table:
    """Return who did what when, in the order it was done."""
    scenario = replay.mission
    table = Table(box=None, header_style="dim")
    for header in ("step", "task", "needs", "done by"):
        table.add_column(header, overflow="fold")
    undone = set(range(len(scenario.tasks)))
    for step, task, robots in completions(replay):
        undone.discard(task)
        needs = describe(scenario.tasks[task].needs)
        names = _names(scenario, robots)
        table.add_row(str(step), Text(scenario.tasks[task].name), Text(needs), Text(names))
    for task in sorted(undone):
        needs = describe(scenario.tasks[task].needs)
        table.add_row("-", Text(scenario.tasks[task].name), Text(needs), "")
    return table


def _losses(replay: Replay) -> str:
    """Name the robots that were lost, with their steps; the first ones of many."""
    lost: list[str] = []
    latest: dict[int, int] = {}  # the entry in the list of each robot that is lost
    for number, step in enumerate(replay.steps, start=1):
        for robot in step.back:
            lost[latest[robot]] += f" (back in {number})"
        for robot in step.lost:
            latest[robot] = len(lost)
            lost.append(f"{replay.scenario.robots[robot].name} in step {number}")
    more = [f"{len(lost) - MOST_NAMES} more"] if len(lost) > MOST_NAMES else []
    return ", ".join(lost[:MOST_NAMES] + more)


def _names(scenario: Scenario, robots: Sequence[int]) -> str:
    """Return the robots' names, the first ones of many."""
    shown = robots if len(robots) <= MOST_NAMES else robots[: MOST_NAMES - 1]
    names = ", ".join(scenario.robots[robot].name for robot in shown)
    return names if shown is robots else f"{names} and {len(robots) - len(shown)} more"


def completions(replay: Replay) -> list[tuple[int, int, tuple[int, ...]]]:
    """Return (step, task, robots) of every task done, from the record alone."""
    members = {slot: set(robots) for slot, robots, _, _ in replay.start}
    found: list[tuple[int, int, tuple[int, ...]]] = []
    for number, step in enumerate(replay.steps, start=1):
        for stay, leave in step.splits:
            members.pop(min(*stay, *leave))
            members[min(stay)], members[min(leave)] = set(stay), set(leave)
        for joiner, partner in step.joins:
            members[min(joiner, partner)] = members.pop(joiner) | members.pop(partner)
        lost = set(step.lost)
        if lost:
            left = defaultdict(set, {min(m - lost): m - lost for m in members.values() if m - lost})
            members = dict(left)
        for robot in step.back:
            members[robot] = {robot}
        found += [(number, task, tuple(sorted(members[slot]))) for task, slot in step.done]
    return found

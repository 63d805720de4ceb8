"""Who did what and when, as each output of a mission tells it: read out of each in its own way."""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from operator import add
from pathlib import Path
from typing import Any, NamedTuple

Tree = Mapping[str, Any]


class Line(NamedTuple):
    """Something that happened: who, by names in the order of their numbers, and to which task."""

    step: int
    kind: str  # done, appears, cancelled, lost or back
    robots: str
    task: str


class Bar(NamedTuple):
    """What a robot did between the ends of two steps, and for which task."""

    robot: str
    phase: str
    task: str
    begun: int
    ended: int


def told_by_record(tree: Tree) -> list[Line]:
    """Go through a record, given as its JSON."""
    names = [robot["name"] for robot in tree["mission"]["robots"]]
    tasks = [*tree["mission"]["tasks"], *(tree.get("truth") or {}).get("arrivals", ())]
    members = {slot: set(robots) for slot, robots, *_ in tree["start"]}
    lines, ends = [], dict[str, int]()
    for number, step in enumerate(tree["steps"], start=1):
        for stay, leave in step.get("splits", ()):
            members.pop(min(stay + leave))
            members |= {min(stay): set(stay), min(leave): set(leave)}
        for one, other in step.get("joins", ()):
            members[min(one, other)] = members.pop(one) | members.pop(other)
        for robot in step.get("lost", ()):
            mates = next(mates for mates in members.values() if robot in mates)
            members.pop(min(mates))
            mates.remove(robot)
            if mates:
                members[min(mates)] = mates
            lines.append(Line(number, "lost", names[robot], ""))
        for robot in step.get("back", ()):
            members[robot] = {robot}
            lines.append(Line(number, "back", names[robot], ""))
        for task, slot in step.get("done", ()):
            who = ", ".join(names[robot] for robot in sorted(members[slot]))
            lines.append(Line(number, "done", who, tasks[task]["name"]))
            ends[tasks[task]["name"]] = number
    for task in tasks:
        cancelled = task.get("cancelled", math.inf)
        if cancelled <= len(tree["steps"]) and task["name"] not in ends:
            lines.append(Line(cancelled, "cancelled", "", task["name"]))
            ends[task["name"]] = cancelled
    for task in tasks:
        appears = task.get("appears", 0)
        if 0 < appears <= len(tree["steps"]) and appears < task.get("cancelled", math.inf):
            lines.append(Line(int(appears), "appears", "", task["name"]))
    return sorted(lines)


def told_by_events(folder: Path) -> list[Line]:
    """Read `events.csv`."""
    rows = _rows(folder / "events.csv")
    kinds = ("done", "appears", "cancelled", "lost", "back")
    told = [Line(int(row[0]), row[2], row[3], row[4]) for row in rows if row[2] in kinds]
    return sorted(told)


def told_by_tables(folder: Path, steps: int) -> list[Line]:
    """Read `tasks.csv` and `robots.csv`."""
    lines = []
    for name, *_, appears, cancelled, _, done, _, who in _rows(folder / "tasks.csv"):
        if done:
            lines.append(Line(int(done), "done", who, name))
        if cancelled:
            lines.append(Line(int(cancelled), "cancelled", "", name))
        if appears and 0 < int(appears) <= steps:
            lines.append(Line(int(appears), "appears", "", name))
    for name, _, _, _, _, _, lost, back, *_ in _rows(folder / "robots.csv"):
        lines += [Line(int(step), "lost", name, "") for step in lost.split("; ") if step]
        lines += [Line(int(step), "back", name, "") for step in back.split("; ") if step]
    return sorted(lines)


def bars_of(folder: Path) -> list[Bar]:
    """Read `gantt.csv`."""
    rows = _rows(folder / "gantt.csv")
    return [Bar(*row[:3], int(row[3]), int(row[4])) for row in rows]


def end_of(folder: Path) -> str:
    """Return how the trial ended, by the last row of `events.csv`."""
    return _rows(folder / "events.csv")[-1][2]


def needs_in(folder: Path) -> dict[str, str]:
    """Return what tasks need, by `tasks.csv`, without what keeps names harmless."""
    rows = _rows(folder / "tasks.csv")
    return {row[0].removeprefix("'"): row[1].removeprefix("'") for row in rows}


def sorted_needs(needs: Mapping[str, str]) -> dict[str, list[str]]:
    """Return what tasks need; in which order is nothing that anybody is told."""
    return {task: sorted(text.split(", ")) for task, text in needs.items()}


def needs_told_by_record(tree: Tree) -> dict[str, str]:
    """Return what tasks really needed, in words."""
    truth = tree.get("truth") or {}
    needs = {}
    for task in [*tree["mission"]["tasks"], *truth.get("arrivals", ())]:
        known = truth.get("tasks", {}).get(task["name"], {}).get("needs", task["needs"])
        counts = known if isinstance(known, dict) else Counter(known)
        parts = [cap if n == 1 else f"{n} x {cap}" for cap, n in counts.items()]
        needs[task["name"]] = ", ".join(parts)
    return needs


def harmless(text: str) -> str:
    """Return a name as a table has it, where none may be taken for a formula."""
    return f"'{text}" if text[:1] in ("=", "+", "-", "@", "'") else text


def in_tables(lines: Iterable[Line]) -> list[Line]:
    """Return lines as tables have them."""
    return sorted(Line(it.step, it.kind, harmless(it.robots), harmless(it.task)) for it in lines)


def _rows(path: Path) -> list[list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.reader(file))[1:]


def sentence(line: Line) -> str:
    """Return what a log says of a line."""
    match line.kind:
        case "done":
            return f"{line.task} done by {line.robots}"
        case "appears":
            return f"{line.task} appears"
        case "cancelled":
            return f"{line.task} called off"
        case kind:
            return f"{line.robots} {kind}"


def logged(folder: Path) -> Counter[tuple[int, str]]:
    """Return the sentences of `events.csv`, with their nanoseconds."""
    rows = _rows(folder / "events.csv")
    return Counter((round(float(row[1]) * 1e9), row[5]) for row in rows)


class Seen(NamedTuple):
    """What a MCAP file tells: its log, who is there at each time, and what tasks need."""

    log: Counter[tuple[int, str]]
    there: dict[int, set[str]]
    needs: dict[str, str]


def told_by_mcap(path: Path) -> Seen:
    """Read a file by the schemas that it brings."""
    from google.protobuf.descriptor_pb2 import FileDescriptorSet
    from google.protobuf.descriptor_pool import DescriptorPool
    from google.protobuf.message_factory import GetMessageClass
    from mcap.reader import make_reader

    classes: dict[str, Any] = {}
    seen = Seen(Counter(), {}, {})
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            if schema.name not in classes:
                pool = DescriptorPool()
                for part in FileDescriptorSet.FromString(schema.data).file:
                    pool.Add(part)
                classes[schema.name] = GetMessageClass(pool.FindMessageTypeByName(schema.name))
            body = classes[schema.name].FromString(message.data)
            if channel.topic == "/log":
                seen.log[(message.log_time, body.message)] += 1
            elif channel.topic == "/tf":
                names = {it.child_frame_id.removeprefix("robot/") for it in body.transforms}
                seen.there[message.log_time] = names
            elif channel.topic == "/mission":
                for entity in body.entities:
                    for pair in entity.metadata:
                        if pair.key == "needs":
                            seen.needs[entity.id.removeprefix("task/")] = pair.value
    return seen


def told_by_terminal(text: str) -> tuple[list[str], str, str]:
    """Return what `run` printed: the lines of its table, its verdict, and whom it calls lost.

    White space is what it is in between columns. Of many tasks there is no table.
    """
    lines = [" ".join(line.split()) for line in text.splitlines()]
    ends = ("all done", "given up", "interrupted", "not done within")
    at = next(n for n, line in enumerate(lines) if n and line.startswith(ends))
    lost = next((line for line in lines[at:] if line.startswith("lost: ")), "")
    return lines[2:at], lines[at], lost


def table_of(lines: Iterable[Line], needs: Mapping[str, str]) -> list[str]:
    """Return the lines that the terminal's table is to have."""
    lines, undone = list(lines), dict(needs)
    gone = {line.task: line.step for line in lines if line.kind == "cancelled"}
    rows = []
    for line in lines:
        if line.kind == "done":
            needed = undone.pop(line.task)
            rows.append(f"{line.step} {line.task} {needed} {line.robots}")
    for name, needed in undone.items():
        why = f"called off in step {gone[name]}" if name in gone else ""
        rows.append(f"- {name} {needed} {why}")
    return sorted(" ".join(row.split()) for row in rows)


def losses_of(tree: Tree) -> str:
    """Return what the terminal is to say of robots that were lost."""
    names = [robot["name"] for robot in tree["mission"]["robots"]]
    lost: list[str] = []
    latest = {}
    for number, step in enumerate(tree["steps"], start=1):
        for robot in step.get("back", ()):
            lost[latest[robot]] += f" (back in {number})"
        for robot in step.get("lost", ()):
            latest[robot] = len(lost)
            lost.append(f"{names[robot]} in step {number}")
    shown = lost if len(lost) <= 12 else [*lost[:12], f"{len(lost) - 12} more"]
    return " ".join(f"lost: {', '.join(shown)}".split()) if lost else ""


def embedded(page: Path) -> Any:
    """Return the record that a page holds."""
    text = page.read_text(encoding="utf-8")
    begin = text.index(HOLDS) + len(HOLDS)
    return json.loads(text[begin : text.index("</script>", begin)])


HOLDS = '<script type="application/json" id="record">'


def captions_agree(path: Path, tree: Tree, lines: Sequence[Line]) -> bool:
    """Say whether each frame of a GIF has the caption of its step, and of no other.

    Of a long mission every second step has a frame, or fewer have, and the last one. A frame is
    looked at beside captions with a step, a task or a lost robot more or less; of many frames at
    some, the last among them.
    """
    from PIL import Image, ImageChops, ImageSequence, ImageStat

    tasks = len(tree["mission"]["tasks"]) + len((tree.get("truth") or {}).get("arrivals", ()))
    pictures, begin = dict[int, Any](), 0  # by the milliseconds from which they are shown
    with Image.open(path) as gif:
        for frame in ImageSequence.Iterator(gif):
            pictures[begin] = frame.convert("L")
            begin += int(frame.info["duration"])
    last = len(tree["steps"])
    shown = [*range(0, last, 1 + last // MOST_FRAMES), last]
    if begin != STEP_MS * (len(shown) - 1) + LAST_MS:
        return False
    frames = [pictures[STEP_MS * number] for number in range(len(shown))]
    stride = 1 + len(frames) // MOST_CAPTIONS
    for number, frame in list(zip(shown, frames, strict=True))[::-stride]:
        counts = Counter(line.kind for line in lines if line.step <= number)
        it = (number, counts["done"], counts["lost"] - counts["back"])
        gone = counts["cancelled"]
        strip = frame.crop((0, frame.height - 24, frame.width, frame.height))
        others = [tuple(map(add, it, by)) for by in BESIDE]

        def distance(said: tuple[int, ...], strip: Any = strip, gone: int = gone) -> float:
            drawn = _strip(strip.size, tree, tasks, gone, *said)
            return float(ImageStat.Stat(ImageChops.difference(strip, drawn)).sum[0])

        if distance(it) >= min(map(distance, others)):
            return False
    return True


MOST_CAPTIONS, MOST_FRAMES = 40, 500

STEP_MS, LAST_MS = 150, 2500
"""How long a step is shown, and the last one."""

BESIDE = ((-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1))
"""By how much captions differ in steps, tasks done and robots lost from the one beside them."""


def _strip(
    size: tuple[int, int], tree: Tree, tasks: int, gone: int, step: int, done: int, lost: int
) -> Any:
    """Return a picture of a caption."""
    from PIL import Image, ImageDraw, ImageFont

    plane = tree["mission"]["world"].get("plane")
    when = f"step {step}"
    if plane:
        when = f"{step * tree['mission']['world'].get('step', 1):g} s"
    robots = f", {lost} robot{'s' if lost != 1 else ''} lost" if lost else ""
    name = (tree["mission"].get("name") or "unnamed mission")[:40]
    picture = Image.new("L", size, 255)
    pen = ImageDraw.Draw(picture)
    called_off = f", {gone} called off" if gone else ""
    text = f"{when}, {done} of {tasks} tasks done{called_off}{robots}: {name}"
    pen.text((12, 0), text, 35, ImageFont.load_default(14))
    return picture


TOLD_BY_PAGE = """(tree) => {
  const history = frames(tree);
  const { mission, events, end } = history;
  const lines = toldOf(history);
  const bars = mission.robots.flatMap(({ name }, robot) =>
    runsOf(history, robot).map(({ phase, task, from, to }) => [
      name, phase, task < 0 ? "" : mission.tasks[task].name, from, to,
    ]),
  );
  const stories = mission.robots.map((_, robot) =>
    robotStory(history, robot).filter(({ kind }) => kind === "done")
      .map(({ step, task }) => [step, mission.tasks[task].name]).sort());
  const marks = deedsOfRobots(history).map((deeds) =>
    deeds.map(({ step, task }) => [step, mission.tasks[task].name]).sort());
  const said = events.filter(({ kind }) => kind === "done")
    .map((event) => describeEvent(history, event));
  const needs = mission.tasks.map((task) => [task.name, describeCounts(mission, task.needs)]);
  const done = countDone(history, history.last);
  const half = Math.floor(history.last / 2);
  const app = { history, player: { step: half }, scene: () => sceneAt(history, half) };
  const moment = momentOf(app);
  const tasks = mission.tasks.map(({ name }, task) =>
    [name, endOfTask(moment, task)?.at ?? 0, stateOfTask(moment, task) === "done"]);
  for (const robot of mission.robots.keys()) for (const { of } of ROBOT_COLUMNS) of(moment, robot);
  for (const task of mission.tasks.keys()) for (const { of } of TASK_COLUMNS) of(moment, task);
  const idle = mission.robots.map(({ name }, robot) =>
    [name, stepsInPhases(history, robot, half).get(IDLE)]);
  const halfway = { step: half, tasks, idle };
  const curves = curvesOf(history);
  return { lines, bars, stories, marks, said, needs, halfway, curves,
    end: [end.status, end.makespan, done] };
}"""


def lines_of_plan(row: Tree, ends_home: bool) -> list[str]:
    """Return the lines of the terminal's table, by what `plan --json` says."""
    lines = []
    for route in row["routes"]:
        stops = [f"{it['task']} {it['start']:.6g}-{it['end']:.6g}" for it in route["stops"]]
        back = f"{route['back']:g}" if ends_home else ""
        lines.append(f"{route['robot']} {', '.join(stops) or '-'} {back}")
    return [" ".join(line.split()) for line in lines]

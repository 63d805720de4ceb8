// For tests and the curious: look, do not touch.

import { ringColour, taskColour } from "./draw/palette.js";
import { robotSpot } from "./draw/shapes.js";
import { needsThatFit, taskBox } from "./draw/tasks.js";
import { shownMoment } from "./panel/playback.js";
import { curvesOf } from "./record/over_time.js";
import { NOBODY } from "./record/state.js";
import { describeDoing, robotName, taskName } from "./record/words.js";
import { ROBOT_COLUMNS, TASK_COLUMNS, momentOf } from "./views/columns.js";

export function lookInto(/** @type {App} */ app) {
  return Object.freeze({
    get step() {
      return app.player.step;
    },
    get moment() {
      return app.history.isContinuous ? shownMoment(app, app.player.step) : String(app.player.step);
    },
    get last() {
      return app.history.last;
    },
    get isPlaying() {
      return app.player.isPlaying;
    },
    teams: () =>
      [...app.scene().teams.values()].map((team) => ({
        slot: team.slot,
        robots: [...team.robots],
        place: [team.x, team.y],
        task: team.assigned === NOBODY ? null : team.assigned,
        ring: ringColour(team, app.map.isDark),
        doing: describeDoing(app.history, team, app.player.step),
      })),
    taskColour: (task) => taskColour(task, app.map.isDark),
    robotSpot: (robot) => robotSpot(app.map.shown, robot),
    needs: (task) => needsThatFit(app.map.shown, task, taskBox(app.map.shown, task).half)?.lines,
    taskBox: (task) => taskBox(app.map.shown, task),
    pixelOf: (x, y) => ({ x: app.map.shown.camera.x(x), y: app.map.shown.camera.y(y) }),
    detail: () => app.map.shown.detail,
    legend: () => app.map.shown.legend.map(({ text, x, y }) => ({ text, x, y })),
    names: () => app.map.shown.names.map(({ text, x, y, half }) => ({ text, x, y, half })),
    groups: () => app.map.shown.groups.map(({ x, y, count }) => ({ x, y, count })),
    told: () => toldOf(app.history),
    tables: () => tablesOf(app),
    incidents: () => /** @type {any} */ (app).state.incidents,
    criticalPath: () => app.history.told.path,
    bars: (robot) => ganttRow(app, robot),
    curves: () => curvesOf(app.history),
    lineOf: (step, part) => ({ x: app.compared.curves.x(step), y: app.compared.curves.y(part) }),
    robotSpotBeside: (number, robot) => robotSpot(app.companions[number].map.shown, robot),
    barsBeside: (number, robot) => ganttRow(app.companions[number], robot),
    besideSteps: () => app.companions.map((companion) => companion.scene().step),
    framesDrawn: () => app.map.frames,
  });
}

// A robot's row of the Gantt view, once that has been drawn: bars, with what they are about, and marks.
function ganttRow(/** @type {Shown} */ { gantt, history }, robot) {
  const nameOf = (task) => (task === NOBODY ? "" : taskName(history.mission, task));
  const place = (step) => gantt.x(step);
  return {
    bars: gantt.runsOf(robot).map(({ phase, task, from, to }) => ({
      ...{ phase, task: nameOf(task), from, to },
      ...{ left: place(from), right: place(to) },
    })),
    marks: (gantt.deeds?.[robot] ?? []).map(({ task, step }) => ({ task: nameOf(task), step })),
    rowHeight: gantt.rowHeight(),
  };
}

// What the tables say of the moment that is shown: a row for each task and each robot, by column.
function tablesOf(/** @type {App} */ app) {
  const moment = momentOf(app);
  const { tasks, robots } = app.history.mission;
  const rowsOf = (things, columns) =>
    things.map((_, number) => Object.fromEntries(columns.map(({ name, of }) => [name, of(moment, number).text])));
  return { tasks: rowsOf(tasks, TASK_COLUMNS), robots: rowsOf(robots, ROBOT_COLUMNS) };
}

// Who did what and when: [step, what, the robots' names, the task's name].
function toldOf(/** @type {TrialHistory} */ { mission, doneAt, doers, events }) {
  const namesOf = (robots) => robots.map((robot) => robotName(mission, robot)).join(", ");
  const lines = [];
  doers.forEach((robots, task) => {
    if (doneAt[task] < Infinity) {
      lines.push([doneAt[task], "done", namesOf(robots), taskName(mission, task)]);
    }
  });
  for (const { step, kind, robots, task } of events) {
    if (kind === "appears" || kind === "cancelled") lines.push([step, kind, "", taskName(mission, task)]);
    if (kind === "lost" || kind === "back") lines.push([step, kind, namesOf([robots[0]]), ""]);
  }
  return lines;
}

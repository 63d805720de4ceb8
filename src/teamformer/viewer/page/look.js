// For tests and the curious: look, do not touch.

function lookInto(app) {
  return Object.freeze({
    get step() {
      return app.player.step;
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
        doing: describeDoing(app.history.scenario, team, app.player.step),
      })),
    taskColour: (task) => taskColour(task, app.map.isDark),
    robotSpot: (robot) => robotSpot(app.map.shown, robot),
    taskBox: (task) => taskBox(app.map.shown, task),
    pixelOf: (x, y) => ({ x: app.map.shown.camera.x(x), y: app.map.shown.camera.y(y) }),
    detail: () => app.map.shown.detail,
    groups: () => app.map.shown.groups.map(({ x, y, count }) => ({ x, y, count })),
    besideStep: () => app.companion.scene().step,
    framesDrawn: () => app.map.frames,
  });
}

// Opens the page of a live mission: once the server has told how it stands.

let app = null;
const server = new Link(hearServer, (isOpen) => {
  if (!app) return;
  app.isCutOff = !isOpen;
  app.panel.show();
});

function hearServer(message) {
  if (message.kind === "begun") return location.reload(); // the editor's mission runs
  if (app) return app.hear(message);
  if (message.kind === "mission") app = new LiveApp(message.record, server);
  else if (message.kind === "editor") app = new EditorApp(message.scenario, server);
  else return;
  app.start();
  app.hear(message);
  window.teamformer = lookInto(app);
}

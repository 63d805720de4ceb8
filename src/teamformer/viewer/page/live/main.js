// Opens the page of a live mission: once the server has told how it stands.

let app = null;
const server = new Link(hearServer, (isOpen) => {
  if (!app) return;
  app.isCutOff = !isOpen;
  app.panel.show();
});

function hearServer(message) {
  if (app) return app.hear(message);
  if (message.kind !== "mission") return;
  app = new LiveApp(message.record, server);
  app.start();
  app.hear(message);
  window.teamformer = lookInto(app);
}

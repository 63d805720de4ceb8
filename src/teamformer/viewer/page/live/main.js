// Opens the page of a live mission: once the server has told how it stands.

// What each first word of the server makes of the page.
const APPS = {
  mission: (message) => new LiveApp(message.record, server),
  editor: (message) => new EditorApp(message, server),
  starting: (message) => new StartingApp(message.scenario),
};

let app = null;
let opening = null; // the word that the page was opened by
const server = new Link(hearServer, (isOpen) => {
  if (!app) return;
  app.isCutOff = !isOpen;
  app.isBehind ||= !isOpen;
  app.panel?.show?.();
});

function hearServer(message) {
  const { kind } = message;
  if (kind === "begun") return location.reload(); // there is another mission, or a drawing
  if (app) return isOther(kind) ? location.reload() : app.hear(message);
  if (!APPS[kind]) return;
  opening = kind;
  app = APPS[kind](message);
  app.start();
  document.title = `${app.history.scenario.name}, live`;
  app.hear(message);
  window.teamformer = lookInto(app);
}

// While the line was down, the server has gone on to something else.
function isOther(kind) {
  return kind in APPS && kind !== opening && !(kind === "starting" && opening === "editor");
}

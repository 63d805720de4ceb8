// Opens the page of a record.

const app = new App(JSON.parse(byId("replay").textContent));
app.start();
window.teamformer = lookInto(app);

// Records that are opened or dropped, and what is saved: pictures, videos, downloads.

import { titleOf } from "../compared/titles.js";
import { penOf } from "../draw/shapes.js";
import { tryReading } from "../record/checking.js";
import { describeAt } from "../record/words.js";
import { byId, element } from "./dom.js";
import { notify, notifyWork } from "./notice.js";
import { download, fileName } from "./saving.js";
import { messageOf } from "./attempt.js";

const LARGEST_RECORD = 512_000_000; // bytes

export function connectFiles(/** @type {App} */ app) {
  byId("open").addEventListener("click", () => askForRecord(app, false));
  byId("open-beside").addEventListener("click", () => askForRecord(app, true));
  byId("save-picture").addEventListener("click", () => savePicture(app));
  byId("save-video").addEventListener("click", () => toggleVideo(app));
  byId("downloads").replaceChildren(...app.downloads());
  addEventListener("dragover", (event) => {
    event.preventDefault();
    byId("drop").hidden = false;
    byId("drop-beside").classList.toggle("aimed", isOverRight(event));
    byId("drop-instead").classList.toggle("aimed", !isOverRight(event));
  });
  addEventListener("dragleave", (event) => {
    if (!event.relatedTarget) byId("drop").hidden = true;
  });
  addEventListener("drop", (event) => {
    event.preventDefault();
    byId("drop").hidden = true;
    const files = [...(event.dataTransfer?.files ?? [])];
    if (files.length) app.openFiles(files, isOverRight(event));
  });
}

function isOverRight(/** @type {DragEvent} */ { clientX }) {
  return clientX > innerWidth / 2;
}

function askForRecord(/** @type {App} */ app, isBeside) {
  byId("menu").open = false;
  const input = element("input", { type: "file", accept: ".json,application/json" });
  input.addEventListener("change", () => app.openFiles([...(input.files ?? [])], isBeside));
  input.click();
}

export async function openRecordFile(/** @type {App} */ app, file, isBeside) {
  try {
    if (file.size > LARGEST_RECORD) throw new Error("it is larger than 512 MB");
    notifyWork(`Reading ${file.name} …`);
    const record = readRecord(await file.text());
    if (isBeside) app.putBeside([record]);
    else app.open(record);
  } catch (error) {
    notify(`${file.name} is not shown: ${messageOf(error)}.`);
  }
}

// The record in a text; an Error says what is wrong with it.
function readRecord(text) {
  let record;
  try {
    record = JSON.parse(text);
  } catch {
    throw new Error("it is not JSON; drop a record.json that `teamformer run --out` wrote");
  }
  if (record?.teamformer_replay !== undefined) {
    throw new Error("it is a record of an earlier teamformer; run the mission again");
  }
  if (record?.teamformer_record === undefined) {
    throw new Error("it is no record of a trial; drop a record.json that `teamformer run --out` wrote");
  }
  if (record.teamformer_record !== KNOWN_FORMAT) {
    const remedy = record.teamformer_record < KNOWN_FORMAT ? "; run the mission again" : "";
    throw new Error(`it has format ${record.teamformer_record}, and this page knows ${KNOWN_FORMAT}${remedy}`);
  }
  try {
    tryReading(record);
  } catch (error) {
    throw new Error(`it is damaged (${messageOf(error)})`);
  }
  return record;
}

const KNOWN_FORMAT = 3;

// What is drawn as it is seen, one canvas for each record, with a line that says what it is.
function savePicture(/** @type {App} */ app) {
  byId("menu").open = false;
  const shown = app.drawings();
  const sharpness = window.devicePixelRatio || 1;
  const boxes = shown.map(({ canvas }) => canvas.getBoundingClientRect());
  const [left, top] = [Math.min(...boxes.map((box) => box.left)), Math.min(...boxes.map((box) => box.top))];
  const canvas = document.createElement("canvas");
  canvas.width = Math.round((Math.max(...boxes.map((box) => box.right)) - left) * sharpness);
  canvas.height = Math.round((Math.max(...boxes.map((box) => box.bottom)) - top + 34) * sharpness);
  const ctx = penOf(canvas);
  ctx.fillStyle = app.map.theme.surface;
  ctx.fillRect(0, 0, canvas.width, canvas.height);
  ctx.scale(sharpness, sharpness);
  shown.forEach((drawn, number) => {
    const { x, y, width, height } = boxes[number];
    ctx.drawImage(drawn.canvas, x - left, y - top + 34, width, height);
    if (shown.length === 1) return;
    ctx.font = `600 13px ${app.map.theme.font}`;
    ctx.fillStyle = app.map.theme.ink;
    ctx.fillText(titleOf(app.trials, drawn.app.trial), x - left + 12, y - top + 34 + height - 10);
  });
  ctx.font = `600 14px ${app.map.theme.font}`;
  ctx.fillStyle = app.map.theme.ink;
  ctx.textBaseline = "middle";
  const { mission, record } = app.history;
  const moment = describeAt(mission.world, app.player.step);
  const method = shown.length === 1 ? record.method : "";
  ctx.fillText([mission.name, method, moment].filter(Boolean).join(", "), 12, 18);
  canvas.toBlob((blob) => download(blob, `${fileName(mission.name)}-${app.player.step}.png`));
}

// The page as it came, with room for a record: what a page that is saved can do by itself.
const [PAGE_BEFORE, PAGE_AFTER] = emptyPage();

function emptyPage() {
  const holder = byId("record");
  const record = holder.textContent;
  holder.textContent = "\u0000";
  const page = `<!doctype html>\n${document.documentElement.outerHTML}\n`;
  holder.textContent = record;
  return page.split("\u0000");
}

// What a page makes by itself: mission and record, those in front, and itself with all records.
export function ownDownloads(/** @type {App} */ app) {
  const name = () => fileName(app.history.mission.name);
  const json = (tree) => new Blob([`${JSON.stringify(tree, null, 1)}\n`], { type: "application/json" });
  const page = () => new Blob([PAGE_BEFORE, harmlessJson(shownRecords(app)), PAGE_AFTER], { type: "text/html" });
  return [
    downloadButton("Mission (JSON)", () => download(json(app.record.mission), `${name()}.json`)),
    downloadButton("Record (JSON)", () => download(json(app.record), `${name()}-record.json`)),
    downloadButton("This page (HTML)", () => download(page(), `${name()}.html`)),
    element("p", {}, "CSV: beside each table. MCAP, GIF and all tables: ", element("code", {}, "teamformer export")),
  ];
}

// What a page is opened with: a record, or several with the trials that left none.
function shownRecords(/** @type {App} */ { trials, failed }) {
  const records = trials.map(({ record }) => record);
  return records.length + failed.length > 1 ? { compared: records, failed } : records[0];
}

// As `_json_for_html` writes it: no HTML reader takes it for markup.
function harmlessJson(tree) {
  const escapes = { "&": "\\u0026", "<": "\\u003c", ">": "\\u003e" };
  return JSON.stringify(tree).replace(/[&<>]/g, (letter) => escapes[letter]);
}

export function downloadButton(text, make) {
  const on = () => {
    byId("menu").open = false;
    make();
  };
  return element("button", { type: "button", on }, text);
}

const FRAMES_A_SECOND = 30;
const LAST_FRAME_STAYS = 500; // milliseconds

// Play from here (from the start, at the end) to the end, and save it as WebM; again: stop there.
function toggleVideo(/** @type {App} */ app) {
  byId("menu").open = false;
  if (app.recorder) return app.recorder.stop();
  if (!window.MediaRecorder) return notify("This browser records no video; save pictures instead.");
  app.look("map");
  if (app.player.time >= app.player.last) app.player.go(0);
  const parts = /** @type {Blob[]} */ ([]);
  const recorder = new MediaRecorder(app.map.canvas.captureStream(FRAMES_A_SECOND), {
    mimeType: "video/webm",
  });
  recorder.ondataavailable = ({ data }) => parts.push(data);
  recorder.onstop = () => {
    app.recorder = null;
    app.player.pause();
    byId("save-video").textContent = "Record a video";
    const name = `${fileName(app.history.mission.name)}.webm`;
    download(new Blob(parts, { type: "video/webm" }), name);
  };
  app.recorder = recorder;
  byId("save-video").textContent = "Stop recording";
  recorder.start();
  app.player.play();
  stopAtEnd(app, recorder);
}

function stopAtEnd(/** @type {App} */ app, recorder) {
  if (recorder.state !== "recording") return;
  if (app.player.isPlaying) requestAnimationFrame(() => stopAtEnd(app, recorder));
  else setTimeout(() => recorder.state === "recording" && recorder.stop(), LAST_FRAME_STAYS);
}

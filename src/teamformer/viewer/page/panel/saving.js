// Files that a page saves: tables as CSV, under names that file systems take.

import { element } from "./dom.js";

export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

export function fileName(name) {
  return name.replace(/[^\p{L}\p{N}-]+/gu, "-").slice(0, 60) || "mission";
}

// Rows of texts and numbers as a file for spreadsheets.
export function csvOf(rows) {
  const text = rows.map((row) => row.map((cell) => csvField(String(cell))).join(",")).join("\r\n");
  return new Blob([`${text}\r\n`], { type: "text/csv" });
}

// An apostrophe keeps spreadsheets from taking a name for a formula, as in the tables of `export`.
function csvField(text) {
  const harmless = /^[=+\-@']/.test(text) ? `'${text}` : text;
  return /[",\r\n]/.test(harmless) ? `"${harmless.replaceAll('"', '""')}"` : harmless;
}

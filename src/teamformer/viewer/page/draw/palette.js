// Colours and short labels. Discs have their own, few and colour-blind-aware; rings of teams are
// muted and tasks are vivid, so that a ring that takes its task's colour is seen to change.

import { NOBODY } from "../record/state.js";

export const GOLDEN_ANGLE = 137.508;

// After Okabe and Ito's palette, which stays apart for the common kinds of colour blindness.
const FEW_COLOURS = [
  { fill: "#e69f00", ink: "#201600" },
  { fill: "#56b4e9", ink: "#06202f" },
  { fill: "#00936b", ink: "#ffffff" },
  { fill: "#d174a8", ink: "#2b0a1c" },
  { fill: "#0a6cb0", ink: "#ffffff" },
  { fill: "#f0e442", ink: "#2a2700" },
  { fill: "#d05a00", ink: "#ffffff" },
  { fill: "#8b93a0", ink: "#0d1116" },
];

export function capabilityColours(count) {
  if (count <= FEW_COLOURS.length) return FEW_COLOURS.slice(0, count);
  return Array.from({ length: count }, (_, cap) => {
    const lightness = [0.72, 0.62, 0.82][cap % 3];
    return { fill: oklch(lightness, 0.14, cap * GOLDEN_ANGLE), ink: "#10151c" };
  });
}

function teamColour(slot, isDark) {
  return oklch(isDark ? 0.74 : 0.5, 0.105, 265 + slot * GOLDEN_ANGLE);
}

export function taskColour(task, isDark) {
  return oklch(isDark ? 0.7 : 0.58, 0.2, 15 + task * GOLDEN_ANGLE);
}

export function oklch(lightness, chroma, hue) {
  return `oklch(${lightness} ${chroma} ${(hue % 360).toFixed(1)})`;
}

export const RINGS = { team: "Teams", coalition: "Coalitions" };

// The colour of a team's outer ring. Of teams, its own, or its task's once it brings all that is
// needed; of coalitions, that of the task that several teams may head for.
export function ringColour(/** @type {Team} */ team, isDark, rings = "team") {
  if (rings === "coalition") {
    return team.goal === NOBODY ? idleColour(isDark) : taskColour(team.goal, isDark);
  }
  return team.isMet ? taskColour(team.goal, isDark) : teamColour(team.slot, isDark);
}

function idleColour(isDark) {
  return oklch(isDark ? 0.6 : 0.65, 0, 0);
}

// One to three letters for each name, all different; the number for names such as `skill-17`.
export function shortLabels(names) {
  const numbers = names.map((name) => /^\D*(\d{1,3})$/.exec(name)?.[1]);
  if (names.length > 1 && new Set(numbers).size === names.length && !numbers.includes(undefined)) {
    return numbers;
  }
  const used = new Set();
  return names.map((name, index) => {
    const free = candidateLabels(name).find((label) => !used.has(label)) ?? String(index + 1);
    used.add(free);
    return free;
  });
}

function candidateLabels(name) {
  const letters = [...name].filter((letter) => /[\p{L}\p{N}]/u.test(letter));
  if (!letters.length) return [];
  const first = letters[0].toUpperCase();
  return [first, ...letters.slice(1).map((letter) => first + letter.toLowerCase())];
}

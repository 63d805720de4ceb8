// How robots and teams that are in one cell are laid out side by side. One robot has radius 1.

import { rememberLast } from "../record/keeping.js";

const SPACING = 2.16; // between the middles of two robots of one team
export const TEAM_MARGIN = 0.42; // around the robots of a team

export const robotSites = rememberLast(Infinity, (count) => (count <= 6 ? ringSites(count) : hexagonSites(count)));

// Two side by side, three in a triangle, four in a square, and so on up to six.
function ringSites(count) {
  if (count === 1) return [{ x: 0, y: 0 }];
  const radius = SPACING / 2 / Math.sin(Math.PI / count);
  const turn = { 2: 0, 4: Math.PI / 4 }[count] ?? -Math.PI / 2;
  return Array.from({ length: count }, (_, index) => {
    const angle = turn + (index * 2 * Math.PI) / count;
    return { x: radius * Math.cos(angle), y: radius * Math.sin(angle) };
  });
}

// The sites of a hexagonal lattice that are nearest to its middle.
function hexagonSites(count) {
  const reach = Math.ceil(Math.sqrt(count / 2.5)) + 1;
  const sites = [];
  for (let row = -reach; row <= reach; row++) {
    for (let column = -reach; column <= reach; column++) {
      const x = (column + (row & 1) / 2) * SPACING;
      sites.push({ x, y: (row * SPACING * Math.sqrt(3)) / 2 });
    }
  }
  sites.sort((a, b) => Math.hypot(a.x, a.y) - Math.hypot(b.x, b.y) || a.y - b.y || a.x - b.x);
  return centred(sites.slice(0, count).map((site) => ({ ...site, r: 1 }))).circles;
}

const teamRadius = rememberLast(Infinity, (count) => {
  const reach = Math.max(...robotSites(count).map(({ x, y }) => Math.hypot(x, y)));
  return reach + 1 + TEAM_MARGIN;
});

// Lay out teams of the given sizes, largest first: {circles: [{x, y, r}], radius} of the whole.
export const packTeams = rememberLast(Infinity, (sizes) => {
  const circles = [];
  for (const size of sizes.split(",")) {
    const r = teamRadius(Number(size));
    circles.push({ ...nextPlace(circles, r), r });
  }
  return centred(circles);
});

// The free place nearest to the middle that touches a late circle and another one.
function nextPlace(circles, r) {
  if (circles.length === 0) return { x: 0, y: 0 };
  if (circles.length === 1) return { x: circles[0].r + r, y: 0 };
  for (let late = circles.length - 1; late > 0; late--) {
    const places = circles.flatMap((circle, index) => (index === late ? [] : touching(circles[late], circle, r))).filter((place) => isFree(circles, place, r));
    if (places.length) return nearestTo(middleOf(circles), places);
  }
  throw new Error("circles in the plane always leave room beside them");
}

// The middles of circles of radius r that touch both others: two, or none if they are far apart.
function touching(one, other, r) {
  const [dx, dy] = [other.x - one.x, other.y - one.y];
  const apart = Math.hypot(dx, dy);
  const [a, b] = [one.r + r, other.r + r];
  if (apart > a + b) return [];
  const along = (a * a - b * b + apart * apart) / (2 * apart);
  const aside = Math.sqrt(Math.max(0, a * a - along * along));
  return [1, -1].map((side) => ({
    x: one.x + (dx * along - side * dy * aside) / apart,
    y: one.y + (dy * along + side * dx * aside) / apart,
  }));
}

function isFree(circles, { x, y }, r) {
  return circles.every((circle) => Math.hypot(circle.x - x, circle.y - y) > circle.r + r - 1e-6);
}

function middleOf(circles) {
  const weight = circles.reduce((sum, { r }) => sum + r * r, 0);
  return {
    x: circles.reduce((sum, { x, r }) => sum + x * r * r, 0) / weight,
    y: circles.reduce((sum, { y, r }) => sum + y * r * r, 0) / weight,
  };
}

function nearestTo({ x, y }, places) {
  const away = (place) => Math.hypot(place.x - x, place.y - y);
  return places.reduce((best, place) => (away(place) < away(best) - 1e-9 ? place : best));
}

// Moved so that the box around all of them has its middle at the origin.
function centred(circles) {
  const middle = (key) => {
    const ends = circles.flatMap((circle) => [circle[key] - circle.r, circle[key] + circle.r]);
    return (Math.min(...ends) + Math.max(...ends)) / 2;
  };
  const [x, y] = [middle("x"), middle("y")];
  const moved = circles.map((circle) => ({ ...circle, x: circle.x - x, y: circle.y - y }));
  return { circles: moved, radius: Math.max(...moved.map((c) => Math.hypot(c.x, c.y) + c.r)) };
}

// Arithmetic on capability counts: a team has a Map capability -> count, a task needs pairs.

function addCounts(parts) {
  const total = new Map();
  for (const part of parts) {
    for (const [cap, count] of part) total.set(cap, (total.get(cap) ?? 0) + count);
  }
  return total;
}

function covers(have, needs) {
  return needs.every(([cap, count]) => (have.get(cap) ?? 0) >= count);
}

// What is needed beyond what is there.
function missing(have, needs) {
  return needs
    .map(([cap, count]) => [cap, count - (have.get(cap) ?? 0)])
    .filter(([, count]) => count > 0);
}

// What of the wanted counts is there.
function overlap(have, wanted) {
  return wanted
    .map(([cap, count]) => [cap, Math.min(count, have.get(cap) ?? 0)])
    .filter(([, count]) => count > 0);
}

function sumCounts(counts) {
  let sum = 0;
  for (const [, count] of counts) sum += count;
  return sum;
}

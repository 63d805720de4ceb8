// Where robots are in continuous time, by the ways that they set out on.

// A robot's track: the moments at which it passed places, ascending, and these places.
export class Track {
  constructor(/** @type {Place} */ start) {
    /** @type {number[]} */ this.times = [0];
    /** @type {Place[]} */ this.places = [start];
  }

  // Where it is at a moment; between two places it goes straight on.
  /** @returns {Place} */
  placeAt(when) {
    const after = firstAfter(this.times, when);
    if (after === this.times.length) return this.places[after - 1];
    const [begin, end] = [this.times[after - 1], this.times[after]];
    const [one, two] = [this.places[after - 1], this.places[after]];
    const part = (when - begin) / (end - begin);
    return [one[0] + part * (two[0] - one[0]), one[1] + part * (two[1] - one[1])];
  }

  // Go another way from a moment on, first to where that begins: pairs of a moment and a place.
  setOut(when, /** @type {[number, Place][]} */ way) {
    if (!way.length) return;
    if (way[0][0] >= when) this.stop(when);
    this.pass(way);
  }

  // Stay where it is at a moment.
  stop(when) {
    this.pass([[when, this.placeAt(when)]]);
  }

  // What was to be passed after the beginning of another way no longer is.
  pass(/** @type {[number, Place][]} */ way) {
    while (this.times.length > 1 && this.times[this.times.length - 1] > way[0][0]) {
      this.times.pop();
      this.places.pop();
    }
    for (const [at, place] of way) {
      this.times.push(at);
      this.places.push(place);
    }
  }

  // The places ahead between two moments, without that of the first one.
  /** @returns {Place[]} */
  ahead(from, to) {
    const [begin, end] = [firstAfter(this.times, from), firstAfter(this.times, to)];
    return this.places.slice(begin, end);
  }
}

// The number of moments in ascending order that are not after one.
function firstAfter(/** @type {number[]} */ times, when) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= when) low = middle + 1;
    else high = middle;
  }
  return low;
}

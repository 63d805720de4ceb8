// What is worked out once and kept.

/**
 * Returns what gives the value of a key, which is made once while the key is one of the last ones.
 * @template Key, Value
 * @param {number} kept
 * @param {(key: Key) => Value} make
 * @returns {(key: Key) => Value}
 */
export function rememberLast(kept, make) {
  const known = new Map();
  return (key) => {
    if (!known.has(key)) {
      if (known.size >= kept) known.delete(known.keys().next().value);
      known.set(key, make(key));
    }
    return known.get(key);
  };
}

// The line to the server: what it says comes in as messages; it is dialled again when it breaks.

const REDIAL_FIRST = 500; // milliseconds
const REDIAL_LONGEST = 8000;
const LONGEST_SILENCE = 15_000; // a server says every few seconds that it is there

export class Link {
  /** @type {WebSocket} */ socket;

  // `hear(message)` is called with each message, `changed(isOpen)` when the line opens or breaks.
  constructor(/** @type {(message: Message) => void} */ hear, /** @type {(isOpen: boolean) => void} */ changed) {
    this.hear = hear;
    this.changed = changed;
    this.wait = REDIAL_FIRST;
    this.dial();
  }

  dial() {
    const protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(`${protocol}//${location.host}/socket${location.search}`);
    this.socket.onopen = () => {
      this.wait = REDIAL_FIRST;
      this.listen();
      this.changed(true);
    };
    this.socket.onmessage = ({ data }) => {
      this.listen();
      this.hear(JSON.parse(data));
    };
    this.socket.onclose = () => {
      clearTimeout(this.silence);
      this.changed(false);
      setTimeout(() => this.dial(), this.wait);
      this.wait = Math.min(REDIAL_LONGEST, this.wait * 2);
    };
  }

  // A line without a word for so long is down, though nobody has hung up.
  listen() {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => this.hangUp(), LONGEST_SILENCE);
  }

  hangUp() {
    const { socket } = this;
    socket.onmessage = null;
    socket.close(); // which may wait for an answer that does not come
    socket.onclose?.(new CloseEvent("close"));
    socket.onclose = null;
  }

  // False if the line is down: nothing is kept to be sent later, when it may no longer be meant.
  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}

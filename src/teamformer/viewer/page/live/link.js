// The line to the server: what it says comes in as messages; it is dialled again when it breaks.

const REDIAL_FIRST = 500; // milliseconds
const REDIAL_LONGEST = 8000;

class Link {
  // `hear(message)` is called with each message, `changed(isOpen)` when the line opens or breaks.
  constructor(hear, changed) {
    Object.assign(this, { hear, changed, wait: REDIAL_FIRST });
    this.dial();
  }

  dial() {
    const protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(`${protocol}//${location.host}/socket${location.search}`);
    this.socket.onopen = () => {
      this.wait = REDIAL_FIRST;
      this.changed(true);
    };
    this.socket.onmessage = ({ data }) => this.hear(JSON.parse(data));
    this.socket.onclose = () => {
      this.changed(false);
      setTimeout(() => this.dial(), this.wait);
      this.wait = Math.min(REDIAL_LONGEST, this.wait * 2);
    };
  }

  // False if the line is down: nothing is kept to be sent later, when it may no longer be meant.
  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}

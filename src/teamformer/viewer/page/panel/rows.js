// A long list of rows of one height, of which only those in sight are in the page.

const ROWS_BEYOND = 4;

class Rows {
  // `build(item)` gives {class, title, children, on}: what a row looks like and does.
  constructor(box) {
    this.box = box;
    this.sizer = element("div", { class: "sizer", role: "list" });
    box.append(this.sizer);
    this.items = [];
    this.top = this.high = 0; // what is in sight, in pixels: asking the box would lay it out anew
    box.addEventListener("scroll", () => {
      if (box.scrollTop !== this.top) this.fill((this.top = box.scrollTop));
    });
    new ResizeObserver(() => this.fill((this.high = box.clientHeight))).observe(box);
  }

  // Show items, the one with the number `shown` in sight unless that is null.
  show(items, height, build, emptyText, shown = null) {
    Object.assign(this, { items, height, build });
    this.sizer.style.height = `${items.length * height}px`;
    this.empty?.remove();
    this.empty = items.length ? null : element("p", { class: "empty" }, emptyText);
    if (this.empty) this.box.append(this.empty);
    this.high ||= this.box.clientHeight;
    if (shown !== null) this.reveal(shown);
    this.top = Math.max(0, Math.min(this.top, items.length * height - this.high));
    this.fill();
  }

  fill() {
    if (!this.build) return;
    const first = Math.max(0, Math.floor(this.top / this.height) - ROWS_BEYOND);
    const inSight = Math.ceil(this.high / this.height) + 2 * ROWS_BEYOND;
    const nodes = this.items
      .slice(first, first + inSight)
      .map((item, at) => this.row(item, first + at));
    refill(this.sizer, nodes);
  }

  row(item, index) {
    const { class: kind, title, children, on } = this.build(item);
    const properties = {
      type: "button",
      class: `row ${kind ?? ""}`,
      title,
      on,
      "data-key": String(index),
    };
    const button = element("button", properties, ...children);
    const row = element(
      "div",
      { role: "listitem", "aria-setsize": this.items.length, "aria-posinset": index + 1 },
      button,
    );
    button.style.top = `${index * this.height}px`;
    button.style.height = `${this.height}px`;
    return row;
  }

  toTop() {
    this.top = this.box.scrollTop = 0;
  }

  // Bring an item near the middle unless it is in sight.
  reveal(index) {
    const top = index * this.height;
    if (top >= this.top && top + this.height <= this.top + this.high) return;
    const most = this.items.length * this.height - this.high;
    this.top = Math.round(Math.max(0, Math.min(most, top - this.high / 2)));
    this.box.scrollTop = this.top;
  }
}

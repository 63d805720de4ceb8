// A long list of rows of one height, of which only those in sight are in the page.

const ROWS_BEYOND = 4;

class Rows {
  // `build(item)` gives {class, title, children, on}: what a row looks like and does.
  constructor(box) {
    this.box = box;
    this.sizer = element("div", { class: "sizer", role: "list" });
    box.append(this.sizer);
    this.items = [];
    box.addEventListener("scroll", () => this.fill());
    new ResizeObserver(() => this.fill()).observe(box);
  }

  show(items, height, build, emptyText) {
    Object.assign(this, { items, height, build });
    this.sizer.style.height = `${items.length * height}px`;
    this.empty?.remove();
    this.empty = items.length ? null : element("p", { class: "empty" }, emptyText);
    if (this.empty) this.box.append(this.empty);
    this.fill();
  }

  fill() {
    if (!this.build) return;
    const first = Math.max(0, Math.floor(this.box.scrollTop / this.height) - ROWS_BEYOND);
    const inSight = Math.ceil(this.box.clientHeight / this.height) + 2 * ROWS_BEYOND;
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

  // Bring an item near the middle unless it is in sight.
  reveal(index) {
    const top = index * this.height;
    const { scrollTop, clientHeight } = this.box;
    if (top >= scrollTop && top + this.height <= scrollTop + clientHeight) return;
    this.box.scrollTop = Math.max(0, top - clientHeight / 2);
  }
}

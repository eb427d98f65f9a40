// The map: a field of the rock, fractures by state, wells, axes; zoom, move, and what is pointed at.
import { rasterize, colour, rangeOver } from "./raster.js";
import { spell, spellWithUnit, ticksBetween } from "./data.js";

const ROOM = { left: 52, right: 10, top: 8, bottom: 36 }; // [px] around the map
const REACH = 8; // [px] within which a fracture is pointed at
const LEVELS = 15; // colours of fractures by a value
const CLOSEST = 1e-5; // share of the body that may fill the map

export class FieldMap {
  // `say` is told what is pointed at, `tell` the scale of the colours.
  constructor(canvas, say, tell) {
    this.canvas = canvas;
    this.say = say;
    this.tell = tell;
    this.shown = null; // { mesh, state, scale, run, events, close: whether colours are for what is in view }
    this.middle = [0, 0];
    this.span = null; // [m] across the shorter side
    this.pixels = null;
    new ResizeObserver(() => this.draw()).observe(canvas);
    this.listen();
  }

  show(shown) {
    const sameMesh = this.shown && this.shown.mesh === shown.mesh;
    this.shown = shown;
    if (this.span === null) this.seeBody();
    this.draw(sameMesh);
  }

  // Views

  seeBody() {
    if (this.shown) this.see(boxOf(this.shown.mesh.points), 1.02);
  }

  seeFractures() {
    if (this.shown?.state.segments.length) this.see(boxOf(this.shown.state.segments), 1.3);
  }

  see([left, right, bottom, top], room) {
    const { width, height } = this.area();
    this.middle = [(left + right) / 2, (bottom + top) / 2];
    const side = Math.min(width, height);
    this.span = room * Math.max(((right - left) * side) / width, ((top - bottom) * side) / height);
    if (!(this.span > 0)) this.span = 1;
    this.draw();
  }

  zoom(factor, place = null) {
    if (!this.shown) return;
    const [left, right, bottom, top] = boxOf(this.shown.mesh.points);
    const body = Math.max(right - left, top - bottom);
    const span = Math.min(4 * body, Math.max(CLOSEST * body, this.span / factor));
    const at = place ?? this.middle;
    const share = span / this.span;
    this.middle = this.middle.map((value, k) => at[k] + (value - at[k]) * share);
    this.span = span;
    this.draw();
  }

  area() {
    const width = Math.max(20, this.canvas.clientWidth - ROOM.left - ROOM.right);
    const height = Math.max(20, this.canvas.clientHeight - ROOM.top - ROOM.bottom);
    return { width, height };
  }

  perMetre() {
    const { width, height } = this.area();
    return Math.min(width, height) / this.span;
  }

  place(x, y) { // of a point of the canvas [px], in the body [m]
    const { width, height } = this.area();
    const size = this.perMetre();
    return [
      this.middle[0] + (x - ROOM.left - width / 2) / size,
      this.middle[1] - (y - ROOM.top - height / 2) / size,
    ];
  }

  // Drawing

  draw(sameMesh = false) {
    if (!this.shown || !this.canvas.clientWidth) return;
    const dense = window.devicePixelRatio || 1;
    const { width, height } = this.area();
    const canvas = this.canvas;
    const full = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.round(side * dense));
    if (canvas.width !== full[0] || canvas.height !== full[1]) [canvas.width, canvas.height] = full;
    const pen = canvas.getContext("2d");
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    this.drawField(pen, dense, width, height, sameMesh);
    pen.setTransform(dense, 0, 0, dense, ROOM.left * dense, ROOM.top * dense);
    pen.save();
    pen.beginPath();
    pen.rect(0, 0, width, height);
    pen.clip();
    const size = this.perMetre();
    const view = {
      x: (x) => width / 2 + (x - this.middle[0]) * size,
      y: (y) => height / 2 - (y - this.middle[1]) * size,
    };
    this.drawFractures(pen, view);
    this.drawEvents(pen, view);
    this.drawWells(pen, view);
    pen.restore();
    this.drawAxes(pen, view, width, height);
  }

  drawField(pen, dense, width, height, sameMesh) {
    const { mesh, state, scale } = this.shown;
    const across = Math.round(width * dense), up = Math.round(height * dense);
    const size = this.perMetre() * dense;
    const seen = `${across} ${up} ${size} ${this.middle}`;
    if (!this.pixels || this.pixels.width !== across || this.pixels.height !== up) {
      this.pixels = new ImageData(across, up);
      this.owners = new Uint32Array(across * up);
      this.seen = null;
    }
    if (!sameMesh || this.seen !== seen || this.meshSeen !== mesh) {
      rasterize(this.owners, across, up, mesh.points, mesh.triangles, {
        x: (x) => across / 2 + (x - this.middle[0]) * size,
        y: (y) => up / 2 - (y - this.middle[1]) * size,
      });
      this.seen = seen;
      this.meshSeen = mesh;
    }
    const used = this.shown.close ? this.closeScale(state.values, scale) : scale;
    this.tell(used);
    colour(this.pixels, this.owners, state.values, used);
    pen.putImageData(this.pixels, Math.round(ROOM.left * dense), Math.round(ROOM.top * dense));
  }

  closeScale(values, scale) {
    const range = rangeOver(this.owners, values);
    if (range === null) return scale;
    let [low, high] = range.map((value) => value / scale.size);
    const least = 1e-6 * Math.max(Math.abs(low), Math.abs(high), 1e-12);
    if (high - low < least) [low, high] = [low - least, high + least]; // 32-bit numbers
    return { ...scale, low, high, colours: scale.plain };
  }

  drawFractures(pen, view) {
    const { state, run } = this.shown;
    pen.lineCap = "round";
    this.strokeSegments(pen, view, "#ffffff", 5, () => true);
    pen.lineCap = "butt";
    const column = state.columns.findIndex(([words]) => words === this.shown.by);
    if (column >= 0) {
      this.strokeByValue(pen, view, column);
      return;
    }
    run.states.forEach(([, colour], number) =>
      this.strokeSegments(pen, view, colour, 3, (k) => state.states[k] === number));
  }

  strokeByValue(pen, view, column) { // the largest values on top
    const { state, scale, by } = this.shown;
    const count = state.segments.length / 4, list = scale.jump_colours, last = list.length / 3 - 1;
    const level = (k) => {
      const share = Math.abs(state.on_fractures[column * count + k]) / (scale.jumps[by] || 1);
      return Math.round(LEVELS * Math.min(1, share));
    };
    for (let n = 0; n <= LEVELS; n++) {
      const place = 3 * Math.round((last * n) / LEVELS);
      this.strokeSegments(pen, view, `rgb(${list.slice(place, place + 3)})`, 3, (k) => level(k) === n);
    }
  }

  strokeSegments(pen, view, colour, width, wanted) {
    const ends = this.shown.state.segments;
    pen.strokeStyle = colour;
    pen.lineWidth = width;
    pen.beginPath();
    for (let k = 0; k < ends.length / 4; k++) {
      if (!wanted(k)) continue;
      pen.moveTo(view.x(ends[4 * k]), view.y(ends[4 * k + 1]));
      pen.lineTo(view.x(ends[4 * k + 2]), view.y(ends[4 * k + 3]));
    }
    pen.stroke();
  }

  drawWells(pen, view) {
    pen.lineWidth = 1.5;
    pen.strokeStyle = "#000";
    pen.fillStyle = "#fff";
    for (const [x, y] of this.shown.run.wells) {
      const [across, up] = [view.x(x), view.y(y)];
      pen.beginPath();
      pen.moveTo(across, up + 6);
      pen.lineTo(across - 6, up - 5);
      pen.lineTo(across + 6, up - 5);
      pen.closePath();
      pen.fill();
      pen.stroke();
    }
  }

  drawEvents(pen, view) { // the largest below
    for (const [kind, x, y, , share] of [...this.shown.events].sort((a, b) => b[4] - a[4])) {
      pen.beginPath();
      pen.arc(view.x(x), view.y(y), 4 + 8 * share, 0, 2 * Math.PI);
      pen.lineWidth = 2;
      pen.strokeStyle = eventColour(kind);
      pen.stroke();
    }
  }

  drawAxes(pen, view, width, height) {
    const { origin, length } = this.shown.run;
    const half = [width, height].map((side) => side / 2 / this.perMetre());
    pen.strokeStyle = pen.fillStyle = "#333";
    pen.lineWidth = 1;
    pen.strokeRect(0.5, 0.5, width - 1, height - 1);
    pen.font = "11px sans-serif";
    for (const axis of [0, 1]) {
      const centre = origin[axis] + this.middle[axis];
      const [low, high] = [centre - half[axis], centre + half[axis]].map((v) => v / length.size);
      for (const tick of ticksBetween(low, high, axis ? height / 70 : width / 90)) {
        const at = tick * length.size - origin[axis];
        const words = spellTick(tick, high - low);
        if (axis === 0) {
          pen.textAlign = "center";
          pen.textBaseline = "top";
          line(pen, view.x(at), height, view.x(at), height + 4);
          pen.fillText(words, view.x(at), height + 6);
        } else {
          pen.textAlign = "right";
          pen.textBaseline = "middle";
          line(pen, -4, view.y(at), 0, view.y(at));
          pen.fillText(words, -6, view.y(at), ROOM.left - 8);
        }
      }
    }
    pen.textAlign = "right";
    pen.textBaseline = "alphabetic";
    pen.fillText(`x, y [${length.unit}]`, width, height + 30);
  }

  // Hands

  listen() {
    const held = new Map();
    this.canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      if (this.span !== null) {
        this.zoom(Math.exp(-0.0015 * event.deltaY), this.place(event.offsetX, event.offsetY));
      }
    }, { passive: false });
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, [event.offsetX, event.offsetY]);
      this.pointAt(event.offsetX, event.offsetY);
    });
    for (const name of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(name, (event) => held.delete(event.pointerId));
    }
    this.canvas.addEventListener("pointermove", (event) => {
      const now = [event.offsetX, event.offsetY];
      const before = held.get(event.pointerId);
      if (before && this.span !== null) {
        this.drag(held, event.pointerId, before, now);
        held.set(event.pointerId, now);
      } else {
        this.pointAt(...now);
      }
    });
  }

  drag(held, mine, before, now) {
    const other = [...held].find(([id]) => id !== mine)?.[1];
    if (other) {
      const apart = (p) => Math.max(1, Math.hypot(p[0] - other[0], p[1] - other[1]));
      this.zoom(apart(now) / apart(before), this.place(...other));
      return;
    }
    this.middle[0] -= (now[0] - before[0]) / this.perMetre();
    this.middle[1] += (now[1] - before[1]) / this.perMetre();
    if (!this.waiting) {
      this.waiting = true;
      requestAnimationFrame(() => {
        this.waiting = false;
        this.draw();
      });
    }
  }

  pointAt(across, up) {
    if (!this.shown) return;
    const { run, state, scale } = this.shown;
    const dense = window.devicePixelRatio || 1;
    const column = Math.floor((across - ROOM.left) * dense), row = Math.floor((up - ROOM.top) * dense);
    const inside = column >= 0 && row >= 0 && column < this.pixels.width && row < this.pixels.height;
    const cell = inside ? this.owners[row * this.pixels.width + column] : 0;
    const place = this.place(across, up);
    const { unit, size } = run.length;
    const digits = digitsFor(this.span / size) + 1;
    const at = place.map((value, k) => ((value + run.origin[k]) / size).toFixed(digits)).join(", ");
    let words = inside ? `x, y = ${at} ${unit}` : "";
    if (cell) words += `: ${scale.label.replace(/ \[.*/, "")} ${spell(state.values[cell - 1] / scale.size)} ${scale.unit}`;
    const found = inside ? this.nearest(place) : -1;
    if (found >= 0) words += ` · ${this.fracture(found)}`;
    const event = inside ? this.event(place) : undefined;
    if (event) words += ` · ${event[5]}`;
    this.say(words);
  }

  event(place) { // the nearest one that is pointed at
    const away = ([, x, y]) => Math.hypot(x - place[0], y - place[1]);
    const [found] = [...this.shown.events].sort((a, b) => away(a) - away(b));
    return found && away(found) < REACH / this.perMetre() ? found : undefined;
  }

  nearest(place) { // number of the fracture cell that is pointed at, or -1
    const ends = this.shown.state.segments;
    let found = -1, least = REACH / this.perMetre();
    for (let k = 0; k < ends.length / 4; k++) {
      const [x, y] = [ends[4 * k], ends[4 * k + 1]];
      const [dx, dy] = [ends[4 * k + 2] - x, ends[4 * k + 3] - y];
      const share = ((place[0] - x) * dx + (place[1] - y) * dy) / (dx * dx + dy * dy || 1);
      const t = Math.min(1, Math.max(0, share));
      const away = Math.hypot(place[0] - x - t * dx, place[1] - y - t * dy);
      if (away < least) [found, least] = [k, away];
    }
    return found;
  }

  fracture(cell) {
    const { run, state } = this.shown;
    const count = state.segments.length / 4;
    const name = run.fractures[state.owners[cell]] ?? `fracture ${state.owners[cell]}`;
    const values = state.columns.map(([words, unit], k) =>
      `${words} ${spellWithUnit(state.on_fractures[k * count + cell], unit)}`);
    return [name, run.states[state.states[cell]]?.[0], ...values].join(", ");
  }
}

export function eventColour(kind) {
  const colours = { "seismic event": "#D55E00", "aseismic slip": "#CC79A7", arrest: "#555" };
  return colours[kind] ?? "#0a0";
}

function boxOf(places) {
  const box = [Infinity, -Infinity, Infinity, -Infinity];
  for (let k = 0; k < places.length; k += 2) {
    box[0] = Math.min(box[0], places[k]);
    box[1] = Math.max(box[1], places[k]);
    box[2] = Math.min(box[2], places[k + 1]);
    box[3] = Math.max(box[3], places[k + 1]);
  }
  return box;
}

function digitsFor(span) { // behind the point, to tell places of a view apart
  return Math.max(0, Math.min(12, Math.ceil(1 - Math.log10(span))));
}

function spellTick(value, span) {
  return value.toFixed(digitsFor(span)).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "").replace(/^-0$/, "0");
}

function line(pen, x0, y0, x1, y1) {
  pen.beginPath();
  pen.moveTo(x0, y0);
  pen.lineTo(x1, y1);
  pen.stroke();
}

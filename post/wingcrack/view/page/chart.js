// The history: one column against time, or against the step where a load drives the run.
import { spell, ticksBetween } from "./data.js";

const ROOM = { left: 58, right: 10, top: 22, bottom: 36 }; // [px]

export class Chart {
  constructor(canvas, choose) {
    this.canvas = canvas;
    this.shown = null; // { places, values, label, below }
    this.at = null; // place of the state that the map shows
    new ResizeObserver(() => this.draw()).observe(canvas);
    canvas.addEventListener("click", (event) => {
      if (this.shown) choose(this.low + (event.offsetX - ROOM.left) / this.scale);
    });
  }

  show(shown) {
    this.shown = shown;
    this.draw();
  }

  mark(place) {
    this.at = place;
    this.draw();
  }

  draw() {
    const canvas = this.canvas;
    if (!this.shown || !canvas.clientWidth) return;
    const dense = window.devicePixelRatio || 1;
    const width = canvas.clientWidth - ROOM.left - ROOM.right;
    const height = canvas.clientHeight - ROOM.top - ROOM.bottom;
    canvas.width = Math.round(canvas.clientWidth * dense);
    canvas.height = Math.round(canvas.clientHeight * dense);
    const pen = canvas.getContext("2d");
    pen.setTransform(dense, 0, 0, dense, ROOM.left * dense, ROOM.top * dense);
    const { places, values, label, below } = this.shown;
    const [first, last] = rangeOf(places, 0);
    const [bottom, top] = rangeOf(values, 0.05);
    this.low = first;
    this.scale = width / (last - first);
    const x = (value) => (value - first) * this.scale;
    const y = (value) => height * (1 - (value - bottom) / (top - bottom));
    pen.font = "11px sans-serif";
    pen.fillStyle = "#333";
    pen.lineWidth = 1;
    for (const tick of ticksBetween(bottom, top, height / 45)) {
      pen.strokeStyle = "#ddd";
      stroke(pen, [[0, y(tick)], [width, y(tick)]]);
      pen.textAlign = "right";
      pen.textBaseline = "middle";
      pen.fillText(spell(tick), -6, y(tick), ROOM.left - 8);
    }
    for (const tick of ticksBetween(first, last, width / 70)) {
      pen.textAlign = "center";
      pen.textBaseline = "top";
      pen.fillText(spell(tick), x(tick), height + 6);
    }
    pen.strokeStyle = "#333";
    pen.strokeRect(0.5, 0.5, width - 1, height - 1);
    pen.textAlign = "left";
    pen.textBaseline = "alphabetic";
    pen.fillText(label, 0, -8, width);
    pen.textAlign = "right";
    pen.fillText(below, width, height + 32);
    pen.strokeStyle = "#0072B2";
    pen.lineWidth = 1.5;
    stroke(pen, Array.from(places, (place, k) => [x(place), y(values[k])]));
    if (places.length === 1) pen.fillRect(x(places[0]) - 2, y(values[0]) - 2, 4, 4);
    if (this.at === null) return;
    pen.strokeStyle = "#D55E00";
    stroke(pen, [[x(this.at), 0], [x(this.at), height]]);
  }
}

function rangeOf(values, room) {
  let low = Infinity, high = -Infinity;
  for (const value of values) {
    if (Number.isFinite(value)) [low, high] = [Math.min(low, value), Math.max(high, value)];
  }
  if (low > high) return [0, 1];
  const size = high - low || Math.abs(high) || 1;
  return high > low ? [low - room * size, high + room * size] : [low - size / 2, high + size / 2];
}

function stroke(pen, points) {
  pen.beginPath();
  let drawing = false;
  for (const [x, y] of points) {
    if (!Number.isFinite(y)) drawing = false;
    else if (drawing) pen.lineTo(x, y);
    else {
      pen.moveTo(x, y);
      drawing = true;
    }
  }
  pen.stroke();
}

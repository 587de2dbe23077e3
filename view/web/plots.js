// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Ruga authors
//
// Small plots of series over time, with a line at the frame that is shown.
const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#888888"];

function rangeOf(panel) {
  let low = Infinity, high = -Infinity;
  for (const s of panel.series) {
    for (const y of s.y) {
      if (y !== null && (!panel.log || y > 0)) {
        low = Math.min(low, y);
        high = Math.max(high, y);
      }
    }
  }
  if (!(low < high)) {
    const about = Number.isFinite(low) ? low : 0, margin = Math.abs(about) * 0.1 || 1;
    return panel.log ? [about / 2 || 0.1, about * 2 || 1] : [about - margin, about + margin];
  }
  return panel.log ? [low / 1.3, high * 1.3] : [low - 0.05 * (high - low), high + 0.05 * (high - low)];
}

const short = (x) => (x !== 0 && (Math.abs(x) >= 1e4 || Math.abs(x) < 1e-3) ? x.toExponential(0) : String(Number(x.toPrecision(2))));

function drawPanel(canvas, panel, time, frame) {
  const w = canvas.clientWidth, h = canvas.clientHeight, scale = Math.min(devicePixelRatio, 2);
  canvas.width = w * scale;
  canvas.height = h * scale;
  const c = canvas.getContext("2d"), [low, high] = rangeOf(panel);
  c.scale(scale, scale);
  const left = 44, right = w - 6, top = 6, bottom = h - 18, last = time.at(-1) || 1;
  const map = panel.log ? (y) => Math.log(y / low) / Math.log(high / low) : (y) => (y - low) / (high - low);
  const x = (t) => left + (right - left) * t / last, y = (v) => bottom - (bottom - top) * map(v);
  c.strokeStyle = "#d9d9d6";
  c.strokeRect(left + 0.5, top + 0.5, right - left - 1, bottom - top - 1);
  c.fillStyle = "#66707a";
  c.font = "10px system-ui, sans-serif";
  c.textAlign = "right";
  c.fillText(short(high), left - 4, top + 9);
  c.fillText(short(low), left - 4, bottom);
  c.fillText(`${short(last)} s`, right, h - 6);
  panel.series.forEach((s, k) => {
    c.strokeStyle = palette[k % palette.length];
    c.lineWidth = 1.4;
    c.setLineDash(k < palette.length ? [] : [4, 3]);
    c.beginPath();
    let down = false;
    s.y.forEach((v, i) => {
      if (v === null || (panel.log && v <= 0)) {
        down = false;
        return;
      }
      if (down) c.lineTo(x(time[i]), y(v));
      else c.moveTo(x(time[i]), y(v));
      down = true;
    });
    c.stroke();
  });
  c.setLineDash([]);
  c.strokeStyle = "#b5543b";
  c.lineWidth = 1;
  c.beginPath();
  c.moveTo(x(time[frame]), top);
  c.lineTo(x(time[frame]), bottom);
  c.stroke();
}

export function drawPlots(parent, panels, time) {
  let frame = 0;
  const drawn = panels.map((panel) => {
    const title = document.createElement("h2"), canvas = document.createElement("canvas"), key = document.createElement("div");
    title.textContent = panel.axis;
    canvas.className = "plot";
    key.className = "key";
    panel.series.forEach((s, k) => {
      const item = document.createElement("span"), mark = document.createElement("i");
      mark.style.background = palette[k % palette.length];
      item.append(mark, s.name);
      key.append(item);
    });
    parent.append(title, canvas, key);
    return () => drawPanel(canvas, panel, time, frame);
  });
  return {
    draw: () => drawn.forEach((d) => d()),
    mark(k) {
      frame = k;
      drawn.forEach((d) => d());
    },
  };
}

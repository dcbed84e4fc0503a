// Code shared by the live page and the page of a run.
"use strict";

globalThis.sonopose = {};

(() => {
  // Names of the verdicts on a fix, in the order of FixVerdict.
  const verdicts = [
    { name: "used", colour: "#8796a5" },
    { name: "down-weighted", colour: "#e0a100" },
    { name: "rejected", colour: "#d62839" },
  ];
  const truthColour = "#2d9a4b";

  const element = (tag, properties = {}, children = []) => {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  };

  const styleOf = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

  // The ellipse of one standard deviation of a 2D covariance: half axes, and the angle of the longer one from x.
  const ellipseOf = (cxx, cxy, cyy) => {
    const mean = (cxx + cyy) / 2;
    const radius = Math.hypot((cxx - cyy) / 2, cxy);
    return {
      long: Math.sqrt(Math.max(0, mean + radius)),
      short: Math.sqrt(Math.max(0, mean - radius)),
      angle: Math.atan2(2 * cxy, cxx - cyy) / 2,
    };
  };

  // From the world (m, x to the right, y up) to the screen (pixels, y down) and back.
  class View {
    constructor(limits) {
      this.limits = limits; // of the scale
      this.centre = [0, 0];
      this.scale = 40; // pixels per m
      this.width = 1;
      this.height = 1;
    }

    toScreen(x, y) {
      return [this.width / 2 + (x - this.centre[0]) * this.scale, this.height / 2 - (y - this.centre[1]) * this.scale];
    }

    toWorld(left, top) {
      return [this.centre[0] + (left - this.width / 2) / this.scale, this.centre[1] - (top - this.height / 2) / this.scale];
    }

    move(right, down) {
      this.centre = [this.centre[0] - right / this.scale, this.centre[1] + down / this.scale];
    }

    // Keeps the content under this point of the screen in place.
    zoom(factor, [left, top]) {
      const before = this.toWorld(left, top);
      this.scale = Math.min(this.limits[1], Math.max(this.limits[0], this.scale * factor));
      const after = this.toWorld(left, top);
      this.centre = [this.centre[0] + before[0] - after[0], this.centre[1] + before[1] - after[1]];
    }
  }

  // A line through points (world, m) on a canvas. A point that is not known interrupts it; of many points every
  // `step`-th and the last one are drawn.
  class LinePath {
    constructor(context, view, step = 1) {
      this.context = context;
      this.view = view;
      this.step = step;
      this.isDown = false;
      this.skipped = null;
      context.beginPath();
    }

    add(i, x, y) {
      if (x === null || y === null || !Number.isFinite(x) || !Number.isFinite(y)) {
        this.flush();
        this.isDown = false;
        return;
      }
      if (this.isDown && i % this.step !== 0) {
        this.skipped = [x, y];
        return;
      }
      this.draw(x, y);
    }

    draw(x, y) {
      const [left, top] = this.view.toScreen(x, y);
      if (this.isDown) this.context.lineTo(left, top);
      else this.context.moveTo(left, top);
      this.isDown = true;
      this.skipped = null;
    }

    flush() {
      if (this.skipped) this.draw(...this.skipped);
    }

    stroke() {
      this.flush();
      this.context.stroke();
    }
  }

  Object.assign(sonopose, { verdicts, truthColour, element, styleOf, ellipseOf, View, LinePath });
})();

// The map: tracks, fixes, poses and what lies under them, on a canvas. World x is to the right, y up.
"use strict";

(() => {
  const { verdicts, truthColour, styleOf, ellipseOf, hasHeading, View, LinePath } = sonopose;
  const mostFittedScale = 200; // pixels per m
  const mostTrackPoints = 2000; // of one beacon, when a whole track is drawn

  class MapView extends View {
    constructor(canvas, model) {
      super([0.5, 5000]);
      this.canvas = canvas;
      this.model = model;
      this.context = canvas.getContext("2d");
      this.tracks = document.createElement("canvas"); // what grows: drawn once, point by point
      this.trackContext = this.tracks.getContext("2d");
      this.marks = document.createElement("canvas"); // the fixes, below the tracks
      this.markContext = this.marks.getContext("2d");
      this.shows = { fixes: true, truth: true, plan: true };
      this.isFitted = true; // until somebody moves the map
      this.drawnOf = new Map(); // by address: rows that are drawn
      this.mustRedraw = true;
      this.resize();
      new ResizeObserver(() => this.resize()).observe(canvas);
      this.listen();
    }

    resize() {
      const ratio = window.devicePixelRatio || 1;
      const { clientWidth, clientHeight } = this.canvas;
      for (const each of [this.canvas, this.tracks, this.marks]) {
        each.width = Math.max(1, Math.round(clientWidth * ratio));
        each.height = Math.max(1, Math.round(clientHeight * ratio));
      }
      this.ratio = ratio;
      this.width = clientWidth;
      this.height = clientHeight;
      this.redraw();
    }

    // Everything, also what was drawn before.
    redraw() {
      this.mustRedraw = true;
      this.model.isNew = true;
    }

    listen() {
      const { canvas } = this;
      const pointers = new Map();
      let moved = 0;
      const at = (event) => [event.offsetX, event.offsetY];
      canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, at(event));
        moved = 0;
      });
      canvas.addEventListener("pointermove", (event) => {
        const before = pointers.get(event.pointerId);
        if (!before) return;
        const now = at(event);
        const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
        const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
        if (others.length > 0) this.zoom(distance(now, others[0]) / Math.max(1, distance(before, others[0])), now);
        else this.move(now[0] - before[0], now[1] - before[1]);
        moved += distance(now, before);
        pointers.set(event.pointerId, now);
      });
      const release = (event) => {
        if (pointers.delete(event.pointerId) && event.type === "pointerup" && moved < 4) this.selectAt(at(event));
      };
      canvas.addEventListener("pointerup", release);
      canvas.addEventListener("pointercancel", release);
      canvas.addEventListener("wheel", (event) => {
        event.preventDefault();
        this.zoom(Math.exp(-0.0015 * event.deltaY), at(event));
      }, { passive: false });
      canvas.addEventListener("keydown", (event) => {
        const step = 60;
        const middle = [this.width / 2, this.height / 2];
        const actions = {
          ArrowLeft: () => this.move(step, 0), ArrowRight: () => this.move(-step, 0),
          ArrowUp: () => this.move(0, step), ArrowDown: () => this.move(0, -step),
          "+": () => this.zoom(1.25, middle), "-": () => this.zoom(0.8, middle), 0: () => this.fit(),
        };
        if (!actions[event.key]) return;
        event.preventDefault();
        actions[event.key]();
      });
    }

    move(right, down) {
      this.isFitted = false;
      super.move(right, down);
      this.redraw();
    }

    zoom(factor, place) {
      this.isFitted = false;
      super.zoom(factor, place);
      this.redraw();
    }

    selectAt([left, top]) {
      let nearest = null;
      let least = 30;
      for (const beacon of this.model.beacons.values()) {
        const pose = beacon.poses.last(this.model.shown);
        if (!pose) continue;
        const [x, y] = this.toScreen(pose.x, pose.y);
        const distance = Math.hypot(x - left, y - top);
        if (distance < least) [nearest, least] = [beacon.address, distance];
      }
      if (nearest !== null) this.model.select(nearest);
    }

    bounds() {
      const box = [Infinity, Infinity, -Infinity, -Infinity];
      const add = (x, y) => {
        if (!Number.isFinite(x) || !Number.isFinite(y)) return;
        box[0] = Math.min(box[0], x);
        box[1] = Math.min(box[1], y);
        box[2] = Math.max(box[2], x);
        box[3] = Math.max(box[3], y);
      };
      for (const { poses } of this.model.beacons.values()) {
        const step = Math.ceil(poses.size / 300) || 1;
        for (let i = 0; i < poses.size; i += step) add(poses.get("x", i), poses.get("y", i));
        if (poses.size > 0) add(poses.get("x", poses.size - 1), poses.get("y", poses.size - 1));
      }
      for (const beacon of this.model.stationary) add(beacon.x, beacon.y);
      for (const [x, y] of this.model.geofence || []) add(x, y);
      if (this.model.floorPlan) {
        const [x0, y0, x1, y1] = this.model.floorPlan.area_m;
        add(x0, y0);
        add(x1, y1);
      }
      return box[0] <= box[2] ? box : null;
    }

    fit() {
      this.isFitted = true;
      this.follow(true);
      this.redraw();
    }

    // Keeps everything in view until somebody moves the map.
    follow(isForced = false) {
      const box = this.bounds();
      if (!box || this.width < 10) return;
      const [left, top] = this.toScreen(box[0], box[3]);
      const [right, bottom] = this.toScreen(box[2], box[1]);
      const isInside = left >= 20 && top >= 20 && right <= this.width - 20 && bottom <= this.height - 20;
      const isLarge = Math.max((right - left) / this.width, (bottom - top) / this.height) > 0.35;
      const isAtLimit = this.scale === mostFittedScale; // at rest, noise would move the map
      if (isInside && (isLarge || isAtLimit) && !isForced) return;
      const margin = 1; // m
      const centre = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
      const fitting = Math.min((this.width - 40) / (box[2] - box[0] + margin), (this.height - 60) / (box[3] - box[1] + margin));
      const scale = Math.min(mostFittedScale, Math.max(this.limits[0], fitting));
      const isSame = scale === this.scale && centre.every((each, axis) => each === this.centre[axis]);
      if (isSame && !isForced) return; // at the lower limit not everything is in view
      this.centre = centre;
      this.scale = scale;
      this.mustRedraw = true;
    }

    // Tracks grow; they are drawn again as a whole only if the view changes.

    drawTracks() {
      const { trackContext: context, markContext: marks, model } = this;
      const isGrowing = model.now === null && !this.mustRedraw;
      for (const each of [context, marks]) {
        each.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
        if (!isGrowing) each.clearRect(0, 0, this.width, this.height);
      }
      if (!isGrowing) {
        this.drawnOf.clear();
      }
      for (const beacon of model.beacons.values()) {
        const drawn = this.drawnOf.get(beacon.address) || { poses: 0, truth: 0, fixes: 0 };
        if (this.shows.fixes) this.drawFixes(marks, beacon.fixes, drawn.fixes);
        if (this.shows.truth) this.drawLine(context, beacon.truth, drawn.truth, truthColour, 1);
        this.drawLine(context, beacon.poses, drawn.poses, beacon.colour, 1.5);
        this.drawnOf.set(beacon.address, {
          poses: beacon.poses.pushed, truth: beacon.truth.pushed, fixes: beacon.fixes.pushed,
        });
      }
      this.mustRedraw = false;
    }

    // Rows after the first `drawn` ones.
    drawLine(context, rows, drawn, colour, width) {
      const end = rows.count(this.model.shown);
      const fresh = rows.pushed - drawn;
      const begin = Math.max(0, rows.size - fresh - 1);
      if (end - begin < 2) return;
      const first = rows.pushed - rows.size; // counted from there, the same rows are drawn whatever is dropped
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.globalAlpha = 0.75;
      const path = new LinePath(context, this, Math.ceil((end - begin) / mostTrackPoints));
      for (let i = begin; i < end; i += 1) path.add(first + i, rows.get("x", i), rows.get("y", i));
      path.stroke();
      context.globalAlpha = 1;
    }

    // Draws all remarkable ones, and a part of the others if there are many.
    drawFixes(context, fixes, drawn) {
      const end = fixes.count(this.model.shown);
      const begin = Math.max(0, fixes.size - (fixes.pushed - drawn));
      const step = Math.ceil((end - begin) / mostTrackPoints) || 1;
      const size = this.model.beacons.size > 4 ? 0.5 : 1; // the rejected fixes of many would cover the map
      for (let i = begin; i < end; i += 1) {
        const verdict = fixes.get("verdict", i);
        if (verdict === 0 && i % step !== 0 && i !== end - 1) continue;
        const [left, top] = this.toScreen(fixes.get("x", i), fixes.get("y", i));
        context.fillStyle = verdicts[verdict].colour;
        const radius = size * (verdict === 0 ? 1.5 : 2.5);
        context.fillRect(left - radius, top - radius, 2 * radius, 2 * radius);
      }
    }

    draw() {
      const { context, model } = this;
      if (this.isFitted) this.follow();
      this.drawTracks();
      context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      context.clearRect(0, 0, this.width, this.height);
      if (this.shows.plan) this.drawPlan();
      this.drawGrid();
      this.drawStationary();
      context.setTransform(1, 0, 0, 1, 0, 0);
      context.drawImage(this.marks, 0, 0);
      context.drawImage(this.tracks, 0, 0);
      context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      for (const beacon of model.beacons.values()) this.drawPose(beacon);
    }

    drawPlan() {
      const { context, model } = this;
      if (model.floorPlan) {
        const [x0, y0, x1, y1] = model.floorPlan.area_m;
        const [left, top] = this.toScreen(x0, y1);
        const [right, bottom] = this.toScreen(x1, y0);
        context.globalAlpha = 0.6;
        context.drawImage(model.floorPlan.image, left, top, right - left, bottom - top);
        context.globalAlpha = 1;
      }
      if (!model.geofence) return;
      context.strokeStyle = styleOf("--warning");
      context.setLineDash([6, 4]);
      context.beginPath();
      for (const [x, y] of model.geofence) context.lineTo(...this.toScreen(x, y));
      context.closePath();
      context.stroke();
      context.setLineDash([]);
    }

    drawGrid() {
      const { context } = this;
      const [step = 100] = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].filter((each) => each * this.scale >= 45);
      const [x0, y1] = this.toWorld(0, 0);
      const [x1, y0] = this.toWorld(this.width, this.height);
      const digits = step < 1 ? 1 : 0;
      context.strokeStyle = styleOf("--grid");
      context.fillStyle = styleOf("--faint");
      context.font = "10px system-ui, sans-serif";
      context.lineWidth = 1;
      context.beginPath();
      for (let x = Math.ceil(x0 / step) * step; x < x1; x += step) {
        const [left] = this.toScreen(x, 0);
        context.moveTo(left, 0);
        context.lineTo(left, this.height);
        context.fillText(x.toFixed(digits), left + 3, this.height - 4);
      }
      for (let y = Math.ceil(y0 / step) * step; y < y1; y += step) {
        const [, top] = this.toScreen(0, y);
        context.moveTo(0, top);
        context.lineTo(this.width, top);
        context.fillText(`${y.toFixed(digits)} m`, 3, top - 3);
      }
      context.stroke();
    }

    drawStationary() {
      const { context } = this;
      context.strokeStyle = context.fillStyle = styleOf("--faint");
      context.lineWidth = 2;
      for (const beacon of this.model.stationary) {
        const [left, top] = this.toScreen(beacon.x, beacon.y);
        context.strokeRect(left - 4, top - 4, 8, 8);
        context.fillText(String(beacon.a), left + 8, top + 3);
      }
    }

    drawPose(beacon) {
      const { context, model } = this;
      const pose = beacon.poses.last(model.shown);
      if (!pose || !Number.isFinite(pose.x)) return;
      const [left, top] = this.toScreen(pose.x, pose.y);
      if (left < -50 || top < -50 || left > this.width + 50 || top > this.height + 50) return;
      const isSelected = beacon.address === model.selected;
      context.strokeStyle = beacon.colour;
      context.fillStyle = beacon.colour;
      if (Number.isFinite(pose.cxx)) this.drawEllipse(pose, left, top);
      this.drawHeading(pose, left, top, isSelected ? 9 : 6);
      context.fillStyle = model.isOutside(pose) ? styleOf("--bad") : styleOf("--text");
      context.font = `${isSelected ? "bold " : ""}12px system-ui, sans-serif`;
      context.fillText(model.isOutside(pose) ? `${beacon.address} outside` : String(beacon.address), left + 10, top - 10);
    }

    // An arrow; a dot while the heading is not known.
    drawHeading(pose, left, top, size) {
      const { context } = this;
      context.beginPath();
      if (!hasHeading(pose)) {
        context.arc(left, top, 0.7 * size, 0, 2 * Math.PI);
        context.fill();
        return;
      }
      context.save();
      context.translate(left, top);
      context.rotate(-pose.yaw);
      context.moveTo(1.6 * size, 0);
      context.lineTo(-size, 0.8 * size);
      context.lineTo(-0.5 * size, 0);
      context.lineTo(-size, -0.8 * size);
      context.closePath();
      context.fill();
      context.restore();
    }

    // Three standard deviations of the position.
    drawEllipse(pose, left, top) {
      const { context } = this;
      const ellipse = ellipseOf(pose.cxx, pose.cxy, pose.cyy);
      const size = 3 * this.scale;
      context.lineWidth = 1;
      context.beginPath();
      context.ellipse(left, top, size * ellipse.long, size * ellipse.short, -ellipse.angle, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  sonopose.MapView = MapView;
})();

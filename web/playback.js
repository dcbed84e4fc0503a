// A recording: fills the model at once; the time bar chooses what is shown.
"use strict";

(() => {
  const { clockText } = sonopose;

  // Columns of numbers, null where a value is not known.
  const fill = (columns, given, begin) => {
    for (let i = 0; i < given.t.length; i += 1) {
      columns.push(columns.names.map((name) => (name === "t" ? begin + given.t[i] : given[name]?.[i])));
    }
  };

  class Playback {
    constructor(parts, model, recording) {
      this.parts = parts;
      this.model = model;
      this.begin = recording.begin;
      this.duration = recording.duration;
      const rows = Math.max(1, ...recording.beacons.map((beacon) => beacon.rows));
      model.capacity = { poses: rows, fixes: rows, status: rows };
      for (const each of recording.beacons) {
        const beacon = model.beacon(each.address);
        fill(beacon.poses, each.poses, this.begin);
        fill(beacon.truth, each.truth, this.begin);
        fill(beacon.fixes, each.fixes, this.begin);
        fill(beacon.status, each.status, this.begin);
      }
      model.stationary = recording.stationary;
      model.extent = [this.begin, this.begin + this.duration];
      this.isPlaying = false;
      this.last = 0;
      parts.box.hidden = false;
      parts.time.max = String(this.duration);
      parts.time.step = String(Math.max(0.01, this.duration / 20000));
      parts.time.addEventListener("input", () => this.show(Number(parts.time.value)));
      parts.play.addEventListener("click", () => this.play(!this.isPlaying));
      this.show(this.duration);
    }

    // `t`: seconds since the begin.
    show(t) {
      this.at = Math.min(this.duration, Math.max(0, t));
      this.model.now = this.begin + this.at;
      this.model.isNew = true;
      this.parts.time.value = String(this.at);
      this.parts.clock.textContent = `${this.at.toFixed(1)} s of ${this.duration.toFixed(1)} s, ${clockText(this.model.now)}`;
    }

    play(isPlaying) {
      this.isPlaying = isPlaying;
      this.parts.play.textContent = isPlaying ? "❚❚" : "▶";
      this.last = performance.now();
      if (isPlaying && this.at >= this.duration) this.show(0);
    }

    // Before each picture.
    advance(now) {
      if (!this.isPlaying) return;
      this.show(this.at + ((now - this.last) / 1000) * Number(this.parts.rate.value));
      this.last = now;
      if (this.at >= this.duration) this.play(false);
    }
  }

  sonopose.Playback = Playback;
})();

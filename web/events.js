// Changes of state, lines of logs, warnings, and what the doctor finds.
"use strict";

(() => {
  const { element, clockText } = sonopose;
  const mostEvents = 500;

  const mostPrograms = 32; // to choose from
  const levels = ["info", "warning", "error"];

  const nameOf = ({ program }) => (program || "").replace(/^sonopose-/, "");
  const processOf = ({ host, pid }) => `${host}:${pid}`;

  // Events, and lines of the logs of all processes.
  class Events {
    // `parts`: list, warnings, and the choices level and program.
    constructor(parts) {
      Object.assign(this, parts);
      this.lines = []; // the newest first, as in the list
      for (const choice of [this.level, this.program]) choice.addEventListener("change", () => this.filter());
    }

    clear() {
      this.lines = [];
      this.list.replaceChildren();
    }

    // The newest comes first, also if an older one arrives later.
    add(event) {
      const label = element("b");
      const item = element("li", { className: event.level }, [
        element("time", { textContent: clockText(event.t) }), label, element("span", { textContent: event.text }),
      ]);
      const line = { event, item, label };
      const found = this.lines.findIndex((each) => each.event.t <= event.t);
      const at = found < 0 ? this.lines.length : found;
      this.list.insertBefore(item, this.lines[at]?.item || null);
      this.lines.splice(at, 0, line);
      if (this.lines.length > mostEvents) this.lines.pop().item.remove();
      item.hidden = !this.isChosen(event);
      this.offer(nameOf(event));
      this.label(nameOf(event));
    }

    // Names the programs; and the processes, if there are several of a program.
    label(name) {
      const own = this.lines.filter((line) => nameOf(line.event) === name);
      const isOne = new Set(own.map((line) => processOf(line.event))).size <= 1;
      for (const { event, label } of own) label.textContent = isOne || !name ? name : `${name} ${processOf(event)}`;
    }

    offer(name) {
      const { options } = this.program;
      if (!name || options.length >= mostPrograms || [...options].some(({ value }) => value === name)) return;
      this.program.append(element("option", { value: name, textContent: name }));
    }

    isChosen(event) {
      const isOfLevel = levels.indexOf(event.level) >= levels.indexOf(this.level.value);
      return isOfLevel && (this.program.value === "" || this.program.value === nameOf(event));
    }

    filter() {
      for (const { event, item } of this.lines) item.hidden = !this.isChosen(event);
    }

    showWarnings(texts) {
      this.warnings.replaceChildren(...texts.map((text) => element("li", { className: "warning", textContent: text })));
    }
  }

  class Findings {
    constructor(list, progress, button, examine) {
      this.list = list;
      this.progress = progress;
      this.button = button;
      button.addEventListener("click", () => {
        if (!examine()) return;
        this.show({ running: true, share: 0, findings: [] });
      });
    }

    // The doctor may go on, but its findings do not come.
    onLost() {
      this.progress.hidden = true;
      this.button.disabled = false;
    }

    show(report) {
      this.progress.hidden = !report.running;
      this.progress.value = report.share;
      this.button.disabled = report.running;
      if (report.running) return;
      this.list.replaceChildren(...report.findings.map((finding) => {
        const line = element("li", {}, [
          element("b", { className: finding.severity, textContent: `${finding.severity}: ` }),
          `${finding.subject}: ${finding.what}`,
        ]);
        if (finding.remedy) line.append(element("p", { textContent: finding.remedy }));
        return line;
      }));
    }
  }

  Object.assign(sonopose, { Events, Findings });
})();

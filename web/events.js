// Changes of state, warnings, and what the doctor finds.
"use strict";

(() => {
  const { element, clockText } = sonopose;
  const mostEvents = 500;

  class Events {
    constructor(list, warnings) {
      this.list = list;
      this.warnings = warnings;
    }

    clear() {
      this.list.replaceChildren();
    }

    // The newest comes first.
    add(event) {
      const line = element("li", { className: event.level }, [element("time", { textContent: clockText(event.t) }), event.text]);
      this.list.prepend(line);
      if (this.list.children.length > mostEvents) this.list.lastChild.remove();
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

"""The live page in a real browser, with the real processes: live_page.py BIN_FOLDER SCREENSHOT [BEACONS]

Prints "skipped: ..." if Chromium or Selenium is not installed.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
except ImportError:
    print("skipped: python3-selenium is not installed; scripts/setup browser installs it")
    sys.exit(0)

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "support"))
from reserve_domain import reserve_domain  # noqa: E402

CHROMIUM = "/usr/bin/chromium"
DRIVER = "/usr/bin/chromedriver"
BEACONS = int(sys.argv[3]) if len(sys.argv) > 3 else 10
LIMIT_S = 100  # bound of each wait, which ends with its event


class Processes:
    """Programs of the project that end with the test."""

    def __init__(self, folder):
        self.folder = folder
        self.running = []
        self.lock, domain = reserve_domain()
        self.environment = dict(os.environ, ROS_DOMAIN_ID=str(domain))

    def start(self, name, *arguments):
        process = subprocess.Popen(
            [os.path.join(self.folder, "sonopose-" + name), *arguments],
            env=self.environment, stdout=subprocess.PIPE if name == "web" else None,
            stderr=subprocess.PIPE if name == "web" else subprocess.DEVNULL, text=True)
        self.running.append(process)
        return process

    def start_web(self, listen, *arguments):
        """Returns the process and the URL that it prints."""
        process = self.start("web", "--listen", listen, *arguments)
        for line in process.stderr:
            found = re.search(r"the page is at (\S+)( with the token)?", line)
            if found:
                return process, process.stdout.readline().strip() if found.group(2) else found.group(1)
        raise AssertionError("sonopose-web ended without a URL")

    def end(self):
        for process in self.running:
            process.terminate()
        for process in self.running:
            process.wait(LIMIT_S)


def open_browser():
    options = Options()
    options.binary_location = CHROMIUM
    for argument in ["--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                     "--disable-background-networking", "--disable-component-update", "--disable-sync",
                     "--user-data-dir=" + tempfile.mkdtemp(), "--window-size=1400,900"]:
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


def wait_for(browser, what, script):
    """Polls the script and returns its value as soon as it is true."""
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        value = browser.execute_script(script)
        if value:
            return value
        time.sleep(0.05)
    raise AssertionError(f"{what}: not within {LIMIT_S} s; {browser.execute_script('return window.sonopose?.statistics')}")


def check(condition, what):
    if not condition:
        raise AssertionError(what)
    print("ok:", what)


def errors_are_small(browser):
    """Compares poses with the truth of the same time: the median of the latest 20 of each beacon."""
    medians = wait_for(browser, "each pose is within 5 cm of the truth", f"""
        const medianOf = ({{ poses, truth }}) => {{
          const errors = [];
          for (let i = truth.size - 1; i > 0 && errors.length < 20; i -= 1) {{
            const [from, to] = [truth.row(i - 1), truth.row(i)];
            const pose = poses.last(to.t);
            if (to.t - from.t > 0.2 || !pose || pose.t < from.t) continue;
            const share = (pose.t - from.t) / (to.t - from.t);
            errors.push(Math.hypot(...["x", "y", "z"].map((axis) => pose[axis] - from[axis] - share * (to[axis] - from[axis]))));
          }}
          return errors.length < 20 ? Infinity : errors.sort((a, b) => a - b)[10];
        }};
        const medians = [...sonopose.model.beacons.values()].map(medianOf);
        return medians.length === {BEACONS} && medians.every((median) => median < 0.05) && medians;""")
    wait_for(browser, "all beacons are shown, with their errors", f"""
        const beacons = Object.values(sonopose.statistics.beacons);
        return beacons.length === {BEACONS} && beacons.every((beacon) => Number.isFinite(beacon.truth_error_m));""")
    print(f"ok: each of {BEACONS} poses is within 5 cm of the truth (medians up to {max(medians):.3f} m)")
    wait_for(browser, "the legend explains the truth", "return !document.querySelector('#legend [data-of=truth]').hidden")


def table_shows_poses(browser):
    """Each row shows the numbers of one of the latest poses."""
    wait_for(browser, "each row has the numbers of a pose", f"""
        const lines = [...document.querySelectorAll("#beacons tbody tr")];
        return lines.length === {BEACONS} && lines.every((line) => {{
          const [address, ...numbers] = [...line.cells].slice(0, 4).map((cell) => parseFloat(cell.textContent));
          const {{ poses }} = sonopose.model.beacons.get(address);
          for (let i = Math.max(0, poses.size - 75); i < poses.size; i += 1) {{
            const pose = poses.row(i);
            if ([pose.x, pose.y, pose.z].every((value, k) => Math.abs(value - numbers[k]) < 0.006)) return true;
          }}
          return false;
        }});""")
    print(f"ok: the table has {BEACONS} rows with the poses")
    statuses = browser.execute_script(
        "return [...document.querySelectorAll('#beacons tbody tr')].map((line) => line.lastChild.textContent)")
    check(all(statuses), "each row has a status, such as " + statuses[0])


def plots_have_pixels(browser):
    inked = browser.execute_script("""
        return [...document.querySelectorAll(".plot:not([hidden])")].map((plot) =>
          [...plot.querySelectorAll("canvas")].some((canvas) => {
            const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
            return data.some((value) => value !== 0);
          }));""")
    check(all(inked), "each of them has pixels")


def map_is_coloured(browser):
    colours = wait_for(browser, "the map has the colours of the beacons", """
        document.getElementById("fit").click();  // they may have left the view
        const canvas = document.getElementById("map");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        const counts = new Map();
        for (let i = 0; i < data.length; i += 4) {
          if (data[i + 3] < 255) continue;
          const colour = `${data[i]},${data[i + 1]},${data[i + 2]}`;
          counts.set(colour, (counts.get(colour) || 0) + 1);
        }
        const often = [...counts.values()].filter((count) => count >= 20).length;
        return often >= 8 && often;""")
    print(f"ok: the map has {colours} colours")


def plots_are_drawn(browser):
    names = wait_for(browser, "the plots are shown", """
        const shown = [...document.querySelectorAll(".plot:not([hidden])")];
        const names = shown.map((plot) => plot.querySelector("h2").textContent);
        return names.length >= 5 && names;""")
    for name in ["Height (m)", "Speed (m/s)", "Innovation of fixes (m)", "Trust", "Latency, median (ms)",
                 "Delay of the fixes (ms)"]:
        check(name in names, f"there is a plot of {name}")
    plots_have_pixels(browser)


def plots_follow(browser):
    """Ctrl and the wheel zoom, a resize (even of a hidden tab) does not; the button makes the plots follow again."""
    of_beacon = browser.execute_script("return document.querySelector('.plot-tools b').textContent")
    selected = browser.execute_script("return sonopose.model.selected")
    check(of_beacon == f"Beacon {selected}", "the plots name their beacon: " + of_beacon)
    browser.execute_script("document.querySelector('[data-panel=\"events-panel\"]').click()")
    width = browser.execute_script("return window.innerWidth")
    browser.set_window_size(1300, 850)
    wait_for(browser, "the page is narrower", f"return window.innerWidth < {width}")
    browser.execute_async_script("const [done] = arguments; requestAnimationFrame(() => requestAnimationFrame(() => done()))")
    browser.execute_script("document.querySelector('[data-panel=\"plots\"]').click()")
    browser.set_window_size(1400, 900)
    wait_for(browser, "the plots have a width", """
        return sonopose.plots.graphs.filter(({ box }) => !box.hidden)
          .every(({ dygraph, graph }) => graph.clientWidth > 100 && dygraph.size().width === graph.clientWidth)""")
    check(browser.execute_script("return sonopose.plots.zoomed === null"), "plots follow after a resize")
    zoomed = browser.execute_script("""
        const { dygraph, graph } = sonopose.plots.graphs.find(({ box }) => !box.hidden);
        const [from, to] = dygraph.xAxisRange();
        graph.querySelector("canvas:last-of-type").dispatchEvent(new WheelEvent("wheel",
          { deltaY: -400, clientX: graph.getBoundingClientRect().left + 100, ctrlKey: true, bubbles: true, cancelable: true }));
        return sonopose.plots.zoomed !== null && sonopose.plots.zoomed[1] - sonopose.plots.zoomed[0] < to - from;""")
    check(zoomed, "Ctrl and the wheel zoom the plots")
    wait_for(browser, "all plots show the same range", """
        const shown = sonopose.plots.graphs.filter(({ box }) => !box.hidden);
        return shown.every(({ dygraph }) => dygraph.xAxisRange().every((t, i) => Math.abs(t - sonopose.plots.zoomed[i]) < 2))""")
    browser.execute_script("[...document.querySelectorAll('.plot-tools button')].find(({ textContent }) => textContent === '10 min').click()")
    wait_for(browser, "ten minutes are shown", """
        const { dygraph } = sonopose.plots.graphs.find(({ box }) => !box.hidden);
        const [from, to] = dygraph.xAxisRange();
        return sonopose.plots.zoomed === null && Math.abs(to - from - 600000) < 2000""")
    print("ok: ten minutes can be seen")
    browser.execute_script("document.querySelector('.plot-tools button').click()")


def logs_are_shown(browser, processes):
    """Log lines of other processes, filtered by program and level."""
    browser.execute_script("document.querySelector('[data-panel=\"events-panel\"]').click()")
    shown = """
        return [...document.querySelectorAll("#events li")].filter((line) => line.offsetParent !== null)
          .map((line) => line.textContent);"""
    labelled = """
        return [...document.querySelectorAll("#events li")].filter((line) => {
          const label = line.querySelector("b").textContent;
          return (label === "%s" || label.startsWith("%s ")) && label.endsWith("%s");
        }).map((line) => line.textContent);"""
    waiting = processes.start("bridge", "--source", "serial", "--device", "/dev/absent-beacon")
    lines = wait_for(browser, "a line of the new bridge is shown", f"""
        const found = (() => {{ {labelled % ("bridge", "bridge", f":{waiting.pid}")} }})();
        return found.length > 0 && found;""")
    check("/dev/absent-beacon" in lines[0], "a new bridge is shown with its process: " + lines[0])
    fusion = browser.execute_script(labelled % ("fusion", "fusion", ""))
    check(fusion, f"{len(fusion)} lines of the fusion are shown, such as " + fusion[0])
    initialised = wait_for(browser, "a change of state is shown", f"""
        const found = (() => {{ {shown} }})().filter((text) => text.includes("beacon 7: initialised"));
        return found.length > 0 && found;""")
    check(len(initialised) == 1, f"a change of state is shown once: {initialised}")
    choose = """
        for (const [id, value] of [["events-program", "%s"], ["events-level", "%s"]]) {
          const choice = document.getElementById(id);
          choice.value = value;
          choice.dispatchEvent(new Event("change"));
        }"""
    browser.execute_script(choose % ("bridge", "info"))
    lines = browser.execute_script(shown)
    check(lines and all("bridge" in line for line in lines), f"{len(lines)} lines are those of the bridge, such as {lines[0]}")
    browser.execute_script(choose % ("bridge", "warning"))
    warnings = browser.execute_script(shown)
    check(len(warnings) < len(lines) and any("/dev/absent-beacon" in line for line in warnings),
          f"of them {len(warnings)} are warnings: {warnings}")
    browser.execute_script(choose % ("bridge", "error"))
    check(not browser.execute_script(shown), "no line of the bridge is an error")
    browser.execute_script(choose % ("", "info"))


def token_is_enough(browser, processes):
    """A page with a token loads all its parts."""
    token = "0123456789abcdef"
    _, url = processes.start_web("127.0.0.1:0", "--token", token)
    browser.get(url)
    wait_for(browser, "a page with a token shows the beacons",
             f"return Object.keys(window.sonopose?.statistics?.beacons || {{}}).length === {BEACONS}")
    browser.get(url.replace(token, "fedcba9876543210"))
    text = wait_for(browser, "a wrong token is named",
                    "const text = document.getElementById('state')?.textContent; return text?.includes('token') && text")
    check("token" in text, "a page with a wrong token says so: " + text)
    browser.get_log("browser")  # discards the expected complaints


def map_layers_are_drawn(browser, processes):
    """Below the tracks: a floor plan with a magenta left half, a geofence and the hardware's map."""
    folder = tempfile.mkdtemp()
    plan, fence = os.path.join(folder, "plan.svg"), os.path.join(folder, "fence.csv")
    with open(plan, "w", encoding="utf-8") as file:
        file.write('<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">'
                   '<rect width="50" height="100" fill="#ff00ff"/></svg>')
    corners_x = wait_for(browser, "the corners are known", """
        const { stationary } = sonopose.model;
        return stationary.length === 4 && stationary.map(({ x }) => x);""")
    border_x = sum(corners_x) / len(corners_x)  # the beacons walk to and fro across it

    def open_with_fence(outer_x):
        """Opens a page whose geofence encloses everything between this x and the border."""
        with open(fence, "w", encoding="utf-8") as file:
            file.write(f"# x_m,y_m\n{outer_x},-40\n{border_x},-40\n{border_x},40\n{outer_x},40\n")
        _, url = processes.start_web("127.0.0.1:0", "--floor-plan", plan, "--floor-plan-area", "-40", "-40", "40", "40",
                                     "--geofence", fence)
        browser.get(url)

    open_with_fence(-40)
    wait_for(browser, "the floor plan and the map of the hardware are shown", f"""
        return window.sonopose?.model?.floorPlan && sonopose.model.stationary.length === 4
          && Object.keys(sonopose.statistics.beacons).length === {BEACONS}""")
    # Share of the pixels around a place in the world that have a colour and are not transparent.
    browser.execute_script("""
        window.colourOf = (name) => /#(..)(..)(..)/.exec(sonopose.styleOf(name)).slice(1).map((each) => parseInt(each, 16));
        window.shareOf = (x, y, radius, [r, g, b]) => {
          const { map } = sonopose;
          const [left, top] = map.toScreen(x, y).map((each) => Math.round(each * map.ratio) - radius);
          const { data } = map.context.getImageData(left, top, 2 * radius + 1, 2 * radius + 1);
          let count = 0;
          for (let i = 0; i < data.length; i += 4) {
            const isNear = [r, g, b].every((each, k) => Math.abs(each - data[i + k]) < 40);
            if (isNear && data[i + 3] > 60) count += 1;
          }
          return count / (2 * radius + 1) ** 2;
        };""")
    magenta = [255, 0, 255]
    for x, is_coloured in [(-38, True), (-20, True), (20, False), (38, False)]:
        wait_for(browser, f"the floor plan at x = {x} m",
                 f"return (shareOf({x}, 30, 10, {magenta}) > 0.5) === {str(is_coloured).lower()}")
    print("ok: the floor plan is in its place")
    wait_for(browser, "the dashed line of the geofence is drawn there, and not beside it", f"""
        const colour = colourOf("--warning");
        const shares = [-35, -30, 30, 35].map((y) => [shareOf({border_x}, y, 8, colour), shareOf({border_x} + 6, y, 8, colour)]);
        return shares.every(([there, beside]) => there > 0.02 && beside === 0);""")
    print("ok: the geofence is in its place")
    wait_for(browser, "the stationary beacons are drawn", """
        return sonopose.model.stationary.every(({ x, y }) => shareOf(x, y, 6, colourOf("--faint")) > 0.15);""")
    print("ok: the stationary beacons are in their places")
    # Requires all beacons on one side of the border; returns that side, and whether each row is marked.
    beyond_and_marked = f"""
        const rows = [...document.querySelectorAll("#beacons tbody tr")].map((line) => line.cells);
        const beyond = rows.map((cells) => parseFloat(cells[1].textContent) - {border_x});
        const isMarked = (cells) => [...cells].pop().textContent.endsWith(", outside");
        const isClear = rows.length === {BEACONS} && beyond.every((x) => Math.abs(x) > 0.1 && x > 0 === beyond[0] > 0);
        return isClear && [beyond[0] > 0, rows.map(isMarked)];"""
    are_beyond, first = wait_for(browser, "the beacons are on one side of the geofence", beyond_and_marked)
    open_with_fence(40)
    _, second = wait_for(browser, "the beacons are on that side of the opposite geofence", f"""
        const found = window.sonopose?.model && (() => {{ {beyond_and_marked} }})();
        return found && found[0] === {str(are_beyond).lower()} && found;""")
    outside, inside = (first, second) if are_beyond else (second, first)
    check(all(outside), "beacons beyond the geofence are marked")
    check(not any(inside), "beacons within it are not")


def doctor_is_run(browser):
    """The findings concern these processes: a bridge waits for a device that does not exist."""
    browser.execute_script("""
        const { send } = WebSocket.prototype;
        WebSocket.prototype.send = function sendShort(text) {
          send.call(this, text.replace('"seconds":8', '"seconds":3')); // a shorter look
        };
        document.querySelector('[data-panel="doctor"]').click();
        document.getElementById("examine").click();""")
    wait_for(browser, "the progress of the doctor is shown", "return document.getElementById('progress').value > 0")
    found = wait_for(browser, "the doctor has findings", """
        const lines = [...document.querySelectorAll("#findings li")].filter((line) => line.offsetParent !== null);
        return document.getElementById("progress").hidden && lines.length > 0 && lines.map((line) => line.textContent);""")
    check(any("/dev/absent-beacon: its bridge waits for the device" in line for line in found),
          f"the doctor has {len(found)} findings, one of the device that does not exist")


SCRUB = """
    const time = document.getElementById("time");
    time.value = "%s";
    time.dispatchEvent(new Event("input"));"""
EVENTS_SHOWN = "document.querySelectorAll('#events li:not([hidden])').length"


def recording_is_played(browser, events):
    """Plays from the beginning: time, pose and events follow until the pause."""
    passed = "sonopose.model.now - sonopose.model.extent[0]"
    browser.execute_script(SCRUB % 0)
    wait_for(browser, "the events after the beginning are hidden", f"return {EVENTS_SHOWN} < {events}")
    browser.execute_script("document.getElementById('play').click()")
    wait_for(browser, "a second is played", f"return {passed} > 1")
    stopped = browser.execute_script(f"document.getElementById('play').click(); return {passed}")
    wait_for(browser, "the pose of the time that was played is shown", f"""
        const [beacon] = Object.values(sonopose.statistics.beacons);
        return Math.abs(beacon.t - sonopose.model.now) < 0.1 && {EVENTS_SHOWN} === {events}""")
    check(browser.execute_script(f"return {passed}") == stopped, "a pause stops it")


def recording_is_scrubbed(browser, processes):
    folder = os.path.join(tempfile.mkdtemp(), "walk")
    subprocess.run([os.path.join(processes.folder, "sonopose-simulate"), "walk", "--out", folder], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    web, url = processes.start_web("127.0.0.1:0", folder)
    browser.get(url)
    wait_for(browser, "the recording is shown", "return window.sonopose?.model?.extent !== null && sonopose.model.beacons.size === 1")
    events = browser.execute_script("return document.getElementById('events').children.length")
    check(events > 0, f"the recording has {events} events")
    wait_for(browser, "all events are shown at its end", f"return {EVENTS_SHOWN} === {events}")
    recording_is_played(browser, events)
    browser.execute_script(SCRUB % 12)
    scrubbed = """
        const [beacon] = Object.values(sonopose.statistics.beacons);
        const clock = document.getElementById("clock").textContent;
        return clock.startsWith("12.0 s of") && beacon && Math.abs(beacon.t - sonopose.model.extent[0] - 12) < 0.1"""
    wait_for(browser, "the pose of that time is shown", scrubbed)
    moved = browser.execute_script("""
        const { dygraph } = sonopose.plots.graphs.find(({ box }) => !box.hidden);
        const range = dygraph.xAxisRange().map((t) => t + 5000);
        dygraph.updateOptions({ dateWindow: range });  // as a pan
        return range""")
    wait_for(browser, "all plots follow a pan", f"""
        return sonopose.plots.graphs.filter(({{ box }}) => !box.hidden)
          .every(({{ dygraph }}) => Math.abs(dygraph.xAxisRange()[0] - {moved[0]}) < 2)""")
    web.kill()
    wait_for(browser, "a lost connection is shown", "return document.getElementById('state').className === 'lost'")
    web, _ = processes.start_web(re.search(r"//([^/]+)/", url).group(1), folder)
    wait_for(browser, "the page connects again", "return sonopose.statistics.connected")
    wait_for(browser, "the same time is shown", scrubbed)
    check(browser.execute_script("return document.getElementById('events').children.length") == events,
          "the events of a recording stay when the connection is lost")
    browser.execute_script("window.isOld = true")
    web.kill()
    web.wait()
    other = shutil.copytree(folder, folder + "_other")
    processes.start_web(re.search(r"//([^/]+)/", url).group(1), other)
    wait_for(browser, "the page is loaded again for another recording",
             f"return !window.isOld && document.getElementById('title')?.textContent === '{other}' && window.sonopose?.model?.beacons.size === 1")


def recorded_logs_and_statuses_are_shown(browser, processes, file):
    _, url = processes.start_web("127.0.0.1:0", file)
    browser.get(url)
    wait_for(browser, "the recording of the bus is shown",
             f"return window.sonopose?.model?.extent && sonopose.model.beacons.size === {BEACONS}")
    names = wait_for(browser, "its plots are shown", """
        const shown = [...document.querySelectorAll(".plot:not([hidden])")];
        const names = shown.map((plot) => plot.querySelector("h2").textContent);
        return names.length >= 5 && names;""")
    check(browser.execute_script("return document.querySelector('#legend [data-of=truth]').hidden"),
          "the legend does not explain a truth that was not recorded")
    for name in ["Latency, median (ms)", "Delay of the fixes (ms)"]:
        check(name in names, f"a recording of the bus has a plot of {name}")
    latency = browser.execute_script("""
        const status = [...sonopose.model.beacons.values()][0].status.last();
        return [status.sensor_to_bridge, status.bridge_to_fusion, status.in_fusion, status.fusion_to_here];""")
    check(all(each >= 0 for each in latency), f"its latencies are {latency} s")
    lines = browser.execute_script(
        "return [...document.querySelectorAll('#events li')].map((line) => line.textContent)")
    check(any("fusion" in line for line in lines), f"it has {len(lines)} lines of logs, such as {lines[0]}")


def thread_s_and_drawn(browser):
    """Returns the page's processor time in s, and the number of times that it has drawn the map."""
    metrics = {each["name"]: each["value"] for each in browser.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]}
    return metrics["ThreadTime"], browser.execute_script("return sonopose.statistics.drawn")


def map_is_drawn_again(browser):
    begin_s, before = thread_s_and_drawn(browser)
    wait_for(browser, "the map is drawn 50 times more", f"return sonopose.statistics.drawn >= {before + 50}")
    end_s, drawn = thread_s_and_drawn(browser)
    each_ms = 1000 * (end_s - begin_s) / (drawn - before)
    print(f"ok: the map is drawn as poses come; with all else on the page, a drawing of {BEACONS} beacons takes {each_ms:.1f} ms "
          "of processor time")


def settings_can_be_changed(browser):
    browser.execute_script("""
        document.querySelector('[data-panel="settings-panel"]').click();
        const input = document.querySelector('[aria-label="outage.stale_after_s"]');
        input.value = "1.5";
        input.dispatchEvent(new Event("change"));""")
    answer = wait_for(browser, "a change is answered",
                      "return document.querySelector('#requests .accepted, #requests .refused')?.textContent")
    check("accepted" in answer, "a change of a setting is accepted: " + answer)
    browser.execute_script("""
        const input = document.querySelector('[aria-label="outage.stale_after_s"]');
        input.value = "-1";
        input.dispatchEvent(new Event("change"));""")
    answer = wait_for(browser, "a wrong value is answered",
                      "return document.querySelector('#requests .refused')?.textContent")
    check("outage.stale_after_s" in answer, "a wrong value is refused with the reason: " + answer)


def run(folder, screenshot):
    processes = Processes(folder)
    browser = None
    try:
        recorded = os.path.join(tempfile.mkdtemp(), "run.mcap")
        recorder = processes.start("record", recorded, "--exclude", "imu,truth")
        processes.start("fusion")
        processes.start("bridge", "--source", "sim", "--beacons", str(BEACONS))
        web, url = processes.start_web("127.0.0.1:0", "--allow-changes")
        browser = open_browser()
        browser.get(url)
        wait_for(browser, "the page is connected", "return window.sonopose?.statistics?.connected")
        browser.execute_cdp_cmd("Performance.enable", {})
        errors_are_small(browser)
        recorder.terminate()
        recorder.wait(LIMIT_S)
        map_is_drawn_again(browser)
        table_shows_poses(browser)
        plots_are_drawn(browser)
        plots_follow(browser)
        logs_are_shown(browser, processes)
        browser.save_screenshot(screenshot.replace(".png", "_log.png"))
        settings_can_be_changed(browser)
        doctor_is_run(browser)
        map_is_coloured(browser)  # after the beacons have moved
        browser.save_screenshot(screenshot)

        browser.refresh()
        wait_for(browser, "a reload shows beacons again",
                 f"return Object.keys(window.sonopose?.statistics?.beacons || {{}}).length === {BEACONS}")
        print("ok: a reload recovers")
        frames = browser.execute_script("return sonopose.statistics.frames")
        web.kill()
        wait_for(browser, "a lost connection is shown", "return document.getElementById('state').className === 'lost'")
        processes.start_web(re.search(r"//([^/]+)/", url).group(1), "--allow-changes")
        wait_for(browser, "the page connects again", f"return sonopose.statistics.connected && sonopose.statistics.frames > {frames + 5}")
        print("ok: a lost connection recovers")
        of_test = ["/ws", "ERR_CONNECTION_REFUSED", "willReadFrequently"]  # ended server, read pixels
        logged = [entry["message"] for entry in browser.get_log("browser")
                  if not entry["message"].startswith("chrome://") and not any(each in entry["message"] for each in of_test)]
        check(not logged, "the browser reports no error: " + json.dumps(logged))
        map_layers_are_drawn(browser, processes)
        browser.save_screenshot(screenshot.replace(".png", "_layers.png"))
        token_is_enough(browser, processes)
        recording_is_scrubbed(browser, processes)
        recorded_logs_and_statuses_are_shown(browser, processes, recorded)
        browser.get_log("browser")  # discards errors of lost connections
        browser.save_screenshot(screenshot.replace(".png", "_run.png"))
    finally:
        if browser:
            browser.quit()
        processes.end()


if __name__ == "__main__":
    if not (os.path.exists(CHROMIUM) and os.path.exists(DRIVER)):
        print("skipped: chromium and chromium-driver are not installed; scripts/setup browser installs them")
        sys.exit(0)
    run(sys.argv[1], sys.argv[2])
